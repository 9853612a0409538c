"""Preload torque split into a part that grows with the preload and one that does not, by regression.

    T(F_0, w) = k F_0 + T_v(w)

| symbol | meaning | unit |
|---|---|---|
| T, F_0, w | measured preload torque, preload, speed | N m, N, rad/s |
| k | slope, common to all speeds: the Coulomb part, from which f follows | N m/N |
| T_v | one value per speed: lubricant, seals and whatever does not depend on the preload | N m |

Least squares with intervals from Student's distribution: errors of equal size, independent, none in the preload.
Where the lubricant's share itself grows with the load (as paper 000 reports for oil), k holds it too and f is too high.
Source: split of paper 000, sections 4.1 and 4.2; the regression is standard.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy import stats

from feeddrive.errors import InputError
from feeddrive.typing import FloatArray

WHERE = "torque regression"


@dataclass(frozen=True)
class Interval:
    """A value with the half width of its confidence interval, in the unit of the value."""

    value: float
    half_width: float

    @property
    def ends(self) -> tuple[float, float]:
        """Lower and upper end."""
        return self.value - self.half_width, self.value + self.half_width


@dataclass(frozen=True)
class TorqueSplit:
    """The two parts of the preload torque.

    Attributes:
        per_preload: k [N m/N].
        speeds: distinct speeds, ascending, shape (s,) [rad/s].
        load_free: T_v at each of them, in the same order, s entries [N m].
        deviation: standard deviation of what is left [N m].
        confidence: of the intervals.
    """

    per_preload: Interval
    speeds: FloatArray
    load_free: tuple[Interval, ...]
    deviation: float
    confidence: float


def split_torque(
    preload: ArrayLike, torque: ArrayLike, speed: ArrayLike = 0.0, confidence: float = 0.95
) -> TorqueSplit:
    """Split measured torques.

    Args:
        preload: F_0, shape (n,) [N].
        torque: T, shape (n,) [N m].
        speed: w, shape (n,) or one for all [rad/s]; equal values form a group.
        confidence: of the intervals, between 0 and 1.

    Raises:
        InputError: not finite, other lengths, no more points than unknowns, no speed with two different preloads,
            or a confidence that is none.
    """
    F, T = np.atleast_1d(np.asarray(preload, dtype=float)), np.atleast_1d(np.asarray(torque, dtype=float))
    if F.ndim != 1 or F.shape != T.shape or np.shape(speed) not in ((), F.shape):
        raise InputError(f"{F.size} preloads, {T.size} torques and {np.size(speed)} speeds", WHERE, "give one of each")
    w = np.broadcast_to(np.asarray(speed, dtype=float), F.shape)
    _refuse_unusable(F, T, w, confidence)
    speeds, group = np.unique(w, return_inverse=True)
    design = np.column_stack([F, np.eye(speeds.size)[group]])
    return _solve(design, T, speeds, confidence)


def _solve(design: FloatArray, torque: FloatArray, speeds: FloatArray, confidence: float) -> TorqueSplit:
    """Least squares with columns of equal size, so that newtons beside ones do not cost digits."""
    n, unknowns = design.shape
    if n <= unknowns:
        raise InputError(f"{n} points for {unknowns} unknowns", WHERE, f"give at least {unknowns + 1}")
    size = np.abs(design).max(axis=0)
    scaled = design / size
    if np.linalg.matrix_rank(scaled) < unknowns:
        raise InputError("the preload does not vary at any speed", WHERE, "measure at two preloads or more")
    solution, *_ = np.linalg.lstsq(scaled, torque, rcond=None)
    deviation = math.sqrt(float(np.sum((torque - scaled @ solution) ** 2)) / (n - unknowns))
    spread = np.sqrt(np.diag(np.linalg.inv(scaled.T @ scaled)))
    half = float(stats.t.ppf(0.5 + 0.5 * confidence, n - unknowns)) * deviation * spread
    found = [Interval(float(v), float(h)) for v, h in zip(solution / size, half / size, strict=True)]
    return TorqueSplit(found[0], speeds, tuple(found[1:]), deviation, confidence)


def _refuse_unusable(preload: FloatArray, torque: FloatArray, speed: FloatArray, confidence: float) -> None:
    for name, values in (("preload", preload), ("torque", torque), ("speed", speed)):
        bad = np.flatnonzero(~np.isfinite(values))
        if bad.size:
            raise InputError(f"{name} {bad[0] + 1} is {values[bad[0]]}", WHERE, "leave that point out")
    if not 0 < confidence < 1:
        raise InputError(f"confidence {confidence:g} is not between 0 and 1", WHERE, "write 0.95 for 95 %")
