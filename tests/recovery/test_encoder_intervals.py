"""Coarse encoders: the intervals of declared values hold what the machine has, where nothing is other than declared."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from feeddrive.diagnosis.calibration.beyond import beyond_tolerance
from feeddrive.diagnosis.calibration.calibrate import calibrated_list, with_kept
from feeddrive.diagnosis.calibration.encoder_scores import _scores, encoder_scores
from feeddrive.diagnosis.calibration.known import TOLERANCE
from feeddrive.diagnosis.diagnose import diagnose
from feeddrive.diagnosis.likelihood.fit import fit
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.motion.axis_evidence import AxisEvidence, from_zero
from feeddrive.diagnosis.motion.encoder_error import drawn_error, told_of
from feeddrive.diagnosis.motion.expected_motion import expected_motion
from feeddrive.plant.file.plant_file import read_plant
from feeddrive.recording import read_recording
from feeddrive.recording.checks.flaws import quantisation_step
from feeddrive.simulate.driven import motor_motion
from feeddrive.typing import FloatArray
from tests.recovery.fleet.case import ENCODER_NULLS, case
from tests.recovery.fleet.problem import calibrated_case

COARSE = ENCODER_NULLS + 14_021
"""A machine of 1570 kg with 14 bits and a scale of 1 nm, at 500 Hz: its steps show 40 times the noise of its scale."""


LIGHT_TORQUE = ENCODER_NULLS + 18_601
"""A machine of 572 kg with 18 bits and a scale of 0.1 µm: one variance for all values puts its mass four deviations off
and its damping five."""


@pytest.mark.slow
def test_a_value_that_one_variance_places_beyond_its_tolerance_is_not_named(tmp_path: Path) -> None:
    problem = calibrated_case(LIGHT_TORQUE, tmp_path)
    found = fit(problem, ())
    assert problem.calibration is not None
    assert np.max(np.abs(problem.calibration.coordinates)) > TOLERANCE  # that is where the search has one
    assert beyond_tolerance(problem, found) is None


@pytest.fixture(scope="module")
def problem(tmp_path_factory: pytest.TempPathFactory) -> Problem:
    return calibrated_case(COARSE, tmp_path_factory.mktemp("coarse"))


def test_intervals_hold_what_the_machine_has(problem: Problem) -> None:
    values = calibrated_list(problem, fit(problem, ()))
    outside = [one.value.key for one in values if not one.ends[0] <= 0.0 <= one.ends[1]]
    # of 13 intervals of 95 %, more than two miss once in forty; without the encoder's scores five do
    assert len(outside) <= 2, outside


def test_scores_are_those_of_an_encoder_that_matters(problem: Problem) -> None:
    scores = encoder_scores(problem)
    assert np.all(np.linalg.eigvalsh(scores) > -1e-9 * np.trace(scores))
    assert np.all(np.diag(scores) > 0)


def test_scores_hold_errors_that_were_not_drawn(problem: Problem) -> None:
    """Four draws tell of four directions over the whole recording; block by block they tell of all."""
    (evidence,) = problem.evidence
    assert isinstance(evidence, AxisEvidence) and problem.calibration is not None
    angle, step_time = evidence.recording["motor_angle"], evidence.recording.sample_time
    step = quantisation_step(angle)
    seen = expected_motion(angle, step, step_time)
    known = told_of(seen)
    expected = known.known(seen.angle)
    told = 0.0 if evidence.told is None else evidence.told
    further = [expected + told + drawn_error(seen, draw, known) for draw in range(4, 12)]
    others = replace(evidence, drawn=tuple(motor_motion(from_zero(evidence.recording), one) for one in further))
    sums = np.sum(_scores(problem, others, problem.calibration.values), axis=2)
    scores, scale = encoder_scores(problem), np.sqrt(np.diag(encoder_scores(problem)))
    beside = np.linalg.solve(scores / np.outer(scale, scale), sums / scale[:, None])
    # a chi-square of as many degrees, the mean of eight draws within a fifth of it;
    # scatter over the whole gave three times it
    assert np.mean(np.sum(sums / scale[:, None] * beside, axis=0)) < 2 * len(scores)


def test_a_value_that_is_named_leaves_the_scores_of_the_others(problem: Problem) -> None:
    scores, kept = encoder_scores(problem), [i % 3 > 0 for i in range(len(encoder_scores(problem)))]
    fewer = encoder_scores(with_kept(problem, kept))
    assert np.allclose(fewer, scores[np.ix_(kept, kept)], rtol=1e-9, atol=0)  # sums in another order


def test_slopes_weighed_once_are_those_of_all_values(problem: Problem) -> None:
    """Another place and another variance change what is taken away, not the slopes."""
    known, weighed = problem.calibration, problem.whitener
    assert known is not None and weighed is not None
    at = known.coordinates + 0.5
    moved = problem.at_values(at, 2.0 * known.variance).whitener
    anew = replace(problem, calibration=replace(known, coordinates=at, variance=2.0 * known.variance)).whitener
    assert moved is not None and anew is not None
    assert moved.columns is weighed.columns and np.array_equal(moved.offset, anew.offset)
    rows = np.linspace(-1.0, 1.0, len(weighed.offset))
    assert np.array_equal(moved.applied(rows), anew.applied(rows))
    assert not np.allclose(moved.applied(rows), weighed.applied(rows), rtol=1e-6, atol=0.0)


def test_declared_values_settle_nowhere_worse(problem: Problem) -> None:
    """Slopes from elsewhere point anywhere; the values stay where they are then."""
    known = problem.calibration
    assert known is not None
    turned = {of: {name: -slope for name, slope in one.items()} for of, one in known.slopes.items()}
    away = replace(problem, calibration=replace(known, coordinates=known.coordinates + 1.0, slopes=turned))
    settled = away.settled(()).calibration
    assert settled is not None

    def cost(coordinates: FloatArray) -> float:
        left = replace(problem, calibration=replace(known, coordinates=coordinates)).unwhitened(())
        return float(left @ left + known.variance * coordinates @ coordinates)

    assert cost(settled.coordinates) <= cost(known.coordinates + 1.0)


@pytest.mark.slow
def test_a_mass_that_moves_the_resonance_is_inside_its_interval(tmp_path: Path) -> None:
    """44.7 kg at 17 bits was told as 40.3 [36.9, 43.8], the encoder's error being that at the declared resonance."""
    drawn = case(10_262)
    plant, fitted, judged = drawn.write(tmp_path)
    result, _ = diagnose(read_plant(plant), [read_recording(fitted)], [read_recording(judged)])
    (payload,) = result.effects
    assert payload.name == "payload" and payload.parameters["mass"].ci95 is not None
    low, high = payload.parameters["mass"].ci95
    (planted,) = drawn.truth["planted"]
    assert isinstance(low, float) and low < planted["values"]["mass"] < high
