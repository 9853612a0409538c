"""Recordings of one file name are told apart by their folders."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from feeddrive.interface.measured.diagnosis_run import called_apart
from feeddrive.recording import Recording


def test_recordings_of_one_name_are_called_by_their_folders() -> None:
    time = np.arange(4) * 1e-3
    recording = Recording("recording.csv", time, {"motor_angle": time}, 1e-3)
    monday, tuesday, other = Path("monday/recording.csv"), Path("tuesday/recording.csv"), Path("monday/other.csv")
    assert called_apart(recording, tuesday, [monday, tuesday, other]).name == "tuesday/recording.csv"
    assert called_apart(recording, tuesday, [other, tuesday]).name == "recording.csv"
