"""The floor of a judged recording: the error that the true plant has on the very samples that are judged.

The generator's own plant, with all that was planted, is led by the recorded motor angle (`tests.generator.driven`);
what it leaves of the recorded torque and position is filtered as the contract says (4th-order Butterworth, forward and
backward, the edge that the diagnosis states), at the samples that it states. The zero of the scale is free.
"""

from __future__ import annotations

import numpy as np
from scipy import signal

from feeddrive.diagnosis.judging.result import Diagnosis
from tests.generator.driven import driven
from tests.generator.runs import Array, at_rest, longest_step
from tests.recovery.fleet.case import Case


def floors(drawn: Case, result: Diagnosis) -> dict[str, float]:
    """Return the floor of each judged channel (SI rms); none for a recording that was spoilt."""
    if drawn.spoiling or not result.recordings:
        return {}
    errors = true_errors(drawn)
    row_time = drawn.true.row_time
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


def true_errors(drawn: Case) -> dict[str, Array]:
    """Return recorded less predicted by the true plant, of the recording that is judged, (rows,) each.

    The plant is led by a spline through the recorded angle, as a diagnosis is, so that the encoder's steps shake its
    friction as they do there. Rows far apart do not tell the motion between all of them: these are not judged.
    """
    run = drawn.runs[1]
    c = run.constants
    step = longest_step(c, drawn.true.axis.top_speed)
    factor = drawn.off.get("torque_constant", 1.0)
    recorded, start = factor * drawn.judge["motor_torque"], at_rest(run.setpoint[0], c)
    torque, position = driven(drawn.true, c, drawn.judge["motor_angle"], start, step, recorded)
    errors = {"motor_torque": (recorded - torque) / factor}
    if "table_position" in drawn.judge:
        errors["table_position"] = drawn.judge["table_position"] - position
    return errors
