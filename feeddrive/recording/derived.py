"""Channels that follow from those that were recorded: the motor angle from its speed."""

from __future__ import annotations

import numpy as np

from feeddrive.typing import FloatArray


def with_angle(columns: dict[str, FloatArray], time: FloatArray) -> tuple[dict[str, FloatArray], tuple[str, ...]]:
    """Return columns, SI, (n,) each, with the motor angle where only its speed was recorded, and a note on it.

    The angle is the integral by the trapezoidal rule, zero at the first sample: it has no relation to a position on the
    screw from one recording to the next, and an offset of the speed makes it drift.

    Args:
        columns: channel -> samples.
        time: (n,) [s].
    """
    if "motor_speed" not in columns or "motor_angle" in columns or "table_position" in columns:
        return columns, ()
    speed = columns["motor_speed"]
    angle = np.concatenate(([0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]) * np.diff(time))))
    note = "motor_angle is the integral of motor_speed: its zero is that of the recording, an offset makes it drift"
    return {**columns, "motor_angle": angle}, (note,)
