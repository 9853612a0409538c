"""Friction of another power of the load than the first: the power is found, and none where there is none."""

from __future__ import annotations

from pathlib import Path

import pytest

from feeddrive.diagnosis.diagnose import diagnose
from feeddrive.diagnosis.judging.result import Diagnosis
from feeddrive.plant.file.plant_file import read_plant
from feeddrive.recording import read_recording
from tests.recovery.fleet.case import Case, case
from tests.recovery.fleet.floor import floors


def diagnosed(seed: int, folder: Path) -> tuple[Case, Diagnosis]:
    drawn = case(seed)
    plant, fitted, judged = drawn.write(folder)
    return drawn, diagnose(read_plant(plant), [read_recording(fitted)], [read_recording(judged)])[0]


@pytest.mark.slow
@pytest.mark.parametrize(("seed", "bend"), [(703_787, 1 / 3), (703_852, -1 / 3)])
def test_the_power_is_found_and_the_error_goes(seed: int, bend: float, tmp_path: Path) -> None:
    """Friction in proportion was as good on the fitted recording, and left 3.8 and 11 times the floor on the other."""
    drawn, found = diagnosed(seed, tmp_path)
    (friction,) = found.effects
    assert friction.name == "load_dependent_friction"
    power = friction.parameters["bend"]
    assert power.ci95 is not None
    low, high = power.ci95
    assert isinstance(low, float) and isinstance(high, float)
    assert low < bend < high and high - low < 0.1
    floor = floors(drawn, found)
    assert all(channel.after.rms < 1.05 * floor[channel.name] for channel in found.channels)


def test_friction_in_proportion_to_the_load_has_no_bend(tmp_path: Path) -> None:
    _, found = diagnosed(703_476, tmp_path)
    (friction,) = found.effects
    assert (friction.name, friction.parameters["bend"].value) == ("load_dependent_friction", 0.0)
