"""What a control makes of a table while it moves: the set-point that its motor gets.

    set-point side:  p_m = p - c(p, direction)
    actual side:     p_m + c(p_m, direction) = p          (the loop closes on the corrected actual value)

| symbol | meaning | unit |
|---|---|---|
| p | set-point of the table | m |
| p_m | what the motor is commanded, as a position | m |
| c | deviation that the table holds, of the direction of the set velocity | m |

Straight between points and constant beyond, as everywhere in this program (`CompensationTable.at`), or, where a control
puts whole increments out in the middle between two points, the nearest point. At a stand-still the last direction
holds. A control goes over to the other direction at once, evenly or by sin^2 over a time, or lets the whole value
follow under limits of velocity and acceleration.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from feeddrive.compensation.forms.control import Control, Side
from feeddrive.compensation.table import CompensationTable
from feeddrive.typing import FloatArray


@dataclass(frozen=True)
class AxisLimits:
    """Limits of an axis, for controls that ramp: velocity [m/s] and acceleration [m/s^2], both above zero."""

    velocity: float = 0.25
    acceleration: float = 1.0


def motor_setpoint(
    control: Control,
    table: CompensationTable,
    position: FloatArray,
    velocity: FloatArray,
    cycle: float,
    limits: AxisLimits | None = None,
) -> FloatArray:
    """Positions that the motor is commanded, (n,) [m].

    Args:
        control: that applies the table.
        table: as the control holds it.
        position: set-point of the table once a position cycle, shape (n,) [m].
        velocity: of the set-point, shape (n,) [m/s].
        cycle: of the position loop [s].
        limits: of the axis.
    """
    share = _share_of_reverse(velocity, _spread(control, cycle), cycle)
    if control.reversal.smooth:
        share = np.sin(0.5 * math.pi * share) ** 2
    if control.side is Side.ACTUAL:
        # The table's slope is 0.1 at most: five rounds leave 1e-5 of its value.
        at = position
        for _ in range(5):
            at = position - _value(control, table, at, share)
        return at
    value = _value(control, table, position, share)
    if control.reversal.ramped:
        value = ramped(value, cycle, limits or AxisLimits())
    return np.asarray(position - value)


def _value(control: Control, table: CompensationTable, at: FloatArray, share: FloatArray) -> FloatArray:
    forward, reverse = (table.at(at, way, control.stepwise) for way in (False, True))
    return np.asarray(forward + share * (reverse - forward))


def _spread(control: Control, cycle: float) -> float:
    return control.reversal.cycles * cycle or control.reversal.spread


def _share_of_reverse(velocity: FloatArray, spread: float, cycle: float) -> FloatArray:
    """0 moving along +, 1 along -, straight in between over `spread` [s]; before the first motion as in it."""
    moving = np.flatnonzero(velocity)
    if not len(moving):
        return np.zeros(len(velocity))
    last = moving[np.clip(np.searchsorted(moving, np.arange(len(velocity)), side="right") - 1, 0, None)]
    wanted = np.where(velocity[last] < 0, 1.0, 0.0)
    if spread <= cycle:
        return wanted
    share, step, state = np.empty(len(wanted)), cycle / spread, float(wanted[0])
    for i, goal in enumerate(wanted.tolist()):
        state += min(max(goal - state, -step), step)
        share[i] = state
    return share


def ramped(value: FloatArray, cycle: float, limits: AxisLimits) -> FloatArray:
    """The value as LinuxCNC lets it follow, under half of the axis' limits, from 0 at the start, shape (n,) [m].

    Each cycle: where the rest is no more than the way to a stop one step of speed higher, and a cycle at this speed, it
    brakes, and from the last step of speed on jumps to the goal; else it speeds up if the same holds after that, and
    keeps its speed if not. At rest it therefore stops short by up to a T^2, with a half of the acceleration.

    Args:
        value: that it follows, once a cycle, shape (n,) [m].
        cycle: T [s].
        limits: of the axis.

    Source: LinuxCNC src/emc/motion/control.c, compute_screw_comp.
    """
    highest, hardest = 0.5 * limits.velocity, 0.5 * limits.acceleration
    found, at, speed = np.empty(len(value)), 0.0, 0.0
    for i, goal in enumerate(value.tolist()):
        if goal != at:
            way = math.copysign(1.0, goal - at)
            moved, along = _one_cycle(abs(goal - at), way * speed, highest, hardest, cycle)
            at, speed = (goal, 0.0) if moved is None else (at + way * moved, way * along)
        found[i] = at
    return found


def _one_cycle(rest: float, speed: float, highest: float, hardest: float, cycle: float) -> tuple[float | None, float]:
    """Way of a cycle towards the goal and the speed behind it; no way where the goal is reached [m, m/s]."""
    step, ahead = hardest * cycle, speed * cycle
    if rest <= 0.5 * (speed + step) ** 2 / hardest + ahead:
        return (ahead - 0.5 * step * cycle, speed - step) if speed > step else (None, 0.0)
    step = min(step, highest - speed)
    further = 0.5 * step * cycle
    if rest > 0.5 * (speed + step) ** 2 / hardest + ahead + further:
        return ahead + further, speed + step
    return ahead, speed
