"""The plant under its declared controller: a cascade of position and velocity gain, sampled, its output held.

    u = K_vel (K_pos (x_set - x) - v),   |u| <= limit,   T = gain u

| symbol | meaning | unit |
|---|---|---|
| x_set, x, v | set-point, position and velocity read at the sample | m, m, m/s |
| u, T | controller output and motor torque, from the sample to the next | V, N m |

The position is read at the table, or from the motor angle where the sensor of the channel `table_position` is declared
to sit at the motor. The velocity is that of the model at the same place, not a difference quotient of positions.
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca
import numpy as np

from feeddrive.errors import InputError
from feeddrive.plant.plant import Plant, PositionVelocityController
from feeddrive.simulate.held_torque import initial_state, run_samples
from feeddrive.simulate.program import TOLERANCE, StepReport
from feeddrive.typing import Expression, FloatArray


@dataclass(frozen=True)
class ClosedLoopRun:
    """Motion of a plant under its controller, at the samples, shape (n,).

    Attributes:
        time: [s] as given.
        torque: motor torque commanded at the sample, before any delay [N m].
        output: of the controller, in its unit.
        position, velocity: of the table [m, m/s].
        motor_angle: [rad].
        report: how the steps went.
    """

    time: FloatArray
    torque: FloatArray
    output: FloatArray
    position: FloatArray
    velocity: FloatArray
    motor_angle: FloatArray
    report: StepReport


def simulate_closed_loop(
    plant: Plant, time: FloatArray, setpoint: FloatArray, initial_position: float, initial_velocity: float = 0.0,
    tolerance: float = TOLERANCE,
) -> ClosedLoopRun:  # fmt: skip
    """The plant under its declared controller; no torque before the start.

    Args:
        plant: with its values and a controller.
        time: sample times, evenly spaced [s], shape (n,).
        setpoint: of the table position at the samples [m], shape (n,).
        initial_position: of the table [m]; the transmission starts without force.
        initial_velocity: of the table [m/s].
        tolerance: error of the table position that a step may make [m].

    Returns:
        The motion and what the controller did.

    Raises:
        InputError: no controller declared, times that are not evenly spaced, lengths that differ, or a motion that
            cannot be followed.
    """
    if plant.controller is None:
        raise InputError("no controller is declared", plant.name, "add a [controller] table to the plant")
    settings = _settings(plant.controller, plant)
    command = _from_motor if _reads_motor(plant) else _from_table
    start = initial_state(plant, initial_position, initial_velocity)
    run = run_samples(plant, command, settings, time, setpoint, start, 0.0, tolerance)
    return ClosedLoopRun(run.time, run.torque, run.output, run.position, run.velocity, run.motor_angle, run.report)


def _reads_motor(plant: Plant) -> bool:
    return any(sensor.channel == "table_position" and sensor.at == "motor" for sensor in plant.sensors)


def _settings(controller: PositionVelocityController, plant: Plant) -> FloatArray:
    return np.array(
        [
            controller.position_gain, controller.velocity_gain, controller.output_limit,
            controller.torque_per_output, plant.torque_limit, plant.chain.radius,
        ]
    )  # fmt: skip


def _from_table(setpoint: Expression, readings: Expression, settings: Expression) -> tuple[Expression, Expression]:
    """The controller with its encoder at the table."""
    return _cascade(setpoint, readings[2], readings[3], settings)


def _from_motor(setpoint: Expression, readings: Expression, settings: Expression) -> tuple[Expression, Expression]:
    """The controller with its encoder at the motor."""
    radius = settings[5]
    return _cascade(setpoint, radius * readings[0], radius * readings[1], settings)


def _cascade(
    setpoint: Expression, position: Expression, velocity: Expression, settings: Expression
) -> tuple[Expression, Expression]:
    """Controller output and motor torque."""
    position_gain, velocity_gain, limit, gain, torque_limit = (settings[i] for i in range(5))
    output = _clipped(velocity_gain * (position_gain * (setpoint - position) - velocity), limit)
    return output, _clipped(gain * output, torque_limit)


def _clipped(value: Expression, limit: Expression) -> Expression:
    return ca.fmin(ca.fmax(value, -limit), limit)
