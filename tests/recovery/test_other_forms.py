"""Laws of another form than the catalogue's keep their names, from the files of a drawn machine to its effects."""

from __future__ import annotations

from pathlib import Path

import pytest

from feeddrive.diagnosis.diagnose import diagnose
from feeddrive.plant.file.plant_file import read_plant
from feeddrive.recording import read_recording
from tests.recovery.fleet.case import case

pytestmark = pytest.mark.slow


@pytest.mark.parametrize(
    ("seed", "name"),
    [
        # a drag that goes with the 0.7th power of the speed: a step with a curve leaves as little, by more of a curve
        (701_405, "viscous_asymmetry"),
        # the same: straight, it would push the axis at its greatest speed, which nothing recorded has met
        (701_411, "viscous_asymmetry"),
        # the 1.5th power: a drop of friction at low speed leaves less by chance, and more beside their curves
        (701_363, "viscous_asymmetry"),
        # a place of another shape, in a channel that weighs little beside the declared values that stand in for it
        (701_639, "friction_vs_position"),
        # a stiffness that changes smoothly: the declared one had taken what the lag shows under load
        (9663, "preload_loss"),
    ],
)
def test_a_relative_has_its_name_and_no_other(seed: int, name: str, tmp_path: Path) -> None:
    plant_file, fitted, judged = case(seed).write(tmp_path)
    found, _ = diagnose(read_plant(plant_file), [read_recording(fitted)], [read_recording(judged)])
    assert [one.name for one in found.effects] == [name]
