"""A declared value at the factor that it may have at most still has a slope, and goes no further."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from feeddrive.diagnosis.calibration.calibrate import calibrated
from feeddrive.diagnosis.calibration.declared import FARTHEST_FACTOR
from feeddrive.diagnosis.calibration.value_slopes import LONG, STEP, slopes_of
from feeddrive.diagnosis.diagnose import diagnose
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.plant.file.plant_file import read_plant
from feeddrive.recording import read_recording
from feeddrive.typing import FloatArray
from tests.analytic.test_values_in_a_valley import DEVIATIONS, valley
from tests.recovery.fleet.case import case
from tests.recovery.rigid_runs import Truth
from tests.recovery.test_value_asked_once import begun


def slopes_with(problem: Problem, shares: FloatArray) -> FloatArray:
    """Slopes of the torque where each value stands at a share of its farthest, (n, k)."""
    known = problem.calibration
    assert known is not None
    far = np.array([value.farthest for value in known.values])
    return slopes_of(problem.at_values(shares * far), (), problem.evidence[0])["motor_torque"]


@pytest.mark.parametrize("way", [-1.0, 1.0])
def test_slopes_at_an_end_are_those_just_inside(tmp_path: Path, way: float) -> None:
    problem = calibrated(begun(tmp_path, Truth()))
    assert problem.calibration is not None
    for place, value in enumerate(problem.calibration.values):
        at_end, inside = np.zeros((2, len(problem.calibration.values)))
        at_end[place] = way
        inside[place] = way * (1 - 2 * LONG / np.log(FARTHEST_FACTOR))
        there, near = (slopes_with(problem, shares)[:, place] for shares in (at_end, inside))
        assert np.linalg.norm(there) > 0, value.words
        # a slope is another by the share that lies between the two steps; by twice that with a width, in a tanh
        assert np.linalg.norm(there - near) < 2 * (2 * LONG + STEP) * np.linalg.norm(there), value.words


def test_no_step_leads_beyond_an_end() -> None:
    start = np.zeros(5)
    far = np.log(FARTHEST_FACTOR) / DEVIATIONS
    start[0] = -0.9 * far[0]  # the motor has least of its inertia, and it lacks some
    problem = valley(start)
    residual = problem.unwhitened(())
    assert problem.whitener is not None
    pushed = problem.stepped((), residual)
    assert pushed.calibration is not None
    assert np.all(np.abs(pushed.calibration.coordinates) <= far)
    assert np.any(np.abs(pushed.calibration.coordinates) == far)


@pytest.mark.slow
def test_warm_up_of_a_drag_that_is_more_than_declared_is_named(tmp_path: Path) -> None:
    """0.88 of a drag of 1.2 times the declared one is lost: beside the declared one, all and more."""
    plant_file, fitted, judged = case(704_406).write(tmp_path)
    found, _ = diagnose(read_plant(plant_file), [read_recording(fitted)], [read_recording(judged)])
    names = {effect.name: effect for effect in found.effects}
    # drags of guide and screw, 1.28 and 1.18 of the declared, are beyond half of their tolerance and may be named
    assert names.keys() - {"friction_deviation"} == {"viscous_warmup"}
    constant = names["viscous_warmup"].parameters["time_constant"]
    assert constant.ci95 is not None
    low, high = np.ravel(constant.ci95)
    assert low < 5.204 < high
    # as is asked of drawn machines; with viscous_asymmetry in its place the torque is left at 2.3 times the floor
    assert all(one.after.rms < 1.15 * one.noise_rms for one in found.channels)
