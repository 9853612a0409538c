"""A tight place of which the strokes pass one side: peak, centre and width are known together, and that it is there."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from feeddrive.diagnosis.certainty.one_sided import all_intervals
from feeddrive.diagnosis.certainty.profile import profiled
from feeddrive.diagnosis.certainty.uncertainty import certainty, intervals
from feeddrive.diagnosis.judging.asked_of_fit import sizes_around_none
from feeddrive.diagnosis.likelihood.fit import Fit, fit
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.preparation import prepared
from feeddrive.effects.friction.friction_vs_position import FrictionVsPosition
from feeddrive.plant.file.plant_file import read_plant
from tests.recovery.rigid_runs import PLANT, Truth, rigid_run

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
