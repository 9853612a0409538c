"""The sampled control loop around the equations of motion, compiled."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from tests.generator.constants import Constants
from tests.generator.motion import State, advance_many, compiled

Array = npt.NDArray[np.float64]


class Sampling(NamedTuple):
    """What the loop needs beside the plant: sample_time, longest_step [s], encoder_step [rad], gains and limit."""

    sample_time: float
    longest_step: float
    encoder_step: float
    position_gain: float
    speed_gain: float
    integral_time: float
    torque_limit: float


@compiled
def held_step(
    state: State, side: int, old: float, new: float, late: float, s: Sampling, c: Constants
) -> tuple[State, int]:
    """Return state and gap side one sample later: torque `old` for the first `late` seconds, then `new`."""
    state, side = advance_many(state, old, side, late, s.longest_step, c)
    return advance_many(state, new, side, s.sample_time - late, s.longest_step, c)


@compiled
def open_loop(torque: Array, state: State, s: Sampling, c: Constants) -> Array:
    """Return the states (len(torque) + 1, 7) under a held torque sequence [N m]."""
    states = np.empty((torque.size + 1, 7))
    side = 0
    for i in range(torque.size):
        states[i] = state
        state, side = held_step(state, side, 0.0, torque[i], 0.0, s, c)
    states[torque.size] = state
    return states


@compiled
def closed_loop(setpoint: Array, injected: Array, state: State, s: Sampling, c: Constants) -> tuple[Array, Array]:
    """Return the commanded torque (n,) [N m] and the states (n, 7) at the sample instants.

    Position P with speed feed-forward, speed PI with back-calculation, on the quantised encoder; `injected` [N m]
    is added before the limit. The torque of sample i acts from t_i + drive_delay to t_(i+1) + drive_delay.
    """
    count = setpoint.size
    torque = np.empty(count)
    states = np.empty((count, 7))
    whole = math.floor(c.drive_delay / s.sample_time)
    late = c.drive_delay - whole * s.sample_time
    side = 0
    integral = 0.0
    old_angle = round(state[0] / s.encoder_step) * s.encoder_step
    old_setpoint = setpoint[0]
    for i in range(count):
        states[i] = state
        angle = round(state[0] / s.encoder_step) * s.encoder_step
        wanted_speed = (setpoint[i] - old_setpoint) / (c.transmission * s.sample_time)
        wanted_speed += s.position_gain * (setpoint[i] / c.transmission - angle)
        error = wanted_speed - (angle - old_angle) / s.sample_time
        asked = s.speed_gain * error + integral + injected[i]
        torque[i] = min(max(asked, -s.torque_limit), s.torque_limit)
        integral += s.sample_time / s.integral_time * (s.speed_gain * error + torque[i] - asked)
        old_angle = angle
        old_setpoint = setpoint[i]
        new = torque[i - whole] if i >= whole else 0.0
        old = torque[i - whole - 1] if i >= whole + 1 else 0.0
        state, side = held_step(state, side, old, new, late, s, c)
    return torque, states
