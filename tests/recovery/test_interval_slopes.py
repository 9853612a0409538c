"""Slopes that intervals are made of: a mass is told by a hundredth of what it does where all else may be other."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from feeddrive.diagnosis.calibration.calibrate import with_kept
from feeddrive.diagnosis.certainty.uncertainty import certainty, slopes
from feeddrive.diagnosis.likelihood.coordinates import write_coordinates
from feeddrive.diagnosis.likelihood.fit import Fit, fit
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.effects.catalogue import EFFECTS
from feeddrive.typing import FloatArray
from tests.recovery.fleet.problem import calibrated_case

LIGHTER = 700_115
"""A table 250 kg lighter than declared, each other value somewhere in its tolerance."""


@pytest.fixture(scope="module")
def problem(tmp_path_factory: pytest.TempPathFactory) -> Problem:
    problem = calibrated_case(LIGHTER, tmp_path_factory.mktemp("lighter"))
    assert problem.calibration is not None
    # the payload says it of the table's mass
    return with_kept(problem, [value.key != "table_mass" for value in problem.calibration.values])


@pytest.fixture(scope="module")
def lighter(problem: Problem) -> Fit:
    return fit(problem, (EFFECTS["payload"].of(mass=-250.0),), iterations=3)


def exact(problem: Problem, found: Fit) -> FloatArray:
    """The slope from both sides, by a step 300 times as long as a fit's, in which a mass does not bend."""
    sides = [write_coordinates(found.effects, problem.plant, found.coordinates + step) for step in (0.03, -0.03)]
    ahead, behind = (problem.predicted(effects) for effects in sides)
    column: FloatArray = (ahead - behind) / 0.06
    return column


def test_slope_is_that_of_the_machine_not_of_its_solver(problem: Problem, lighter: Fit) -> None:
    true = np.linalg.norm(exact(problem, lighter))
    # an interval a twentieth off is as good as one of several hundred degrees of freedom
    assert np.linalg.norm(slopes(problem, lighter)) == pytest.approx(true, rel=0.05)


def test_interval_does_not_hang_on_the_slope_that_the_fit_came_with(problem: Problem, lighter: Fit) -> None:
    assert problem.whitener is not None
    (length,) = problem.whitener.lengths(lighter.jacobian)
    random = np.random.default_rng(0).normal(size=lighter.jacobian.shape)
    off = lighter.jacobian + 0.01 * length * random / np.linalg.norm(random)
    wrong = certainty(problem, replace(lighter, jacobian=off)).covariance
    np.testing.assert_allclose(wrong, certainty(problem, lighter).covariance, rtol=0.1)  # as of the slope


def test_lengths_are_those_before_values_are_whitened_away(problem: Problem) -> None:
    assert problem.whitener is not None
    columns = np.random.default_rng(1).normal(size=(len(problem.whitener.columns), 2))
    columns[:, 0] = problem.whitener.columns @ np.ones(len(problem.whitener.sizes))
    applied = np.column_stack([problem.whitener.applied(column) for column in columns.T])
    np.testing.assert_allclose(problem.whitener.lengths(applied), np.linalg.norm(columns, axis=0), rtol=1e-6)
