"""What a declared controller commands when it is fed the recorded set-point and motion, no plant in between.

Beside the recorded torque this says whether the declared controller is the one that was recorded, and where something
else had a part in the torque, such as a test signal that was injected and not recorded.
"""

from __future__ import annotations

import numpy as np
from scipy.interpolate import CubicSpline

from feeddrive.plant.plant import Plant
from feeddrive.recording import Recording
from feeddrive.simulate.controlled.declared_loop import DeclaredLoop
from feeddrive.typing import FloatArray

AT_ONCE = 1000
"""Ticks that are computed in one call."""


def replayed_command(plant: Plant, loop: DeclaredLoop, recording: Recording) -> FloatArray:
    """Torque that the controller brings about over a recording [N m], shape (n,), within the torque limit.

    Args:
        plant: gives the torque limit, and the table's motion where it was not recorded.
        loop: from `declared_loop`, for the recording's sample time.
        recording: with setpoint and motor_angle; what was injected counts where it was recorded.
    """
    controller = loop.controller
    fed = loop.reference(recording["setpoint"], recording.channels)
    time: FloatArray = controller.sample_time * np.arange(len(fed), dtype=np.float64)
    readings = _readings(plant, loop, recording, time)
    measured = np.column_stack([readings[name] for name in controller.measurements])
    position = readings["motor_angle"][0] * plant.chain.motor_radius if loop.at_motor else readings["table_position"][0]
    state = loop.started(plant, float(position)).initial
    many, parts = controller.function.mapaccum("replay", AT_ONCE), []
    for first in range(0, len(fed), AT_ONCE):
        ticks = np.minimum(np.arange(first, first + AT_ONCE), len(fed) - 1)  # the last tick fills up the last part
        states, asked, _ = many(
            state, fed[ticks].T, measured[ticks].T, ticks[None, :].astype(float), controller.parameters
        )
        state = states[:, -1]
        parts.append(np.array(asked).ravel())
    command = np.concatenate(parts)[: len(fed)]
    return loop.recorded_torque(np.clip(command, -plant.torque_limit, plant.torque_limit))


def _readings(plant: Plant, loop: DeclaredLoop, recording: Recording, time: FloatArray) -> dict[str, FloatArray]:
    """All that a controller may measure, at its ticks; the table follows the motor where it was not recorded."""
    angle = recording["motor_angle"]
    table = recording["table_position"] if "table_position" in recording else plant.chain.motor_radius * angle
    recorded = recording.sample_time * np.arange(len(recording))
    readings: dict[str, FloatArray] = {}
    for position, rate, series in (("motor_angle", "motor_speed", angle), ("table_position", "table_velocity", table)):
        followed = CubicSpline(recorded, series)
        readings[position], readings[rate] = followed(time), followed(time, 1)
    return readings
