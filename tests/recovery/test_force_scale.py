"""What a recording cannot tell: masses, stiffnesses, frictions and the torque constant may all be larger alike."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from feeddrive.diagnosis.calibration import value_slopes
from feeddrive.diagnosis.calibration.calibration import Calibration
from feeddrive.diagnosis.calibration.declared import calibrated_values
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.motion.predictability import predictable_samples
from feeddrive.diagnosis.preparation import prepared
from feeddrive.effects.transmission.backlash import Backlash
from feeddrive.files import plants_folder
from feeddrive.plant.file.plant_file import read_plant
from feeddrive.recording import read_recording

DATA = Path(__file__).resolve().parents[1] / "data" / "bench"
PLAY = (Backlash.of(width=7.5e-6),)


@pytest.fixture(scope="module")
def problem(tmp_path_factory: pytest.TempPathFactory) -> Problem:
    """A recording of 7.5 um of play, every value of its plant with a tolerance, none fitted yet."""
    text = (plants_folder() / "bench_axis.toml").read_text(encoding="utf-8")
    path = tmp_path_factory.mktemp("machine") / "machine.toml"
    path.write_text(text.replace("simulated recordings", "data sheets"), encoding="utf-8")
    plant = read_plant(path)
    begun = prepared(plant, [read_recording(DATA / "backlash_train.csv.gz")], [], 1.0)[0]
    values = calibrated_values(plant)
    return replace(begun, calibration=Calibration(values, np.zeros(len(values)), {}, 1.0))


def test_slopes_tell_nothing_of_what_scales_every_force(problem: Problem) -> None:
    """Secants beside a free play are per cents off each: together they told a mass to 0.1 % that no row tells."""
    assert problem.calibration is not None
    values = problem.calibration.values
    keys = {one.key for one in values if one.scales_with_force}
    assert {"table_mass", "motor_inertia", "axial_stiffness", "table.coulomb", "torque_constant"} <= keys
    alike = np.array([one.scales_with_force / one.deviation for one in values])
    whole = problem.evidence[0]
    evidence = whole.where_predictable(predictable_samples(problem.machine(PLAY), whole))
    for name, of_rows in value_slopes.slopes_of(problem, PLAY, evidence).items():
        slopes = of_rows[evidence.thinned(evidence.fit_rows)]
        largest = np.linalg.norm(slopes * alike, axis=0).max()
        # an exact invariance of the equations: what is left is the rounding of two simulations
        assert np.linalg.norm(slopes @ alike) < 1e-5 * largest, name


def test_agreeing_slopes_are_changed_no_more_than_they_miss() -> None:
    random = np.random.default_rng(3)
    slopes, direction = random.standard_normal((50, 4)), np.array([2.0, -1.0, 0.0, 0.5])
    along = random.standard_normal(50)
    agreeing = value_slopes._agreeing(slopes, direction, along)
    np.testing.assert_allclose(agreeing @ direction, along, atol=1e-12)
    np.testing.assert_array_equal(agreeing[:, 2], slopes[:, 2])  # takes no part in it
    np.testing.assert_allclose(value_slopes._agreeing(slopes, direction, slopes @ direction), slopes, atol=1e-12)
    assert not value_slopes._agreeing(np.zeros((2, 4)), direction, np.ones(2)).any()  # rows that no value moves
