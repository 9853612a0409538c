"""An hour of production, of which a minute is searched: its play is told beside maps that no name explains."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import feeddrive as fd
from feeddrive.recording.long import joined
from tests.recovery import trend_machine as machine
from tests.recovery.long_production import blocks

TRAVEL = {"lead_error_cumulative", "lead_error_periodic", "thermal_growth"}
"""Names of what the lead map looks like over what is compared; growth is told from a slope by hours alone."""


@pytest.mark.slow
@pytest.mark.parametrize(("seed", "play"), [(5, 6e-6)])
def test_play_of_an_hour(seed: int, play: float, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Beside a lead map of 4 µm and 1 µm a revolution, a tight place and drag that falls by 15 % in an hour or two."""
    monkeypatch.setattr(joined, "KEPT_ROWS", 50_000)  # half of what is kept else, to be searched in two minutes
    (tmp_path / "plant.toml").write_text(machine.PLANT, encoding="utf-8")
    time, torque, angle, table = np.concatenate(list(blocks(1.0, seed, play))).T
    recording = fd.Recording.from_arrays(
        time=time, motor_torque=np.round(torque, 4), motor_angle=np.round(angle, 6), table_position=np.round(table, 8)
    )
    found = fd.diagnose(fd.load(tmp_path / "plant.toml"), recording).diagnosis
    named = {one.name: one for one in found.effects}
    low, high = named["backlash"].parameters["width"].ci95
    assert low < play < high < 1.5 * play
    assert not {"preload_loss", "presliding"} & set(named)
    assert TRAVEL & set(named)  # the map is not silent
