"""What recordings tell of declared values by themselves, and what that leaves of one while the others keep theirs.

    chi²(u) = |A u - b|²,   A = S^-1/2 H,   b = S^-1/2 K' r
    T(V) = least of chi² over u within the tolerances, the values V free of theirs
    interval of value i: the u_i that chi² <= T({i}) + 1.96² reaches while all others are within their tolerances

| symbol | meaning | unit |
|---|---|---|
| u | values, in the coordinates of their own effect, over their deviation | 1 |
| K, r | slopes with u less what the effects' own slopes explain, and the residual at u = 0, over the noise | 1 |
| H, S | K'K, and the covariance of K' r by the colour of the residual and by the encoder (`encoder_scores`) | 1 |

What a stiffness does is in proportion to its compliance, what a mass or a friction does to itself: f^p is linear in u,
p = -1 or 1, f the value over the declared one. Tolerances are ends here, not deviations: values alike to the recordings
(nut and bearing where the far end slides) share what is missing, and each may have all of it that the others' ends
allow. So a value is beyond its tolerance where no values within theirs explain the recordings, and an interval
holds the truth whichever of those that are alike is the one. T ends at two deviations, that is at a factor of one plus
the tolerance either way; intervals at what a tolerance of 20 % is read as, from 80 to 120 %, which is a little more.
Source: Lawson and Hanson, Solving Least Squares Problems (1974), chapter 23 (ends); Venzon and Moolgavkar, Appl.
Statist. 37 (1988) 87 (intervals by profile).
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache, cached_property

import numpy as np
from scipy.optimize import brentq, lsq_linear

from feeddrive.diagnosis.calibration.declared import FARTHEST, CalibratedValue
from feeddrive.diagnosis.calibration.encoder_scores import encoder_scores
from feeddrive.diagnosis.certainty.noise_colour import score_covariance
from feeddrive.diagnosis.likelihood.fit import Fit, linear_step
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.likelihood.slopes import jacobian_of
from feeddrive.typing import FloatArray

TOLERANCE = 2.0
"""Deviations of a coordinate that a tolerance is, by definition (`tolerances`)."""

NORMAL_95 = 1.96

MOST = 1024.0
"""Deviations beyond which a value is not known at all."""


@dataclass(frozen=True)
class Known:
    """Declared values as the recordings tell of them.

    Attributes:
        values: that are fitted.
        at: coordinates c at which the slopes were taken, (k,).
        slopes, right_side: A, (k, k), and b, (k,).
    """

    values: tuple[CalibratedValue, ...]
    at: FloatArray
    slopes: FloatArray
    right_side: FloatArray

    @cached_property
    def ends(self) -> FloatArray:
        """Both ends of every tolerance as u, two deviations, (2, k)."""
        return np.array([[self.u(i, way * TOLERANCE) for i in range(len(self.values))] for way in (-1, 1)])

    @cached_property
    def read_ends(self) -> FloatArray:
        """Both ends of every tolerance as people read it, as u, (2, k)."""
        low = [self.u(i, math.log(_least_share(one.tolerance)) / one.deviation) for i, one in enumerate(self.values)]
        ends = np.array([low, self.ends[1]])
        free = np.array([one.widened > 1 for one in self.values])
        # a value that is not held by its tolerance holds no other
        beyond = free | (self.at < ends[0]) | (self.at > ends[1])
        return np.where(beyond, [[-np.inf], [np.inf]], ends)

    def u(self, place: int, coordinate: float) -> float:
        """The coordinate in which the effect of a value is linear, at c."""
        power, deviation = _power(self.values[place]), self.values[place].deviation
        return float(self.at[place]) + math.expm1(power * deviation * (coordinate - self.at[place])) / power / deviation

    def c(self, place: int, u: float) -> float:
        """c at that coordinate; the farthest where no machine has it."""
        power, deviation = _power(self.values[place]), self.values[place].deviation
        grown = 1 + power * deviation * (u - float(self.at[place]))
        far = self.values[place].farthest
        if grown <= math.exp(-2 * FARTHEST):
            return -power * far
        return min(max(float(self.at[place]) + math.log(grown) / power / deviation, -far), far)

    @cached_property
    def covariance(self) -> FloatArray:
        """Covariance of u under the tolerances as deviations, (k, k)."""
        return np.asarray(np.linalg.inv(self.slopes.T @ self.slopes + np.eye(len(self.right_side))), dtype=np.float64)

    def likeliest(self, wider: Mapping[int, float]) -> tuple[FloatArray, float]:
        """Most likely u, (k,), with other deviations of some values [of their own], and -2 log evidence of that."""
        prior = np.ones(len(self.right_side))
        for place, deviation in wider.items():
            prior[place] = deviation**-2
        normal = self.slopes.T @ self.slopes + np.diag(prior)
        u = np.asarray(np.linalg.solve(normal, self.slopes.T @ self.right_side), dtype=np.float64)
        left = self.slopes @ u - self.right_side
        cost = float(left @ left + prior @ u**2 + np.linalg.slogdet(normal)[1] - np.sum(np.log(prior)))
        return u, cost

    def least(self, *free: int) -> float:
        """T of the values at the places that are free."""
        return _least(self.slopes, self.right_side, *_freed(self.ends, *free))[0]

    def at_least(self, *free: int) -> FloatArray:
        """Values as c, (k,), where T of the values at the places that are free is met."""
        _, u = _least(self.slopes, self.right_side, *_freed(self.ends, *free))
        return np.array([self.c(i, float(one)) for i, one in enumerate(u)])

    def interval(self, place: int) -> tuple[float, float]:
        """Ends of the 95 % interval of a value as c, all others within their tolerances."""
        others = np.arange(len(self.right_side)) != place
        low, high = self.read_ends[:, others]
        least, best = _least(self.slopes, self.right_side, *_freed(self.read_ends, place))

        @cache
        def excess(step: float) -> float:
            """As a root: chi² is a parabola between the steps at which other values come to their ends."""
            right_side = self.right_side - self.slopes[:, place] * (best[place] + step)
            more = _least(self.slopes[:, others], right_side, low, high)[0] - least
            return math.sqrt(max(more, 0.0)) - NORMAL_95

        ends = []
        for way in (-1.0, 1.0):
            if excess(0.0) >= 0:  # so poorly told that not even the least is found twice
                ends.append(best[place])
                continue
            far = way
            while excess(far) < 0 and abs(far) < MOST:
                far *= 2
            ends.append(best[place] + (brentq(excess, 0.0, far, xtol=1e-3) if abs(far) < MOST else far))
        return self.c(place, ends[0]), self.c(place, ends[1])

    def interval_about(self, place: int, coordinate: float) -> tuple[float, float]:
        """Ends of the interval that is told with a value, as c: it holds what either reading of a tolerance allows.

        Read as ends, tolerances leave what `interval` says; read as deviations, as the value was fitted, what is within
        1.96 of its own about the value. The two are weighed otherwise, by the colour of the residual and by one
        variance, so that the value itself may be at an end of the first, or outside.
        """
        low, high = self.interval(place)
        at, half = self.u(place, coordinate), NORMAL_95 * math.sqrt(float(self.covariance[place, place]))
        return min(low, self.c(place, at - half)), max(high, self.c(place, at + half))


def _freed(ends: FloatArray, *free: int) -> FloatArray:
    ends = ends.copy()
    ends[:, list(free)] = [[-np.inf], [np.inf]]
    return ends


def _least(slopes: FloatArray, right_side: FloatArray, low: FloatArray, high: FloatArray) -> tuple[float, FloatArray]:
    """The least chi² between ends, and where."""
    if not slopes.shape[1]:
        return float(right_side @ right_side), np.zeros(0)
    # a value may come to an end and leave it again: the library's own limit, as many turns as values, is too few
    solved = lsq_linear(slopes, right_side, (low, high), method="bvls", max_iter=100 * slopes.shape[1])
    return 2 * float(solved.cost), solved.x


def _least_share(tolerance: float) -> float:
    """Least value over the declared one: one less the tolerance, up to a half; more can only be meant as a factor."""
    return max(1 - tolerance, min(0.5, 1 / (1 + tolerance)))


def _power(value: CalibratedValue) -> int:
    return -1 if value.key.endswith("stiffness") else 1


def known_values(problem: Problem, found: Fit) -> Known | None:
    """What the recordings tell of the declared values beside a fitted set; None where none is fitted."""
    known, whitened = problem.calibration, problem.whitener
    if known is None or whitened is None:
        return None
    columns, rows = whitened.columns, [e.fit_rows for e in problem.evidence]
    residual = problem.unwhitened(found.effects)
    left = residual - columns @ (whitened.most_likely(residual) - known.coordinates)
    own = _own_slopes(problem, found)
    if own.size:
        columns = columns - own @ np.column_stack([linear_step(own, column) for column in columns.T])
    score = score_covariance(problem.evidence, rows, left, columns) + encoder_scores(problem)
    scale = np.sqrt(np.maximum(np.diag(score), np.finfo(float).tiny))
    sizes, directions = np.linalg.eigh(score / np.outer(scale, scale))
    usable = sizes > 1e-10
    half = (directions[:, usable] / np.sqrt(sizes[usable])).T / scale
    right_side = half @ (columns.T @ (residual + whitened.offset))
    empty = len(known.values) - len(half)  # a direction that no row tells of
    slopes = np.vstack([half @ (columns.T @ columns), np.zeros((empty, len(known.values)))])
    return Known(known.values, known.coordinates, slopes, np.concatenate([right_side, np.zeros(empty)]))


def _own_slopes(problem: Problem, found: Fit) -> FloatArray:
    """Slopes of the effects that were found, not whitened, (m, k)."""
    if not found.effects:
        return np.zeros((0, 0))
    bare = replace(problem, plant=problem.machine(), calibration=None)
    return jacobian_of(bare, found.effects, [True] * len(found.effects), bare.predicted(found.effects))
