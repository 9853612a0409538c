"""A tight place of which the strokes pass one side: peak, centre and width are known together, and that it is there.

Where its top would lie off the stroke, or another form is needed, it is told as a curve over what the strokes pass.
"""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from feeddrive.diagnosis.calibration.calibrate import calibrated
from feeddrive.diagnosis.certainty.one_sided import all_intervals
from feeddrive.diagnosis.certainty.profile import profiled
from feeddrive.diagnosis.certainty.uncertainty import certainty, intervals
from feeddrive.diagnosis.diagnose import diagnose
from feeddrive.diagnosis.finding.refitting import refitted, with_value_beyond
from feeddrive.diagnosis.forms.curve_in_place import with_level_in_curve
from feeddrive.diagnosis.forms.flank import with_curve_for_flank
from feeddrive.diagnosis.judging.asked_of_fit import sizes_around_none
from feeddrive.diagnosis.likelihood.fit import Fit, fit
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.preparation import prepared
from feeddrive.effects.friction.friction_vs_position import FrictionVsPosition
from feeddrive.plant.file.plant_file import read_plant
from feeddrive.recording import Recording
from tests.recovery.rigid_runs import COULOMB, LEAD, PLANT, SMOOTH, STEP, Truth, rigid_run

PEAK, CENTRE, WIDTH = 18.0, 0.2, 0.08
"""The strokes end at 0.092 m: they see a sixth of the peak at most, growing towards their end."""


def fitted(folder: Path, truth: Truth) -> tuple[Problem, Fit]:
    path = folder / "rigid.toml"
    path.write_text(PLANT, encoding="utf-8")
    problem, _, _ = prepared(read_plant(path), [rigid_run("a", truth)], [], 1.0)
    start = FrictionVsPosition.of(peak=PEAK, centre=CENTRE, half_width=WIDTH)
    return problem, fit(problem, [start])


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_it_is_there_though_its_peak_is_hardly_known(seed: int, tmp_path: Path) -> None:
    problem, found = fitted(tmp_path, Truth(bump=(PEAK, CENTRE, WIDTH), seed=seed))
    known = certainty(problem, found)
    slope = intervals(problem, found, known)[0]["peak"]
    assert slope is not None and slope[0][0] < 0 < slope[0][1]  # a line through a valley that bends
    without = fit(problem, ())
    assert without.squared_error > 1.5 * found.squared_error
    assert sizes_around_none(problem, found) == [""]
    told = all_intervals(problem, found, known)[0]["peak"]
    assert told is not None
    ((low, high),) = told
    assert 0 < low < PEAK < high
    # the lower end is where the likelihood falls, whatever the shape does
    at = profiled(problem, found, 0)
    assert at is not None and 0 < at[0] < float(found.coordinates[0]) < at[1]


def test_a_bump_in_noise_is_denied(tmp_path: Path) -> None:
    """Five recordings without one: a shape that is fitted to noise stands in more than one of twenty, not in most."""
    said = []
    for seed in range(5):
        problem, found = fitted(tmp_path, Truth(seed=10 + seed))
        said.append(sizes_around_none(problem, found) != [""])
    assert np.sum(said) >= 3


def test_held_coordinates_narrow_the_others(tmp_path: Path) -> None:
    problem, found = fitted(tmp_path, Truth(bump=(PEAK, CENTRE, WIDTH)))
    free, held = certainty(problem, found).covariance, certainty(problem, found, [1, 2]).covariance
    assert 0 < held[0, 0] < free[0, 0] and not held[1:, 1:].any()


R = LEAD / (2 * math.pi)
FORCE, TOP, HALF = 100.0, 0.14, 0.08
STROKE = -0.15, 0.15


def level(x: np.ndarray) -> np.ndarray:
    """What a guide has more of friction [N] at positions [m]: a form that is none of the package's."""
    return np.asarray(FORCE / (1 + ((x - TOP) / HALF) ** 2))


def on_a_flank(name: str, seed: int, slow: float) -> Recording:
    run = rigid_run(name, Truth(seed=seed), slow=slow)
    x = R * run["motor_angle"]
    middle = x + 0.5 * STEP * np.gradient(x, STEP)  # the torque of a sample is that at the middle of its hold
    friction = level(middle) * np.tanh(np.gradient(middle, STEP) / SMOOTH)
    return run.with_channels({"motor_torque": run["motor_torque"] + R * friction})


def test_a_flank_is_told_as_a_curve_within_the_stroke(tmp_path: Path) -> None:
    """The bump that fits this flank best has a peak of 1900 N at 0.59 m, where this axis has long ended."""
    path = tmp_path / "rigid.toml"
    path.write_text(PLANT, encoding="utf-8")
    plant = replace(read_plant(path), stroke=STROKE)
    found, _ = diagnose(plant, [on_a_flank("a", 1, 1.0)], [on_a_flank("b", 2, 1.3)])
    (law,) = found.effects
    assert law.name == "friction_vs_position"
    points, force = (np.array(law.parameters[key].value) for key in ("position", "delta_force"))
    assert STROKE[0] < points.min() and points.max() < STROKE[1]
    (coulomb,) = [one.value for one in found.calibrated if one.key == "table.coulomb"]
    # the two share a level; straight lines between points miss 0.5 N of the curve at most
    assert coulomb * COULOMB + force == pytest.approx(COULOMB + level(points), abs=0.02 * FORCE)


def test_a_top_that_was_passed_is_there_wherever_the_stroke_is_declared_from(tmp_path: Path) -> None:
    """An encoder that counts from the middle of a stroke of 0.3 to 0.6 m: the strokes pass the top at 0.03 m."""
    path = tmp_path / "rigid.toml"
    path.write_text(PLANT, encoding="utf-8")
    run = rigid_run("a", Truth(bump=(PEAK, 0.03, 0.02)))
    problem, _, _ = prepared(replace(read_plant(path), stroke=(0.3, 0.6)), [run], [], 1.0)
    found = fit(problem, [FrictionVsPosition.of(peak=PEAK, centre=0.03, half_width=0.02)])
    assert with_curve_for_flank(problem, found) == (problem, found)
    beyond = fit(problem, [FrictionVsPosition.of(peak=PEAK, centre=0.2, half_width=0.08)], iterations=0)
    assert isinstance(with_curve_for_flank(problem, beyond)[1].effects[0].values["position"], tuple)


def test_the_level_of_a_curve_is_no_other_friction(tmp_path: Path) -> None:
    """A curve about its mean would make three times the Coulomb friction of a guide that has what is declared."""
    path = tmp_path / "rigid.toml"
    path.write_text(PLANT, encoding="utf-8")
    problem, _, _ = prepared(read_plant(path), [on_a_flank("a", 1, 1.0)], [], 1.0)
    points = tuple(np.linspace(-0.091, 0.091, 12))
    curve = FrictionVsPosition.of(position=points, delta_force=(0.0,) * 12)
    problem = calibrated(problem)
    beyond = with_value_beyond(*refitted(problem, fit(problem, [curve])))
    assert beyond is not None
    assert [effect.name for effect in beyond[1].effects] == ["friction_vs_position", "friction_deviation"]
    levelled = with_level_in_curve(beyond)
    assert levelled is not None
    there, found = levelled
    (law,) = found.effects
    assert with_value_beyond(there, found) is None
    # one number to the recording: what is left is as it was, but for the prior of a value at rest
    assert found.squared_error == pytest.approx(beyond[1].squared_error, rel=0.01)
    assert np.mean(law.values["delta_force"]) == pytest.approx(np.mean(level(np.array(points))), abs=0.2 * COULOMB)
