"""The least value of a sum of piecewise monotone functions, with a bound that holds between the points looked at."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from feeddrive.typing import FloatArray

_PARTS = 4
"""Into which a doubtful interval is divided."""

_AGREED = 1e-4
"""Distance of bound and value at which both are the same, over the largest sum of sizes."""


def least_sum(
    terms: Callable[[FloatArray], FloatArray], points: FloatArray, rounds: int
) -> tuple[float, float, FloatArray]:
    """Lower bound of a sum over an interval, where its least value was found, and the terms there.

    In an interval in which every term is monotone, the sum lies above the sum of the lesser ends. Intervals in which
    that leaves it open whether the least value found is the least are divided, in so many rounds at most. The terms are
    a function of n places, (terms, n), monotone between the points, (k,), which are ends and turning points, ascending.
    """
    values = terms(points)
    for _ in range(rounds):
        total = values.sum(axis=0)
        agreed = _AGREED * float(np.abs(values).sum(axis=0).max())
        doubtful = np.flatnonzero(_bounds(values) < min(total.min() - agreed, 0.0))
        if total.min() < 0:
            doubtful = np.flatnonzero(_bounds(values) < total.min() - agreed)
        if not len(doubtful):
            break
        parts = [np.linspace(points[i], points[i + 1], _PARTS + 1)[1:-1] for i in doubtful]
        points = np.unique(np.concatenate([points, *parts]))
        values = terms(points)
    best = int(np.argmin(values.sum(axis=0)))
    return float(min([values[:, best].sum(), *_bounds(values)])), float(points[best]), values[:, best]


def _bounds(values: FloatArray) -> FloatArray:
    """What a sum lies above in each interval, shape (points - 1,)."""
    lesser: FloatArray = np.minimum(values[:, 1:], values[:, :-1]).sum(axis=0)
    return lesser
