"""Two laws that fall short of their first step in one round: both are asked, neither stands beside what is there."""

from __future__ import annotations

from pathlib import Path

from feeddrive.diagnosis.diagnose import diagnose
from feeddrive.effects.base import number
from feeddrive.plant.file.plant_file import read_plant
from feeddrive.recording import read_recording
from tests.recovery.fleet.case import case


def test_friction_of_a_fifth_is_named_alone_beside_two_laws_that_fall_short(tmp_path: Path) -> None:
    plant, fit, judge = case(702_646).write(tmp_path)
    _, (friction,) = diagnose(read_plant(plant), [read_recording(fit)], [read_recording(judge)])
    assert friction.name == "friction_deviation"
    assert number(friction.values["coulomb_factor"]) < 0.3  # 0.2; the interval ends at 0.24
