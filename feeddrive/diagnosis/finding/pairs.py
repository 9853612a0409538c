"""Two effects that hide each other: neither pays alone, together they do."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from feeddrive.diagnosis.finding.attempt import Attempt, compared
from feeddrive.diagnosis.finding.materiality import is_material
from feeddrive.diagnosis.likelihood.coordinates import absent_coordinates, read_coordinates
from feeddrive.diagnosis.likelihood.cross_validation import (
    Comparison,
    compare_left_out,
    least_gain,
    left_out_residual,
)
from feeddrive.diagnosis.likelihood.fit import Fit, fit, linear_step, unit_columns
from feeddrive.diagnosis.likelihood.folds import block_numbers
from feeddrive.errors import InputError
from feeddrive.typing import FloatArray

SUPERADDITIVE = 1.5
"""Gain of two effects together over the sum of their gains alone, from which they are said to hide each other."""


PAIRS_FITTED = 2
"""Pairs of effects that mask each other, fitted where they promise more than the best single one."""


def masked_pair(attempts: Sequence[Attempt], found: Fit, winner: Attempt | None) -> Attempt | None:
    """Two candidates that hide each other, as a rise with speed hides a drop of the level.

    Together they are worth more than the best single one, and, where that pays, than the sum of both alone. Pairs are
    ranked by one linear step from the Jacobians at hand, at no simulation; the best are fitted.
    """
    least = winner.comparison.gain if winner is not None else 0.0
    usable = [a for a in attempts if a.comparison.gain > -0.1 and len(a.fit.effects) == len(found.effects) + 1]
    usable = [a for a in usable if len(a.fit.residual) == len(found.residual)]
    ranked = []
    for first, second, most in _most_together(usable, found):
        gains = max(first.comparison.gain, 0.0), max(second.comparison.gain, 0.0)
        # where none pays alone, each lost in what the other leaves, they need not be worth more than their sum
        alone = max(gains) if winner is None else SUPERADDITIVE * sum(gains)
        if most <= max(alone, least):
            continue
        linear = linear_pair(first, second, found)
        if linear.pays and linear.gain > max(alone, least):
            ranked.append((linear.gain, first, second))
    ranked.sort(key=lambda entry: -entry[0])
    for _, first, second in ranked[:PAIRS_FITTED]:
        problem = first.problem
        try:
            result = fit(problem, (*found.effects, first.fit.effects[-1], second.fit.effects[-1]))
        except InputError:
            continue
        pair = compared(problem, f"{first.name} with {second.name}", result, found.effects)
        material = all(is_material(effect, problem.plant) for effect in result.effects[-2:])
        if material and pair.comparison.pays and pair.comparison.gain > least:
            return pair
    return None


def _most_together(usable: Sequence[Attempt], found: Fit) -> Iterator[tuple[Attempt, Attempt, float]]:
    """Every pair and a bound of its gain: what one linear step takes away of the samples that it is fitted to."""
    if len(usable) < 2:
        return
    parts = [found.jacobian, *(_own_columns(attempt) for attempt in usable)]
    ends = np.cumsum([part.shape[1] for part in parts])
    columns = np.empty((len(found.residual), ends[-1]))
    for part, end in zip(parts, ends, strict=True):
        columns[:, end - part.shape[1] : end] = unit_columns(part)[0]
    normal = columns.T @ columns
    shared = np.arange(ends[0])
    left_out = left_out_residual(usable[0].problem, found, block_numbers(usable[0].problem))
    before = float(left_out @ left_out)
    for i, first in enumerate(usable):
        residual = first.fit.residual
        projected, energy = columns.T @ residual, float(residual @ residual)
        for j in range(i + 1, len(usable)):
            chosen = np.concatenate([shared, np.arange(ends[i], ends[i + 1]), np.arange(ends[j], ends[j + 1])])
            part = projected[chosen]
            taken = float(part @ np.linalg.lstsq(normal[np.ix_(chosen, chosen)], part, rcond=1e-12)[0])
            yield first, usable[j], 1 - (energy - taken) / before


def linear_pair(first: Attempt, second: Attempt, found: Fit) -> Comparison:
    """Gain of both candidates together by one linear step."""
    columns = _own_columns(first), _own_columns(second)
    jacobian = np.hstack([found.jacobian, *columns])
    blocks = block_numbers(first.problem)
    step = linear_step(jacobian, first.fit.residual)
    effects = (*found.effects, first.fit.effects[-1], second.fit.effects[-1])
    # the second is not in the residual: its step is all that it does, counted from where it is absent
    plant = first.problem.plant
    own = read_coordinates(effects[-1:], plant)
    absent, _ = absent_coordinates(effects[-1:], plant)
    start = np.concatenate(
        [found.coordinates, read_coordinates(effects[-2:-1], plant), np.where(np.isnan(absent), own, absent)]
    )
    both = Fit(effects, first.fit.residual - jacobian @ step, jacobian, start + step)
    together = left_out_residual(first.problem, both, blocks)
    before = left_out_residual(first.problem, found, blocks)
    return compare_left_out(before, together, blocks, least_gain(first.problem, before, together))


def _own_columns(attempt: Attempt) -> FloatArray:
    """Columns of the Jacobian that belong to the candidate itself."""
    own = len(read_coordinates(attempt.fit.effects[-1:], attempt.problem.plant))
    return attempt.fit.jacobian[:, attempt.fit.jacobian.shape[1] - own :]
