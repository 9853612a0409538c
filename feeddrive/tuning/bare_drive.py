"""The cascade of a drive before it is tuned: rates, current loop, dead time, feedback and limits, no gains yet."""

from __future__ import annotations

import math

from feeddrive.plant.plant import Plant
from feeddrive.servo.cascade import Cascade, Feedback, divider


def bare_drive(
    plant: Plant,
    velocity_rate: float,
    position_rate: float,
    current_bandwidth: float,
    dead_time: float,
    feedback: Feedback | None = None,
    where: str = "position_rate",
) -> Cascade:
    """A cascade without gains.

    Args:
        plant: gives the lead and the torque limit; the position loop reads its scale where one is declared.
        velocity_rate, position_rate: of the loops [Hz]; the first is a whole multiple of the second.
        current_bandwidth: -3 dB of the current loop [Hz].
        dead_time: of the torque [s].
        feedback: what the position loop reads, in place of the above.
        where: what the error names where the rates do not fit.

    Raises:
        InputError: rates that do not fit.
    """
    scale = any(sensor.channel == "table_position" for sensor in plant.sensors)
    return Cascade(
        radius=plant.chain.motor_radius,
        sample_time=1 / velocity_rate,
        position_divider=divider(velocity_rate, position_rate, where),
        position_gain=0.0,
        velocity_gain=0.0,
        reset_time=math.inf,
        tracking_time=1.0 + 1 / velocity_rate,
        torque_limit=plant.torque_limit,
        feedback=feedback or (Feedback.TABLE if scale else Feedback.MOTOR),
        current_lag=1 / (2 * math.pi * current_bandwidth),
        dead_time=dead_time,
    )
