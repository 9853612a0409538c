"""The cogging map: torque over the motor angle that the drive adds, so that the ripple need not be an error first.

    T(theta) = sum of the torques that resist at the motor and depend on its angle alone

What it leaves is shown by a revolution a second at constant velocity, simulated without and with the map and without
travel errors: the ripple of the table's position. Valid for orders that are whole numbers per revolution, as cogging
and current offsets make them; the angle is that of the recording, whose zero has to be the drive's own.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import casadi as ca
import numpy as np

from feeddrive.compensation.lost_motion import without_play
from feeddrive.compensation.predicted_accuracy import run
from feeddrive.effects.base import Effect, Port, SourceEffect, number
from feeddrive.effects.base import Motion as PortMotion
from feeddrive.effects.source.torque_ripple import TorqueRipple
from feeddrive.effects.tabulated import PERIODIC
from feeddrive.plant.plant import Plant
from feeddrive.servo.cascade import Cascade
from feeddrive.simulate.setpoints.setpoint_motion import Motion, Piece, Pieces
from feeddrive.typing import FloatArray

POINTS = 360
"""Per revolution: a degree, on which an order of 12 is met to 0.5 %."""

_WHOLE = 1e-3
"""By which an order may miss a whole number: the phase drifts by 2 degrees over the 6 revolutions of 100 mm."""

_TURNS, _SKIPPED = 4, 2
"""Revolutions in all, and before the ripple is read: the loop settles in the first."""


@dataclass(frozen=True, eq=False)
class CoggingMap:
    """A map and what it brings.

    Attributes:
        angle: of the motor within a revolution, (POINTS,) [rad].
        torque: that the drive adds, (POINTS,) [N m].
        before, after: ripple of the table position at constant velocity, rms [m].
        velocity: of that motion [m/s].
    """

    angle: FloatArray
    torque: FloatArray
    before: float
    after: float
    velocity: float

    @property
    def text(self) -> str:
        """The map as CSV."""
        rows = [
            f"{math.degrees(a):.3f},{t:.6f}" for a, t in zip(self.angle.tolist(), self.torque.tolist(), strict=True)
        ]
        head = [
            "# torque that the drive adds over the angle of the motor; linear between, the last row leads to the first",
            "# the angle is that of the recorded motor encoder: shift it to the zero of the drive's own",
            "motor_angle [deg],torque [N m]",
        ]
        return "\n".join([*head, *rows]) + "\n"


def cogging_map(plant: Plant, cascade: Cascade) -> CoggingMap | None:
    """The map of a plant under its controller; None where no torque depends on the motor angle.

    Args:
        plant: with what was found.
        cascade: its controller, closed at the motor.
    """
    found = [one for one in plant.effects if _is_cogging(one)]
    if not found:
        return None
    angle: FloatArray = np.arange(POINTS, dtype=np.float64) * (2 * math.pi / POINTS)
    torque: FloatArray = np.zeros(POINTS)
    for one in found:
        motion = PortMotion(ca.DM(angle), ca.DM.zeros(POINTS))
        part: FloatArray = np.array(ca.DM(_source(one).force(motion, one.values)).full(), dtype=np.float64).ravel()
        torque = torque + part
    table = _Map(angle, torque, cascade.radius)
    velocity = 2 * math.pi * cascade.radius
    steady = Pieces((Piece(float(_TURNS), plant.middle, velocity, 0.0, 0.0),))
    ripples, clean = [], without_play(plant)
    for extra in (None, table):
        time, position = run(clean, cascade, steady, None, extra)
        kept = time > _SKIPPED
        ripples.append(float(np.std(position[kept] - velocity * time[kept])))
    return CoggingMap(angle, torque, ripples[0], ripples[1], velocity)


def _is_cogging(effect: Effect) -> bool:
    if effect.port is not Port.MOTOR or not isinstance(effect, SourceEffect):
        return False
    if isinstance(effect, TorqueRipple):
        order = number(effect.values["order"])
        return abs(order - round(order)) < _WHOLE and round(order) > 0
    turns = number(effect.values.get("period", 0.0)) / (2 * math.pi)
    return effect.place.startswith(PERIODIC) and turns > 0 and abs(1 / turns - round(1 / turns)) < _WHOLE


def _source(effect: Effect) -> SourceEffect:
    assert isinstance(effect, SourceEffect)
    return effect


@dataclass(frozen=True, eq=False)
class _Map:
    """The torque of the map where the set-point has the motor; at slow velocity the motor is there."""

    angle: FloatArray
    torque: FloatArray
    radius: float

    def __call__(self, time: FloatArray, motion: Motion) -> tuple[FloatArray, FloatArray]:
        at = motion.position / self.radius
        return np.zeros(len(time)), np.interp(at, self.angle, self.torque, period=2 * math.pi)
