"""Force-displacement loops: stiffness, lost motion; torque over slow reversals and at constant velocity: friction."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from feeddrive.errors import InputError
from feeddrive.metrology.finite import refuse_unknown
from feeddrive.typing import FloatArray


@dataclass(frozen=True)
class ForceLoop:
    """A closed loop of displacement over force.

    Attributes:
        stiffness: least-squares slope of force over displacement, both branches [N/m].
        width: of the loop at zero force, the lost motion [m].
        work: area of one loop, the energy lost per cycle [J].
        displacement: from the largest negative to the largest positive force [m].
    """

    stiffness: float
    width: float
    work: float
    displacement: float


def force_loop(force: FloatArray, displacement: FloatArray) -> ForceLoop:
    """Figures of one whole cycle of force on the table [N] and its displacement [m], (n,), which begins and ends alike.

    Raises InputError for a force that does not change its sign on both ways.
    """
    refuse_unknown("force loop", force=force, displacement=displacement)
    rising = np.gradient(force) > 0
    at_zero = [_at_zero(force[branch], displacement[branch]) for branch in (rising, ~rising)]
    # slope of the compliance: displacement follows force, whose samples are exact
    compliance = np.polyfit(force, displacement, 1)[0]
    work = abs(float(np.trapezoid(force, displacement)))
    span = displacement[np.argmax(force)] - displacement[np.argmin(force)]
    return ForceLoop(float(1 / compliance), abs(at_zero[0] - at_zero[1]), work, float(span))


def _at_zero(force: FloatArray, displacement: FloatArray) -> float:
    """Displacement where a branch passes zero force."""
    if not len(force) or not force.min() <= 0.0 <= force.max():
        raise InputError("the force does not pass zero on both ways", "force loop", "load in both directions")
    order = np.argsort(force, kind="stable")
    return float(np.interp(0.0, force[order], displacement[order]))


@dataclass(frozen=True)
class TorqueLoop:
    """A loop of motor torque over table position, from slow reversals.

    Attributes:
        friction: half the distance of the branches in the middle of the stroke [N m].
        offset: their mean there [N m].
        force: the friction as a force at the table, 2 pi / lead times it [N].
        stroke: from one reversal to the other [m].
        reversal: travel after a reversal in which the torque passes from -63 to +63 % of the friction [m].
    """

    friction: float
    offset: float
    force: float
    stroke: float
    reversal: float


_RISEN = 0.63


def torque_loop(position: FloatArray, torque: FloatArray, lead: float) -> TorqueLoop:
    """Figures of whole cycles of position of the table [m] and torque of the motor [N m], (n,); lead in m.

    Raises InputError for a position that does not move to and fro.
    """
    refuse_unknown("torque loop", position=position, torque=torque)
    low, high = float(position.min()), float(position.max())
    forward = np.gradient(position) > 0
    middle = np.abs(position - 0.5 * (low + high)) < 0.1 * (high - low)
    if not (forward & middle).any() or not (~forward & middle).any():
        raise InputError("the position does not move to and fro", "torque loop", "choose start and period")
    up, down = (float(torque[branch & middle].mean()) for branch in (forward, ~forward))
    friction, offset = 0.5 * (up - down), 0.5 * (up + down)
    first = int(np.argmin(position))
    place, share = np.roll(position, -first), (np.roll(torque, -first) - offset) / friction
    rising = slice(0, int(np.argmax(place)) + 1)
    passed = [float(place[rising][np.argmax(share[rising] > level)]) for level in (-_RISEN, _RISEN)]
    return TorqueLoop(friction, offset, friction * 2 * np.pi / lead, high - low, passed[1] - passed[0])


@dataclass(frozen=True)
class FrictionPoint:
    """Mean torque at a constant velocity.

    Attributes:
        velocity: of the table, with its sign [m/s].
        torque: mean at the motor [N m].
        spread: standard deviation of the torque along the way [N m].
        force: the torque as a force at the table, 2 pi / lead times it [N].
    """

    velocity: float
    torque: float
    spread: float
    force: float


def friction_map(velocity: FloatArray, torque: FloatArray, lead: float) -> tuple[FrictionPoint, ...]:
    """Friction at each set velocity [m/s], 0 or NaN where not constant, ascending, from torque, (n,) [N m].

    Raises InputError where no sample is at a constant velocity.
    """
    rounded = np.where(np.isfinite(velocity), np.round(velocity, 9), 0.0)
    speeds = [speed for speed in np.unique(rounded) if speed != 0.0]
    if not speeds:
        raise InputError("no constant velocity", "friction map", "make the strokes longer or the limits higher")
    points = []
    for speed in speeds:
        at = torque[rounded == speed]
        refuse_unknown("friction map", torque=at)
        mean = float(at.mean())
        points.append(FrictionPoint(float(speed), mean, float(at.std()), mean * 2 * np.pi / lead))
    return tuple(points)
