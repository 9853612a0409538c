"""Ripples that are no longer missed: below what the steps of an encoder shake, and among fringes that take as much."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from feeddrive.diagnosis.calibration.calibrate import calibrated
from feeddrive.diagnosis.diagnose import diagnose
from feeddrive.diagnosis.finding.scene import scene_of
from feeddrive.diagnosis.preparation import prepared
from feeddrive.diagnosis.starts.starts import ball_pass_ripple, ripple
from feeddrive.diagnosis.suspicion.logged import declared_hold
from feeddrive.effects.base import number
from feeddrive.plant.file.plant_file import read_plant
from feeddrive.recording import read_recording
from tests.recovery.fleet.case import case


@pytest.mark.xfail(strict=True, reason="frequencies that are mostly the encoder's error count for little: 40 to 80 Hz")
def test_ripple_is_looked_for_with_every_frequency_by_its_noise(tmp_path: Path) -> None:
    """3.7 mN m of order 8, where 17 bits shake a table of a ton by ten times as much at 40 to 80 Hz."""
    plant_file, fitted, _ = case(9580).write(tmp_path)
    plant = read_plant(plant_file)
    problem = calibrated(prepared(plant, [read_recording(fitted)], [], 1.0)[0])
    scene = scene_of(problem, [])
    raw = scene.residuals[0]["motor_torque"][problem.evidence[0].fit_rows]
    assert float(np.std(raw)) > 9 * 3.66e-3
    (starts,) = ripple(scene)
    nearest = min(starts, key=lambda one: abs(number(one.values["order"]) - 8.0))
    turns = float(np.ptp(scene.runs[0].motor_angle)) / (2 * np.pi)
    assert number(nearest.values["order"]) == pytest.approx(8.0, abs=1 / (8 * turns))
    assert number(nearest.values["amplitude"]) == pytest.approx(3.66e-3, rel=0.15)


def test_right_order_is_among_starts_whose_fringes_take_as_much(tmp_path: Path) -> None:
    """Balls pass 6.081 times a turn, on 44 turns that are slow at their two ends: 6.031 was the only start."""
    plant_file, fitted, judged = case(701242).write(tmp_path)
    plant, recordings = read_plant(plant_file), [read_recording(fitted), read_recording(judged)]
    problem = prepared(plant, recordings[:1], recordings[1:], 1.0, declared_hold(plant, recordings))[0]
    (starts,) = ball_pass_ripple(scene_of(calibrated(problem), []))
    nearest = min(starts, key=lambda one: abs(number(one.values["order"]) - 6.0811))
    # a fit goes to the top of the fringe that it begins on: these are 0.05 apart
    assert number(nearest.values["order"]) == pytest.approx(6.0811, abs=0.01)


@pytest.mark.slow
def test_both_orders_of_that_ripple_are_named(tmp_path: Path) -> None:
    """Its law is another: a second harmonic of 0.6. "Nothing" was named."""
    plant_file, fitted, judged = case(9580).write(tmp_path)
    found, _ = diagnose(read_plant(plant_file), [read_recording(fitted)], [read_recording(judged)])
    assert [one.name for one in found.effects] == ["torque_ripple"] * 2
    assert sorted(float(one.parameters["order"].value) for one in found.effects) == pytest.approx([8, 16], abs=0.02)
