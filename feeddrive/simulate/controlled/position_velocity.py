"""The declared cascade of a position and a velocity gain as the function of one tick that engine and replay take.

    u = K_vel (K_pos (x_set - x) + r w_e - v),   |u| <= limit,   T = gain u + T_e,     v = (x_i - x_(i-m)) / (m h)

| symbol | meaning | unit |
|---|---|---|
| x_set, x, v | set-point, position and velocity read at the sample | m, m, m/s |
| u, T | controller output and motor torque, from the sample to the next | V, N m |
| w_e, T_e, r | injected speed and torque at the motor, travel per radian of it | rad/s, N m, m |
| m, h | samples over which the position is differenced, sample time; m = 0: v is the velocity itself | 1, s |

A drive with an encoder alone has no velocity but such a difference, and reads it m h / 2 late. The position is read at
the table, or from the motor angle where the sensor of the channel `table_position` is declared to sit at the motor.
"""

from __future__ import annotations

from functools import lru_cache

import casadi as ca
import numpy as np

from feeddrive.plant.plant import Plant, PositionVelocityController
from feeddrive.servo.sampled import SampledController
from feeddrive.symbolic_turn import SYMBOLS
from feeddrive.typing import Expression

PARAMETERS = ("position_gain", "velocity_gain", "output_limit", "torque_per_output", "radius", "sample_time")
"""Parameters of the function, in order."""

REFERENCES = ("position", "speed_excitation", "torque_excitation")
"""References: of the table [m]; injected at the motor [rad/s, N m]."""


def position_velocity_controller(
    plant: Plant, declared: PositionVelocityController, sample_time: float
) -> SampledController:
    """The declared controller, its earlier positions at 0.

    Args:
        plant: says where the position is read, and how far the table goes per radian of the motor.
        declared: gains, limit and how the velocity is read.
        sample_time: from one tick to the next [s].
    """
    at_motor = any(sensor.channel == "table_position" and sensor.at == "motor" for sensor in plant.sensors)
    samples = declared.velocity_samples
    # with differences the motor angle alone is read, as a drive does; a rigid table is there too
    position = "motor_angle" if at_motor else "table_position"
    rates = () if samples else ("motor_speed" if at_motor else "table_velocity",)
    values = [declared.position_gain, declared.velocity_gain, declared.output_limit, declared.torque_per_output]
    parameters = np.array([*values, plant.chain.motor_radius, sample_time])
    function = _function(samples, at_motor)
    return SampledController(
        function, np.zeros(samples), parameters, sample_time, REFERENCES, (position, *rates), ("output",)
    )


@lru_cache(maxsize=16)
@SYMBOLS.taken()
def _function(samples: int, at_motor: bool) -> ca.Function:
    state, fed, tick = ca.SX.sym("state", samples), ca.SX.sym("fed", len(REFERENCES)), ca.SX.sym("tick")
    measured = ca.SX.sym("measured", 1 if samples else 2)
    p = ca.SX.sym("p", len(PARAMETERS))
    scale = p[4] if at_motor else ca.SX(1.0)
    position = scale * measured[0]
    velocity = (position - state[0]) / (samples * p[5]) if samples else scale * measured[1]
    output = _clipped(p[1] * (p[0] * (fed[0] - position) + p[4] * fed[1] - velocity), p[2])
    after = ca.vertcat(*[state[i] for i in range(1, samples)], position) if samples else state
    return ca.Function("position_velocity", [state, fed, measured, tick, p], [after, p[3] * output + fed[2], output])


def _clipped(value: Expression, limit: Expression) -> Expression:
    return ca.fmin(ca.fmax(value, -limit), limit)
