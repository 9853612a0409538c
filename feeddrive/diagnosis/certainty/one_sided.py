"""Sizes that recordings tell from one side alone: their intervals by the likelihood itself, not by its slope.

    |r(w)|^2 - |r(w0)|^2 < 1.96^2 c,    c = d' Gamma d / d'd,    d = r(none) - r(w0)

| symbol | meaning | unit |
|---|---|---|
| w, w0 | size, and where the fit left it | 1 |
| r | weighted residual, what the slopes of the other coordinates can do taken out | 1 |
| c | variance of what is left along d (`set_evidence.variance_along`) | 1 |

A table that hangs rests on one flank of a free play and leaves it only where the motor falls away faster than it can;
where it comes back without having met the other flank, any wider play predicts the same. The slope with the width is
none there, and an interval by it holds no play at all, while without play the error is many times as large: Hauck and
Donner, J. Am. Stat. Assoc. 72 (1977) 851.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from feeddrive.diagnosis.certainty.profile import TINY, profiled, size_beside_shape
from feeddrive.diagnosis.certainty.uncertainty import Certainty, Interval, certainty, intervals
from feeddrive.diagnosis.likelihood.coordinates import (
    absent_coordinates,
    coordinate_ends,
    read_coordinates,
    write_coordinates,
)
from feeddrive.diagnosis.likelihood.fit import Fit, fit
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.likelihood.set_evidence import variance_along
from feeddrive.diagnosis.motion.predictability import has_play
from feeddrive.effects.base import Effect, number
from feeddrive.typing import FloatArray

STRAIGHT = 0.5
"""Share of what a size does that its slope tells, from which an interval by it is taken: nearer to none of it, the law
is not followed along its slope."""

STEP = 0.8
"""Factor on a size, or under it, by which an end is looked for: an interval of a size is seldom narrower."""

FARTHEST = 0.01
"""Share of the size below which no lower end is looked for: it is none then."""

HALVINGS = 5
"""Of the last step: a lower end is told to less than a per cent."""

OPEN = 1000.0
"""End of an interval over its other one from which nothing recorded ends it."""

USUAL = 1.0
"""Coordinate of a size that is half of the time exceeded: the median of its prior, Cauchy of scale one beyond none."""

Spans = list[dict[str, list[Interval] | None]]


def all_intervals(problem: Problem, fitted: Fit, known: Certainty) -> Spans:
    """Intervals of 95 % as `intervals` has them, and by the likelihood where a slope tells nothing of a size."""
    spans = intervals(problem, fitted, known)
    for place, effect in enumerate(fitted.effects):
        of_its_own = _coordinate(problem, fitted, place)
        at = of_its_own if of_its_own is not None else size_beside_shape(problem, fitted, place)
        if at is None or np.sqrt(known.half_covariance[at, at]) < abs(fitted.coordinates[at]):
            continue
        ends = profiled(problem, fitted, place) if of_its_own is None else one_sided(problem, fitted, place)
        if ends is not None:
            other, *moved = (
                _with(problem, fitted, at, to)[place] for to in (STEP * float(fitted.coordinates[at]), *ends)
            )
            (key,) = [k for k in effect.values if other.values[k] != effect.values[k]]  # an end may be where the fit is
            spans[place] = {**spans[place], key: [(number(moved[0].values[key]), number(moved[1].values[key]))]}
    return spans


def with_usual_sizes(problem: Problem, fitted: Fit) -> Fit:
    """The fit with every play that nothing recorded ends as wide as plays are: where a fit ends there is chance.

    Of other motions, which may meet the other flank, the width met here would say that they do.
    """
    if not any(has_play([effect]) for effect in fitted.effects):
        return fitted
    half, moved = np.sqrt(np.diag(certainty(problem, fitted).half_covariance)), fitted.coordinates.copy()
    for place, effect in enumerate(fitted.effects):
        at = _coordinate(problem, fitted, place)
        if at is None or not has_play([effect]) or half[at] < fitted.coordinates[at]:
            continue
        ends = one_sided(problem, fitted, place)
        if ends is not None and ends[1] > OPEN * ends[0] and ends[0] < USUAL:
            moved[at] = USUAL
    if np.array_equal(moved, fitted.coordinates):
        return fitted
    return fit(problem, write_coordinates(fitted.effects, problem.plant, moved), iterations=0)


def one_sided(problem: Problem, fitted: Fit, place: int) -> tuple[float, float] | None:
    """The likelihood's interval of the only size of an effect, as coordinates, where its slope tells nothing of it.

    Args:
        problem: recordings.
        fitted: effects.
        place: of the effect among them.

    Returns:
        None where the slope tells it, and where the interval holds the absent effect; the upper end is that of the
        physical range where nothing recorded ends it.
    """
    at = _coordinate(problem, fitted, place)
    if at is None:
        return None
    others = np.linalg.qr(np.delete(fitted.jacobian, at, axis=1))[0]
    found = float(fitted.coordinates[at])

    def residual(size: float) -> FloatArray:
        return _beyond(others, problem.residual(_with(problem, fitted, at, size)))

    here, without = residual(found), residual(0.0)
    does, told = np.linalg.norm(without - here), np.linalg.norm(_beyond(others, fitted.jacobian[:, at])) * found
    if not np.isfinite(does) or told >= STRAIGHT * does:
        return None
    rest = fit(problem, _with(problem, fitted, at, 0.0), iterations=0)
    bound = 1.96**2 * variance_along(problem, fitted, rest, fitted)

    def is_worse(size: float) -> bool:
        left = residual(size)
        return not float(left @ left - here @ here) <= bound  # what cannot be simulated is worse

    _, highest = coordinate_ends(fitted.effects, problem.plant)
    low = _end(is_worse, [found * STEP**i for i in range(round(np.log(FARTHEST) / np.log(STEP)))])
    if low is None:
        return None
    end, wider, factor = min(float(highest[at]), found / TINY), [found], 1 / STEP
    while wider[-1] < end:
        wider.append(min(wider[-1] * factor, end))
        factor *= factor
    high = _end(is_worse, wider)
    return low, end if high is None else high


def is_told_by_slopes(problem: Problem, fitted: Fit, place: int) -> bool:
    """Whether an effect's slopes tell most of what taking it away does, the others following: then its interval holds.

    Args:
        problem: recordings.
        fitted: effects.
        place: of the effect among them.
    """
    counts = [len(read_coordinates([effect], problem.plant)) for effect in fitted.effects]
    own = slice(sum(counts[:place]), sum(counts[: place + 1]))
    absent, _ = absent_coordinates(fitted.effects, problem.plant)
    beyond = np.nan_to_num(fitted.coordinates - absent)[own]
    rest = (*fitted.effects[:place], *fitted.effects[place + 1 :])
    others = np.linalg.qr(np.delete(fitted.jacobian, own, axis=1))[0]
    does = np.linalg.norm(_beyond(others, problem.residual(rest) - fitted.residual))
    told = np.linalg.norm(_beyond(others, fitted.jacobian[:, own] @ beyond))
    return bool(told >= STRAIGHT * does)


def _coordinate(problem: Problem, fitted: Fit, place: int) -> int | None:
    """Place among the coordinates of the only one of an effect, a size that is none at zero; else None."""
    counts = [len(read_coordinates([effect], problem.plant)) for effect in fitted.effects]
    at = sum(counts[:place])
    absent, _ = absent_coordinates(fitted.effects, problem.plant)
    return at if counts[place] == 1 and absent[at] == 0 and fitted.coordinates[at] > 0 else None


def _end(is_worse: Callable[[float], bool], sizes: Sequence[float]) -> float | None:
    """Where sizes, the first of which is as good, begin to be worse; None where none of them is."""
    good = sizes[0]
    for size in sizes[1:]:
        if is_worse(size):
            for _ in range(HALVINGS):
                middle = 0.5 * (good + size)
                good, size = (good, middle) if is_worse(middle) else (middle, size)
            return size
        good = size
    return None


def _with(problem: Problem, fitted: Fit, at: int, size: float) -> list[Effect]:
    moved = fitted.coordinates.copy()
    moved[at] = size
    return write_coordinates(fitted.effects, problem.plant, moved)


def _beyond(others: FloatArray, column: FloatArray) -> FloatArray:
    left: FloatArray = column - others @ (others.T @ column)
    return left
