"""Accuracy and repeatability of positioning after ISO 230-2:2014, from deviations at targets.

    x_ij = P_ij - P_i,   s with n - 1,   R_i^ = 4 s_i^,   B_i = mean_i^ - mean_iv
    R_i = max(2 s_i^ + 2 s_iv + |B_i|, R_i^, R_iv)
    E  = max(mean_i^, mean_iv) - min(mean_i^, mean_iv),   M = max(mean_i) - min(mean_i)
    A  = max(mean + 2 s) - min(mean - 2 s), over both directions; A^ and Av over one

^ is the approach along +, v along -. Source: ISO 230-2:2014, clause 3 (definitions).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from feeddrive.errors import InputError
from feeddrive.metrology.finite import refuse_unknown
from feeddrive.typing import FloatArray

EDITION = "ISO 230-2:2014"


@dataclass(frozen=True)
class Positioning:
    """Figures of a positioning test, all in m; arrays of one value per target, shape (m,).

    Attributes:
        target: positions.
        mean_up, mean_down: mean deviation (actual minus target) per direction.
        deviation_up, deviation_down: standard uncertainty estimator s per direction.
        reversal: B_i.
        reversal_value, mean_reversal: B, the largest |B_i|, and the mean of B_i.
        repeatability_up, repeatability_down, repeatability: R^, Rv, R (bidirectional).
        systematic, systematic_up, systematic_down: E, E^, Ev.
        mean_range: M.
        accuracy, accuracy_up, accuracy_down: A, A^, Av.
    """

    target: FloatArray
    mean_up: FloatArray
    mean_down: FloatArray
    deviation_up: FloatArray
    deviation_down: FloatArray
    reversal: FloatArray
    reversal_value: float
    mean_reversal: float
    repeatability_up: float
    repeatability_down: float
    repeatability: float
    systematic: float
    systematic_up: float
    systematic_down: float
    mean_range: float
    accuracy: float
    accuracy_up: float
    accuracy_down: float


@dataclass(frozen=True)
class OneDirection:
    """Figures of approaches from one side, all in m; arrays of one value per target, shape (m,).

    Attributes:
        mean, deviation: mean deviation (actual minus target) and its standard uncertainty estimator s.
        repeatability, systematic, accuracy: R, E, A of this direction.
    """

    mean: FloatArray
    deviation: FloatArray
    repeatability: float
    systematic: float
    accuracy: float


def one_direction(deviations: FloatArray) -> OneDirection:
    """The figures of one direction of approach from deviations, actual minus target [m], shape (m, n).

    Raises:
        InputError: fewer than two approaches.
    """
    if deviations.ndim != 2 or deviations.shape[1] < 2 or not len(deviations):
        what = f"deviations of shape {deviations.shape}"
        raise InputError(what, "ISO 230-2", "approach every target at least twice from the same side")
    refuse_unknown("ISO 230-2", deviations=deviations)
    mean, s = deviations.mean(axis=1), deviations.std(axis=1, ddof=1)
    accuracy = float((mean + 2 * s).max() - (mean - 2 * s).min())
    return OneDirection(mean, s, float(4 * s.max()), float(np.ptp(mean)), accuracy)


def positioning(target: FloatArray, up: FloatArray, down: FloatArray) -> Positioning:
    """The figures of deviations, actual minus target, of every approach, (m, n) [m], at targets, (m,) [m].

    Raises InputError: fewer than two approaches per direction, or shapes that differ.
    """
    if up.shape != down.shape or up.ndim != 2 or up.shape[0] != len(target) or up.shape[1] < 2:
        what = f"deviations of shape {up.shape} and {down.shape} at {len(target)} targets"
        raise InputError(what, "ISO 230-2", "approach every target at least twice from both sides")
    refuse_unknown("ISO 230-2", target=target)
    one, other = one_direction(up), one_direction(down)
    reversal, mean = one.mean - other.mean, 0.5 * (one.mean + other.mean)
    s_up, s_down = one.deviation, other.deviation
    both = 2 * s_up + 2 * s_down + np.abs(reversal)
    means = np.stack([one.mean, other.mean])
    spread = 2 * np.stack([s_up, s_down])
    return Positioning(
        target,
        one.mean,
        other.mean,
        s_up,
        s_down,
        reversal,
        reversal_value=float(np.max(np.abs(reversal))),
        mean_reversal=float(np.mean(reversal)),
        repeatability_up=one.repeatability,
        repeatability_down=other.repeatability,
        repeatability=float(np.max(np.maximum(both, np.maximum(4 * s_up, 4 * s_down)))),
        systematic=float(np.ptp(means)),
        systematic_up=one.systematic,
        systematic_down=other.systematic,
        mean_range=float(np.ptp(mean)),
        accuracy=float((means + spread).max() - (means - spread).min()),
        accuracy_up=one.accuracy,
        accuracy_down=other.accuracy,
    )
