"""A plant led by a recorded motor angle: what the true plant makes of the very samples, nothing of the package in it.

The angle between rows is the cubic spline through them; screw and table follow by Runge-Kutta steps. The torque of a
row is the mean, over the cycle for which it acts, of

    T = J theta'' + twist / ratio + ripple

so that its error against the recorded one is the sensors' noise and what an inexact angle makes of it: the floor.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt
from scipy.interpolate import CubicSpline

from tests.generator.beside import commanded, led
from tests.generator.constants import Constants, packed
from tests.generator.machines import Machine
from tests.generator.motion import ripple_of, shifted, slopes, twist_of
from tests.generator.state import State, compiled
from tests.generator.transmission import side_of

Array = npt.NDArray[np.float64]


def driven(
    machine: Machine, c: Constants, angle: Array, start: State, longest: float, recorded: Array | None = None
) -> tuple[Array, Array]:
    """Return the recorded torque [N m] and table position [m] that a plant predicts from an angle, (rows,) each.

    Where a torque falls with the current, what the angle's steps make of the torque is many times that torque: the
    command is then found by the law's slope at the recorded one, beside which the sensor's noise is nothing.

    Args:
        machine: how it is recorded.
        c: of the plant, lateness of channels included.
        angle: of the motor at the rows, as recorded (rows,) [rad].
        start: state at the first row.
        longest: step of the integrator [s].
        recorded: torque that was commanded (rows,) [N m]; None where the angle is exact.
    """
    row_time, cycle = machine.row_time, machine.axis.sample_time
    times = np.arange(len(angle)) * row_time
    parts = max(1, math.ceil(row_time / longest))
    step = row_time / parts
    halves = 0.5 * step * np.arange(2 * parts * (len(angle) - 1) + 1)
    spline = CubicSpline(times - c.angle_lateness, angle)
    inside = np.minimum(halves, times[-1] - c.angle_lateness)
    torque, position = _driven(spline(inside), spline(inside, 1), spline(inside, 2)[::2].copy(), start, step, packed(c))
    grid = halves[::2]
    whole = np.concatenate([[0.0], np.cumsum(0.5 * step * (torque[1:] + torque[:-1]))])
    begins = times + c.drive_delay - c.torque_lateness
    mean = (np.interp(begins + cycle, grid, whole) - np.interp(begins, grid, whole)) / cycle
    asked = mean
    if c.droop != 0.0 and recorded is not None:
        lost = c.droop * np.abs(recorded) ** c.droop_power
        asked = recorded + (mean - recorded * (1.0 - lost)) / (1.0 - (c.droop_power + 1.0) * lost)
    elif c.droop != 0.0:
        asked = np.array([commanded(value, packed(c)) for value in mean])
    return asked, np.interp(times - c.table_lateness, grid, position)


@compiled
def _driven(angle: Array, speed: Array, acceleration: Array, start: State, step: float, c: Constants) -> tuple[
    Array, Array
]:  # fmt: skip
    count = acceleration.size
    torque, position = np.empty(count), np.empty(count)
    state = start
    for k in range(count):
        state = posed(state, angle[2 * k], speed[2 * k])
        torque[k] = c.motor_inertia * acceleration[k] + twist_of(state, c) / c.ratio + ripple_of(state, c)
        position[k] = state.position
        if k == count - 1:
            break
        side = side_of(state, c)
        first = slopes(state, 0.0, side, c)
        middle = posed(shifted(state, first, 0.5 * step), angle[2 * k + 1], speed[2 * k + 1])
        second = slopes(middle, 0.0, side, c)
        middle = posed(shifted(state, second, 0.5 * step), angle[2 * k + 1], speed[2 * k + 1])
        third = slopes(middle, 0.0, side, c)
        last = posed(shifted(state, third, step), angle[2 * k + 2], speed[2 * k + 2])
        fourth = slopes(last, 0.0, side, c)
        moved = shifted(shifted(state, first, step / 6.0), second, step / 3.0)
        state = shifted(shifted(moved, third, step / 3.0), fourth, step / 6.0)
    return torque, position


@compiled
def posed(state: State, angle: float, speed: float) -> State:
    """Return the state with this motor angle [rad] and speed [rad/s]."""
    return led(
        state,
        State(angle, speed, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
    )
