"""Recordings written as files that a folder is watched for."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from feeddrive.recording import Recording

UNITS = {"motor_torque": "N m", "motor_angle": "rad", "table_position": "m"}
FORMS = {"motor_torque": "%.4f", "motor_angle": "%.7f", "table_position": "%.9f"}


def write_recording(path: Path, recording: Recording) -> Path:
    """Write a recording as CSV and return its path."""
    names = list(recording.channels)
    header = ",".join(["time [s]", *(f"{name} [{UNITS[name]}]" for name in names)])
    table = np.column_stack([recording.time, *recording.channels.values()])
    np.savetxt(path, table, delimiter=",", header=header, comments="", fmt=["%.3f", *(FORMS[name] for name in names)])
    return path
