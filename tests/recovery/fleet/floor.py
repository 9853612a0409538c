"""The floor of a judged recording: the error that the true plant would have on the very samples that were judged.

    e_T = n_T - Z n_angle,    e_x = n_x - H n_angle

| symbol | meaning |
|---|---|
| n | what the sensor added to torque, motor angle and table position: recorded less exact, known here alone |
| Z, H | torque and table position per motor angle of the true machine's linear chain |

Filtered as the contract says (4th-order Butterworth, forward and backward, the edge that the diagnosis states), at the
samples that it states; the zero of the scale is free.
"""

from __future__ import annotations

import numpy as np
from scipy import signal

from feeddrive.diagnosis.result import Diagnosis
from tests.generator.runs import transmitted
from tests.recovery.fleet.case import Case


def floors(drawn: Case, result: Diagnosis) -> dict[str, float]:
    """Return the floor of each judged channel (SI rms); none for a recording that was spoilt."""
    if drawn.spoiling or not result.recordings:
        return {}
    torque, angle, position = drawn.exact
    row_time = drawn.true.row_time
    to_torque, to_position = transmitted(drawn.true, drawn.judge["motor_angle"] - angle, row_time)
    factor = drawn.off.get("torque_constant", 1.0)
    errors = {"motor_torque": drawn.judge["motor_torque"] - torque - to_torque / factor}
    if "table_position" in drawn.judge:
        errors["table_position"] = drawn.judge["table_position"] - position - to_position
    edges = {channel.name: channel.band_hz[1] for channel in result.channels}
    found = {}
    for channel in result.recordings[0].channels:
        if channel.name not in errors:
            continue
        sections = signal.butter(4, edges[channel.name], fs=1.0 / row_time, output="sos")
        kept = np.isfinite(channel.measured) & np.isfinite(channel.after)
        first = round(float(result.recordings[0].time[0]) / row_time)
        error = signal.sosfiltfilt(sections, errors[channel.name])[first : first + len(kept)][kept]
        if channel.name == "table_position":
            error = error - np.mean(error)
        found[channel.name] = float(np.sqrt(np.mean(error**2)))
    return found
