"""Encoders of 17 bits: what answers the motor as a filter does is no name for taking the steps' error away."""

from __future__ import annotations

from pathlib import Path

import pytest

from feeddrive.diagnosis.calibration.calibrate import calibrated
from feeddrive.diagnosis.likelihood.encoder_along import encoder_along, machines_of
from feeddrive.diagnosis.likelihood.fit import fit
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.likelihood.set_evidence import Standing, log_odds, odds_between
from feeddrive.diagnosis.preparation import prepared
from feeddrive.diagnosis.suspicion.logged import declared_hold
from feeddrive.effects.base import Effect
from feeddrive.effects.chain.structural_mode import StructuralMode
from feeddrive.effects.source.constant_force import ConstantForce
from feeddrive.plant.file.plant_file import read_plant
from feeddrive.recording import read_recording
from tests.recovery.fleet.case import ENCODER_NULLS, case

RINGING = ENCODER_NULLS + 17_752
"""A machine of 442 kg with 17 bits and a scale of 0.5 µm, at 2 kHz, that lacks nothing."""

COUNT = 40
"""Candidates and starts of a round."""


@pytest.fixture(scope="module")
def problem(tmp_path_factory: pytest.TempPathFactory) -> Problem:
    plant_file, fitted, judged = case(RINGING).write(tmp_path_factory.mktemp("ringing"))
    plant, recordings = read_plant(plant_file), [read_recording(path) for path in (fitted, judged)]
    hold = declared_hold(plant, recordings)
    return calibrated(prepared(plant, recordings[:1], recordings[1:], 0.75, hold)[0])


def test_a_damped_mode_that_filters_the_steps_is_no_name(problem: Problem) -> None:
    """Started where the error is least: likelier by the colour of what is left, and not beside what the steps give."""
    nothing, mode = fit(problem, ()), fit(problem, (StructuralMode.of(mass=13.7, frequency=64.9, damping=0.197),))
    assert log_odds(problem, nothing, mode, COUNT) > 10.0
    assert odds_between(Standing(problem, nothing), Standing(problem, mode), COUNT) < 0.0


def test_a_force_is_not_taken_for_the_steps(problem: Problem) -> None:
    """What the steps give along it is as chance gives: of the four squares of one deviation, 20 is one of 10⁴ means."""
    force: tuple[Effect, ...] = (ConstantForce.of(force=5.0),)
    assert encoder_along(problem, machines_of((problem, ()), (problem, force))) < 20.0


def test_machines_stand_in_the_order_of_their_effects(problem: Problem) -> None:
    force: tuple[Effect, ...] = (ConstantForce.of(force=5.0),)
    plain, other = machines_of((problem, force), (problem, ()))
    assert len(plain.effects) < len(other.effects)


def test_an_encoder_that_tells_its_motion_gives_nothing(problem: Problem, tmp_path: Path) -> None:
    plant_file, fitted, judged = case(ENCODER_NULLS + 24_752).write(tmp_path)
    plant, recordings = read_plant(plant_file), [read_recording(path) for path in (fitted, judged)]
    fine, _, _ = prepared(plant, recordings[:1], recordings[1:], 0.75, declared_hold(plant, recordings))
    assert not any(evidence.at_draws for evidence in fine.evidence)
    force: tuple[Effect, ...] = (ConstantForce.of(force=5.0),)
    assert encoder_along(fine, machines_of((fine, ()), (fine, force))) == 0.0
