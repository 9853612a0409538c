"""Following error, settling into a window and overshoot.

The following error is set-point minus actual position, as drives show it; deviations of positioning tests have the
opposite sign (actual minus target).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from feeddrive.errors import InputError
from feeddrive.metrology.finite import refuse_unknown
from feeddrive.typing import FloatArray


@dataclass(frozen=True)
class Following:
    """Following error over a time [m].

    Attributes:
        rms, maximum: of its magnitude.
        mean: with its sign.
    """

    rms: float
    maximum: float
    mean: float


def following(setpoint: FloatArray, position: FloatArray) -> Following:
    """Following error of samples [m], shape (n,) each.

    Raises:
        InputError: no sample.
    """
    if not len(setpoint):
        raise InputError("no sample for a following error", "following", "record a longer time")
    refuse_unknown("following", setpoint=setpoint, position=position)
    error = setpoint - position
    return Following(float(np.sqrt(np.mean(error**2))), float(np.max(np.abs(error))), float(np.mean(error)))


@dataclass(frozen=True)
class Settling:
    """Arrival at a target.

    Attributes:
        target: [m].
        direction: of the approach, +1 or -1.
        time: from the arrival of the set-point until the position stays within the window [s]; infinite if it does
            not before the axis leaves again; negative if it was there before the set-point.
        overshoot: beyond the target, in the direction of approach [m]; 0 if there is none.
        deviation: actual minus target at the end [m].
    """

    target: float
    direction: int
    time: float
    overshoot: float
    deviation: float


def settling(
    time: FloatArray, position: FloatArray, target: float, direction: int, arrival: float, leave: float, window: float
) -> Settling:
    """How a position settles at a target within a half width of `window`, from `arrival` to `leave` of the set-point.

    Samples are (n,), all in s and m; `direction` of the approach is +1 or -1. Raises InputError: no sample between
    arrival and leave, or a window that is not above zero.
    """
    if not window > 0:
        raise InputError(f"a window of {window:g} m", "settling", "write a window above zero")
    if len(time) != len(position):
        raise InputError(f"{len(time)} times for {len(position)} positions", "settling", "give (n,) and (n,)")
    refuse_unknown("settling", time=time, position=position)
    upto = int(np.searchsorted(time, leave, side="left"))
    standing = position[int(np.searchsorted(time, arrival, side="left")) : upto]
    if not len(standing):
        raise InputError(f"no sample while standing at {target:g} m", "settling", "make the dwell longer")
    outside = np.flatnonzero(np.abs(position[:upto] - target) > window)
    inside_from = outside[-1] + 1 if len(outside) else 0
    late = float(time[inside_from] - arrival) if inside_from < upto else math.inf
    beyond = float(max(0.0, np.max(direction * (standing - target))))
    return Settling(target, direction, late, beyond, float(standing[-1] - target))
