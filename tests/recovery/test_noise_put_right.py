"""Noise that was read too high: put right once what the channel answers has a name."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from feeddrive.diagnosis.calibration.calibrate import calibrated
from feeddrive.diagnosis.diagnose import diagnose
from feeddrive.diagnosis.finding.refitting import levelled
from feeddrive.diagnosis.likelihood.fit import fit
from feeddrive.diagnosis.likelihood.problem import LEVEL
from feeddrive.diagnosis.preparation import prepared
from feeddrive.plant.file.plant_file import read_plant
from feeddrive.recording import read_recording
from tests.recovery.fleet.case import case
from tests.recovery.rigid_runs import PLANT, Truth, rigid_run


@pytest.mark.parametrize("times", [1.0, 2.0, 5.0])
def test_noise_above_what_a_set_leaves_is_put_right(times: float, tmp_path: Path) -> None:
    path = tmp_path / "rigid.toml"
    path.write_text(PLANT, encoding="utf-8")
    problem = calibrated(prepared(read_plant(path), [rigid_run("a", Truth())], [], 1.0)[0])
    (before,) = problem.evidence
    loud = replace(before, noise={name: times * noise for name, noise in before.noise.items()})
    told = replace(problem, evidence=(loud,))
    after, found = levelled(told, fit(told, ()))
    assert found.effects == ()
    if times == 1.0:  # as it is
        assert after is told
        return
    (right,) = after.evidence
    for name, noise in before.noise.items():
        # it was put right by what was left then, and is by what is left now: each within what a level is known to
        assert LEVEL < right.noise[name] / noise < 1 / LEVEL


@pytest.mark.slow
def test_an_asymmetry_beside_a_resonance_that_is_excited_is_found(tmp_path: Path) -> None:
    """Fourth differences of the torque hold the chirp and the resonance: the noise was read 2.7 times too high."""
    plant_file, fitted, judged = case(9586).write(tmp_path)
    found, _ = diagnose(read_plant(plant_file), [read_recording(fitted)], [read_recording(judged)])
    assert {one.name for one in found.effects} == {"structural_mode", "coulomb_asymmetry"}
