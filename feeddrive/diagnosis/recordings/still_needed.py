"""Effects asked again once the differences between recordings are in: those that no longer pay are dropped."""

from __future__ import annotations

import numpy as np

from feeddrive.diagnosis.likelihood.coordinates import read_coordinates
from feeddrive.diagnosis.likelihood.cross_validation import compare_left_out, least_gain, left_out_residual
from feeddrive.diagnosis.likelihood.fit import Fit, Problem, fit, linear_step
from feeddrive.diagnosis.likelihood.folds import block_numbers
from feeddrive.diagnosis.recordings.recordings import RecordingShift, is_shift
from feeddrive.effects.base import Effect
from feeddrive.typing import FloatArray

CLEARLY_NEEDED = 0.1
"""Share of the squared error that an effect must bring, by one linear step, not to be refitted without it."""

STEPS = 6
"""Steps of a fit without one effect."""


def still_needed(problem: Problem, found: Fit) -> Fit:
    """The fit without the effects that no longer pay; what differs by recording stays.

    Args:
        problem: recordings.
        found: effects of the machine with shifts.
    """
    blocks = block_numbers(problem)
    errors = left_out_residual(problem, found, blocks)
    offers = []
    for index, effect in enumerate(found.effects):
        if is_shift(effect) or _differs(found, effect):
            continue
        bound = _dropped(found, problem, index)
        without = left_out_residual(problem, bound, blocks)
        if compare_left_out(without, errors, blocks, 0.0).gain > CLEARLY_NEEDED:
            continue
        rest = fit(problem, bound.effects, iterations=STEPS)
        without = left_out_residual(problem, rest, blocks)
        comparison = compare_left_out(without, errors, blocks, least_gain(problem, without, errors))
        if not comparison.pays:
            offers.append((comparison.gain, rest))
    if not offers:
        return found
    return still_needed(problem, min(offers, key=lambda offer: offer[0])[1])


def _differs(found: Fit, effect: Effect) -> bool:
    return any(isinstance(shift, RecordingShift) and shift.target.meets(effect) for shift in found.effects)


def _dropped(found: Fit, problem: Problem, index: int) -> Fit:
    """The fit without one effect, the others moved by one linear step."""
    rest = found.effects[:index] + found.effects[index + 1 :]
    counts = [len(read_coordinates([effect], problem.plant)) for effect in found.effects]
    start = sum(counts[:index])
    columns = slice(start, start + counts[index])
    jacobian: FloatArray = np.delete(found.jacobian, columns, axis=1)
    residual = problem.residual(rest)
    step = linear_step(jacobian, residual)
    return Fit(rest, residual - jacobian @ step, jacobian, np.delete(found.coordinates, columns) + step)
