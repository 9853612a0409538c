"""Declared values within their tolerances are calibrated and not named; beyond them they are; steps are no machine."""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path

import pytest

from feeddrive.diagnosis.diagnose import diagnose
from feeddrive.diagnosis.judging.result import Diagnosis
from feeddrive.diagnosis.plant_text import with_calibrated_values
from feeddrive.plant.file.plant_file import read_plant
from tests.generator.axis import BENCH
from tests.generator.pair import recording_pair
from tests.recovery.planted import axis_plant
from tests.recovery.rigid_runs import COULOMB, MASS, PLANT, Truth, rigid_run
from tests.recovery.suite.motion import as_recording

RECORDED = 'source = "catalogue"\n\n[ball_screw]'
"""Tolerances of 5 % on the mass and of 30 % on friction."""


def of_rigid_machine(truth: Truth, folder: Path) -> tuple[Diagnosis, str]:
    text = PLANT.replace("[ball_screw]", RECORDED, 1)
    (folder / "plant.toml").write_text(text, encoding="utf-8")
    plant = read_plant(folder / "plant.toml")
    judged = rigid_run("judged", dataclasses.replace(truth, seed=2), 9.0, slow=1.2)
    return diagnose(plant, [rigid_run("fitted", truth)], [judged])[0], text


def test_values_within_their_tolerances_are_calibrated_and_not_named(tmp_path: Path) -> None:
    result, text = of_rigid_machine(Truth(coulomb=1.15, viscous=0.9, mass=0.03 * MASS), tmp_path)
    assert result.effects == ()
    known = {one.key: one for one in result.calibrated}
    low, high = known["table.coulomb"].ci95
    assert low < 1.15 < high
    # as near as sensor noise of the torque lets it: with the true values nothing else is left
    assert result.channels[0].after.rms < 1.1 * result.channels[0].noise_rms
    after = tmp_path / "after.toml"
    after.write_text(with_calibrated_values(text, result.calibrated), encoding="utf-8")
    values = read_plant(after)
    assert values.effects[0].values["coulomb"] == pytest.approx(known["table.coulomb"].value * COULOMB)
    assert "calibrated by recordings" in values.origins["table_mass"]


def test_a_mass_beyond_its_tolerance_is_named(tmp_path: Path) -> None:
    result, _ = of_rigid_machine(Truth(coulomb=1.15, viscous=0.9, mass=0.25 * MASS), tmp_path)
    assert [one.name for one in result.effects] == ["payload"]
    ends = result.effects[0].parameters["mass"].ci95
    assert ends is not None
    low, high = ends
    assert isinstance(low, float)
    assert isinstance(high, float)
    assert low < 0.25 * MASS < high


@pytest.mark.slow
@pytest.mark.parametrize("bits", [14, 16])
def test_steps_of_an_encoder_are_no_machine(bits: int) -> None:
    sensors = dataclasses.replace(BENCH.sensors, encoder_bits=bits)
    fitted, judged = recording_pair(dataclasses.replace(BENCH, sensors=sensors), (), (41, 42), (9.0, 7.0))
    result, _ = diagnose(axis_plant("bench"), [as_recording(fitted, "fit")], [as_recording(judged, "judge")])
    assert result.effects == ()
    assert math.isfinite(result.channels[0].after.rms)
