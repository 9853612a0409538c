"""Friction at reversals: what to feed forward, or which pulse to put on the speed set-point, and what that leaves.

    feed-forward    T_ff = T_c sign(v_set)
    pulse           w(t) = s 2 T_c / K_p exp(-t / T_n)      from the reversal on, in the new direction

| symbol | meaning | unit |
|---|---|---|
| T_c | friction at the motor in slow motion, mean of both directions | N m |
| K_p, T_n | gain and reset time of the velocity loop | N m s/rad, s |
| s | share, chosen on the simulated circle | 1 |

A pulse that decays with T_n becomes a step of 2 T_c behind a PI controller: the proportional part falls as the integral
one rises, K_p w (exp(-t / T_n) + (1 - exp(-t / T_n))) = 2 T_c. That is the torque by which friction turns over, so that
neither part of the loop has an error to work off. Presliding lets friction turn over a way and not at once, which makes
the best share smaller than 1. Valid while friction is as it was: it changes by tens of per cent with temperature.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from feeddrive.compensation.lost_motion import LostMotion
from feeddrive.compensation.predicted_accuracy import Applied, circle_figures
from feeddrive.metrology.circular import Circular
from feeddrive.plant.plant import Plant
from feeddrive.servo.cascade import Cascade
from feeddrive.simulate.setpoints.setpoint_motion import Motion
from feeddrive.simulate.setpoints.trajectories import Circle
from feeddrive.typing import FloatArray

SHARES = (0.25, 0.5, 0.75, 1.0)
"""Shares of the pulse that are tried; between them the glitch changes by less than friction does over a day."""

_TURN = 0.5e-3
"""Velocity of the table over which the feed-forward turns its sign [m/s]."""


@dataclass(frozen=True)
class FrictionValues:
    """Values for friction at reversals.

    Attributes:
        torque: T_c [N m].
        turning: speed of the motor over which the feed-forward turns [rad/s].
        share: s of the best pulse; 0 where none is better than none.
        pulse: velocity at its beginning, at the table [m/s].
        time: T_n [s]; 0 where the loop has no integrator.
        before, forward, pulsed: circle without, with feed-forward, with the best pulse.
    """

    torque: float
    turning: float
    share: float
    pulse: float
    time: float
    before: Circular
    forward: Circular
    pulsed: Circular


def friction_values(
    plant: Plant, cascade: Cascade, circle: Circle, lost: LostMotion, applied: Applied | None = None
) -> FrictionValues:
    """Values for a plant under its cascade, closed at the motor, tried on a circle beside a table that is in use.

    The lost motion holds the friction.
    """
    turning = _TURN / cascade.radius
    plain = replace(cascade, feed_forward=replace(cascade.feed_forward, coulomb=0.0))
    forward = replace(plain.feed_forward, coulomb=lost.torque, smoothing_speed=turning)
    before = circle_figures(plant, plain, circle, applied)
    fed = circle_figures(plant, replace(plain, feed_forward=forward), circle, applied)
    if math.isinf(plain.reset_time) or not plain.velocity_gain > 0:
        return FrictionValues(lost.torque, turning, 0.0, 0.0, 0.0, before, fed, before)
    whole = 2 * lost.torque / plain.velocity_gain
    best, share = before, 0.0
    for one in SHARES:
        found = circle_figures(plant, plain, circle, applied, _Pulses(one * whole, plain.reset_time))
        if _glitch(found) < _glitch(best):
            best, share = found, one
    pulse = share * whole * plain.radius
    return FrictionValues(lost.torque, turning, share, pulse, plain.reset_time, before, fed, best)


def _glitch(found: Circular) -> float:
    return max(abs(found.glitch[0]), abs(found.glitch[1]))


@dataclass(frozen=True)
class _Pulses:
    """Pulses on the speed set-point [rad/s] after each reversal of the set velocity."""

    speed: float
    decay: float

    def __call__(self, time: FloatArray, motion: Motion) -> tuple[FloatArray, FloatArray]:
        sign = np.sign(motion.velocity)
        moving = np.flatnonzero(sign)
        turned = moving[1:][np.diff(sign[moving]) != 0]
        added = np.zeros(len(time))
        for place, end in zip(turned, [*turned[1:], len(time)], strict=True):
            since = time[place:end] - time[place]
            added[place:end] = sign[place] * self.speed * np.exp(-since / self.decay)
        return added, np.zeros(len(time))
