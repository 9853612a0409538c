"""Sizes of laws whose shape is hardly known: their intervals by the likelihood, everything else fitted anew.

    min_u |r(w, u)|^2 - |r(w0, u0)|^2 < 1.96^2 c

| symbol | meaning | unit |
|---|---|---|
| w, w0 | size, and where the fit left it | 1 |
| u, u0 | the other coordinates, and where the fit left them | 1 |
| r | weighted residual | 1 |
| c | variance of what is left along the difference to none (`set_evidence.variance_along`) | 1 |

Strokes that pass one side of a tight place tell its slope, and peak, centre and width rise together along a valley that
bends: an interval by slopes holds none, while without it the error is many times as large. Source: Venzon and
Moolgavkar, Applied Statistics 37 (1988) 87.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from feeddrive.diagnosis.likelihood.coordinates import (
    absent_coordinates,
    coordinate_ends,
    read_coordinates,
    write_coordinates,
)
from feeddrive.diagnosis.likelihood.fit import Fit, fit
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.likelihood.set_evidence import variance_along
from feeddrive.effects.base import Effect

STEP = 0.7
"""Factor on a size, or under it, by which an end is looked for: an interval that slopes tell of is narrower."""

STEPS = 8
"""Steps to either side at most: to a twentieth of the size, and to twenty times it; beyond, it is not known."""

HALVINGS = 3
"""Of the last step: an end is told to a twentieth, as a drawing of such a valley has it."""

TINY = 1e-6
"""Of a size without an end of its range: the size over what it is not asked beyond."""

ITERATIONS = 4
"""Steps of the other coordinates' fit at each size, from where the last size left them."""


def profiled(problem: Problem, fitted: Fit, place: int) -> tuple[float, float] | None:
    """The likelihood's interval of the only size of an effect that has a shape too, as coordinates.

    Args:
        problem: recordings.
        fitted: effects.
        place: of the effect among them.

    Returns:
        Lower and upper end; that of the physical range, or none of it, where the likelihood does not end it. None where
        the effect has several sizes, or no shape.
    """
    at = size_beside_shape(problem, fitted, place)
    if at is None:
        return None
    found = float(fitted.coordinates[at])
    none = fit(problem, [one for i, one in enumerate(fitted.effects) if i != place], iterations=ITERATIONS)
    bound = fitted.squared_error + 1.96**2 * variance_along(problem, fitted, none, fitted)
    inner, outer = (_end(problem, fitted, at, factor, bound) for factor in (STEP, 1 / STEP))
    low, high = (float(ends[at]) for ends in coordinate_ends(fitted.effects, problem.plant))
    ends = 0.0 if inner is None else inner, float(np.clip(found / TINY, low, high)) if outer is None else outer
    return min(ends), max(ends)


def size_beside_shape(problem: Problem, fitted: Fit, place: int) -> int | None:
    """Place among the coordinates of the only size of an effect, none at zero, where the rest is its shape."""
    counts = [len(read_coordinates([effect], problem.plant)) for effect in fitted.effects]
    first = sum(counts[:place])
    absent = absent_coordinates(fitted.effects, problem.plant)[0][first : first + counts[place]]
    sizes = np.flatnonzero(~np.isnan(absent))
    if len(sizes) != 1 or len(absent) == 1 or absent[sizes[0]] != 0 or fitted.coordinates[first + sizes[0]] == 0:
        return None
    return first + int(sizes[0])


def _end(problem: Problem, fitted: Fit, at: int, factor: float, bound: float) -> float | None:
    """Where sizes that grow or shrink by a factor begin to be worse; None where none of them is."""
    good, left = float(fitted.coordinates[at]), list(fitted.effects)
    (low, high) = (float(ends[at]) for ends in coordinate_ends(fitted.effects, problem.plant))
    for _ in range(STEPS):
        size = good * factor
        if not low < size < high:
            return None
        there = _beside(problem, left, at, size)
        if there.squared_error <= bound:
            good, left = size, list(there.effects)
            continue
        for _ in range(HALVINGS):
            middle = math.copysign(math.sqrt(good * size), size)
            there = _beside(problem, left, at, middle)
            if there.squared_error <= bound:
                good, left = middle, list(there.effects)
            else:
                size = middle
        return size
    return None


def _beside(problem: Problem, effects: Sequence[Effect], at: int, size: float) -> Fit:
    """The other coordinates fitted beside a size."""
    moved = read_coordinates(effects, problem.plant)
    moved[at] = size
    return fit(problem, write_coordinates(effects, problem.plant, moved), None, ITERATIONS, (at,))
