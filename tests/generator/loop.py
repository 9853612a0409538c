"""The sampled control loop around the equations of motion, compiled."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from tests.generator.constants import Constants, packed
from tests.generator.motion import advance_many
from tests.generator.state import WIDTH, State, compiled

Array = npt.NDArray[np.float64]


class Sampling(NamedTuple):
    """What the loop needs beside the plant: sample_time, longest_step [s], encoder_step [rad], gains and limit.

    speed_share: of a new difference quotient in the measured speed.
    reading: how long after the controller's instant the recorder reads [s], from 0 to below sample_time.
    """

    sample_time: float
    longest_step: float
    encoder_step: float
    position_gain: float
    speed_gain: float
    integral_time: float
    torque_limit: float
    reading: float = 0.0
    speed_share: float = 1.0


@compiled
def acting(torque: float, c: Constants) -> float:
    """Return the torque that a command [N m] brings about."""
    if c.droop_power != 2.0:
        return torque * (1.0 - c.droop * abs(torque) ** c.droop_power)
    return torque * (1.0 - c.droop * torque * torque)


@compiled
def held(
    state: State, side: int, torques: tuple[float, float], late: float, span: float, s: Sampling, c: Constants
) -> tuple[State, int]:
    """Return state and gap side `span` seconds after the beginning of a sample.

    `torques` = (old, new) act one after the other, changing `late` seconds after the sample's beginning.
    """
    old, new = torques
    state, side = advance_many(state, old, side, min(late, span), s.longest_step, c)
    return advance_many(state, new, side, span - late, s.longest_step, c)


@compiled
def keep(states: Array, row: int, state: State) -> None:
    """Write the state to a row; number by number, as numba takes seconds to compile the assignment of a tuple."""
    for column in range(WIDTH):
        states[row, column] = state[column]


def open_loop(torque: Array, state: State, s: Sampling, c: Constants) -> Array:
    """Return the states (len(torque) + 1, WIDTH) under a held command sequence [N m]."""
    return compiled_open_loop(torque, state, s, packed(c))


def closed_loop(
    setpoint: Array, injected: Array, state: State, s: Sampling, c: Constants, injected_speed: Array | None = None
) -> tuple[Array, Array, Array]:
    """Return commanded torque (n,) [N m], states (n, WIDTH) at the sample instants, and those `reading` seconds later.

    Position P with speed feed-forward, speed PI with back-calculation, on the quantised encoder; `injected` [N m]
    is added before the limit, `injected_speed` [rad/s] to the wanted speed. The torque of sample i acts from
    t_i + drive_delay to t_(i+1) + drive_delay.
    """
    speed = np.zeros_like(setpoint) if injected_speed is None else injected_speed
    return compiled_closed_loop(setpoint, injected, speed, state, s, packed(c))


@compiled
def compiled_open_loop(torque: Array, state: State, s: Sampling, c: Constants) -> Array:
    """Return what `open_loop` does, for packed constants."""
    states = np.empty((torque.size + 1, WIDTH))
    side = 0
    for i in range(torque.size):
        keep(states, i, state)
        state, side = held(state, side, (0.0, acting(torque[i], c)), 0.0, s.sample_time, s, c)
    keep(states, torque.size, state)
    return states


@compiled
def compiled_closed_loop(
    setpoint: Array, injected: Array, injected_speed: Array, state: State, s: Sampling, c: Constants
) -> tuple[Array, Array, Array]:
    """Return what `closed_loop` does, for packed constants."""
    count = setpoint.size
    torque = np.empty(count)
    states = np.empty((count, WIDTH))
    read = np.empty((count, WIDTH))
    whole = math.floor(c.drive_delay / s.sample_time)
    late = c.drive_delay - whole * s.sample_time
    side = 0
    integral = 0.0
    old_angle = round(state.angle / s.encoder_step) * s.encoder_step
    old_setpoint = setpoint[0]
    radius = c.transmission / c.ratio
    speed = 0.0
    for i in range(count):
        keep(states, i, state)
        angle = round(state.angle / s.encoder_step) * s.encoder_step
        wanted_speed = (setpoint[i] - old_setpoint) / (radius * s.sample_time)
        wanted_speed += s.position_gain * (setpoint[i] / radius - angle) + injected_speed[i]
        quotient = (angle - old_angle) / s.sample_time
        speed = quotient if s.speed_share == 1.0 else speed + s.speed_share * (quotient - speed)
        error = wanted_speed - speed
        asked = s.speed_gain * error + integral + injected[i]
        torque[i] = min(max(asked, -s.torque_limit), s.torque_limit)
        integral += s.sample_time / s.integral_time * (s.speed_gain * error + torque[i] - asked)
        old_angle = angle
        old_setpoint = setpoint[i]
        new = acting(torque[i - whole], c) if i >= whole else 0.0
        old = acting(torque[i - whole - 1], c) if i >= whole + 1 else 0.0
        # Beside the run, so that reading does not touch it, not even in its rounding.
        keep(read, i, held(state, side, (old, new), late, s.reading, s, c)[0])
        state, side = held(state, side, (old, new), late, s.sample_time, s, c)
    return torque, states, read
