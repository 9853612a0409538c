"""Parameters ranked by what setting them free by recording promises, by one linear step.

A shift is a column of the Jacobian cut to the rows of its recording, so that all are ranked at no further simulation.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from feeddrive.diagnosis.likelihood.cross_validation import (
    Comparison,
    compare_left_out,
    least_gain,
    left_out_residual,
)
from feeddrive.diagnosis.likelihood.fit import Fit, Problem, linear_step
from feeddrive.diagnosis.likelihood.folds import block_numbers
from feeddrive.diagnosis.recordings.change_candidates import Movable
from feeddrive.diagnosis.recordings.recordings import RecordingPredictor
from feeddrive.typing import FloatArray, IntegerArray

Offer = tuple[Movable, Comparison]


def offers(problem: Problem, current: Fit, free: Sequence[Movable], recordings: Sequence[int]) -> list[Offer]:
    """What every parameter promises, the likeliest first.

    Args:
        problem: recordings, with a predictor that knows their numbers.
        current: fit with everything in common that does not yet differ.
        free: parameters asked about.
        recordings: numbers of those that may differ.

    Returns:
        The best first; before it a friction level like it to the recordings, since that changes first.
    """
    blocks, rows = block_numbers(problem), recording_of_rows(problem)
    without = _left_out(problem, current, blocks)
    found: list[tuple[Movable, Comparison, FloatArray]] = []
    for one in free:
        errors = _left_out(problem, _with_shifts(problem, current, one, rows, recordings), blocks)
        found.append((one, compare_left_out(without, errors, blocks, least_gain(problem, without, errors)), errors))
    found.sort(key=lambda offer: -offer[1].gain)
    for other in found:
        if other[0].target.name == "friction_deviation":
            better = compare_left_out(other[2], found[0][2], blocks, 0.0)
            if better.gain <= 2 * better.standard_error and other[1].pays:
                found = [other, *(offer for offer in found if offer is not other)]
            break
    return [(one, comparison) for one, comparison, _ in found]


def recording_of_rows(problem: Problem) -> IntegerArray:
    """Number of the recording of every row of the residual, (m,)."""
    predictor = problem.predictor
    assert isinstance(predictor, RecordingPredictor)
    parts = []
    for evidence in problem.evidence:
        count = int(evidence.thinned(evidence.fit_rows).sum()) * len(evidence.channels)
        parts.append(np.full(count, predictor.numbers[evidence.recording]))
    parts.append(np.full(len(problem.numbers), -1))  # measured numbers are of none
    return np.concatenate(parts).astype(np.int64)


def _left_out(problem: Problem, fitted: Fit, blocks: IntegerArray) -> FloatArray:
    """Residual on blocks left out, after one linear step."""
    jacobian, residual = fitted.jacobian, fitted.residual
    step = linear_step(jacobian, residual)
    moved = replace(fitted, residual=residual - jacobian @ step, coordinates=fitted.coordinates + step)
    return left_out_residual(problem, moved, blocks)


def _with_shifts(problem: Problem, current: Fit, one: Movable, rows: IntegerArray, recordings: Sequence[int]) -> Fit:
    """The fit with shifts of nothing yet."""
    columns = _columns(current, one, rows, recordings)
    shifts = one.shifts(recordings)
    return replace(
        current,
        effects=(*current.effects, *shifts),
        jacobian=np.hstack([current.jacobian, columns]),
        coordinates=np.concatenate([current.coordinates, np.zeros(columns.shape[1])]),
    )


def _columns(current: Fit, one: Movable, rows: IntegerArray, recordings: Sequence[int]) -> FloatArray:
    """Columns of the shifts, each cut to the rows of its recording."""
    parts = current.jacobian[:, list(one.columns)]
    return np.hstack([np.where((rows == number)[:, None], parts, 0.0) for number in recordings])
