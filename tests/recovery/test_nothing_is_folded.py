"""A healthy machine with a mode near the rate of its rows: what it answers to steps of the torque is no slow motion."""

from __future__ import annotations

from pathlib import Path

import pytest

from feeddrive.diagnosis.diagnose import diagnose
from feeddrive.plant.file.plant_file import read_plant
from feeddrive.recording import read_recording
from tests.recovery.fleet.case import case


@pytest.mark.slow
def test_nothing_is_named_where_rows_fold_a_mode_into_the_band(tmp_path: Path) -> None:
    """The screw rings against the motor at 941 Hz, rows at 1 kHz: a resonance at 56 Hz and a payload were named."""
    plant_file, fitted, judged = case(9543).write(tmp_path)
    found, _ = diagnose(read_plant(plant_file), [read_recording(fitted)], [read_recording(judged)])
    assert not found.effects and not any(left.carried for left in found.unexplained.values())
    assert any("a mode near the rate of the rows" in note for note in found.notes)
