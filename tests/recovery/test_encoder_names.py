"""Encoders of 17 bits: what answers the motor as a filter does is no name for taking the steps' error away."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from feeddrive.diagnosis.calibration.calibrate import calibrated, levelled_alike
from feeddrive.diagnosis.likelihood.encoder_along import encoder_along
from feeddrive.diagnosis.likelihood.fit import fit
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.likelihood.set_evidence import log_odds, variance_along
from feeddrive.diagnosis.likelihood.standing import Standing, odds_between
from feeddrive.diagnosis.motion import encoder_error
from feeddrive.diagnosis.preparation import prepared
from feeddrive.effects.chain.structural_mode import StructuralMode
from feeddrive.effects.source.constant_force import ConstantForce
from feeddrive.plant.file.plant_file import read_plant
from tests.recovery.fleet.case import ENCODER_NULLS
from tests.recovery.fleet.problem import calibrated_case
from tests.recovery.rigid_runs import PLANT, Truth, rigid_run

RINGING = ENCODER_NULLS + 17_752
"""A machine of 442 kg with 17 bits and a scale of 0.5 µm, at 2 kHz, that lacks nothing."""

COUNT = 40
"""Candidates and starts of a round."""

MODE = StructuralMode.of(mass=13.7, frequency=64.9, damping=0.197)
"""Where a fit of it ends while frequencies of much error count in full."""

FORCE = ConstantForce.of(force=5.0)


@pytest.fixture(scope="module")
def problem(tmp_path_factory: pytest.TempPathFactory) -> Problem:
    return calibrated_case(RINGING, tmp_path_factory.mktemp("ringing"))


@pytest.fixture(scope="module")
def in_full(tmp_path_factory: pytest.TempPathFactory) -> Problem:
    """The machine with frequencies that are mostly the encoder's error counted as all others are."""
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(encoder_error, "_share_of_recorded", lambda recorded, density, time: np.zeros_like(density))
        return calibrated_case(RINGING, tmp_path_factory.mktemp("in_full"))


def test_a_damped_mode_that_filters_the_steps_is_no_name(problem: Problem, in_full: Problem) -> None:
    """Where all frequencies count it is likelier than 20 to 1 by the colour of what is left, and not beside what the
    steps give; where those that are mostly error count little nothing speaks for it."""
    nothing, mode = fit(in_full, ()), fit(in_full, [MODE])
    assert log_odds(in_full, nothing, mode, COUNT) > 3.0
    odds = odds_between(Standing(in_full, nothing), Standing(in_full, mode), COUNT)
    assert odds < 0.0
    assert odds_between(Standing(in_full, mode), Standing(in_full, nothing), COUNT) == pytest.approx(-odds)
    assert log_odds(problem, fit(problem, ()), fit(problem, [MODE]), COUNT) < 0.0


def test_what_the_steps_give_a_force_is_chance(in_full: Problem) -> None:
    """The mean of four squares of chance is within five times its variance but once in 2000; a mode's is far beyond."""
    nothing = fit(in_full, ())
    for effect, is_chance in ((FORCE, True), (MODE, False)):
        having = fit(in_full, [effect])
        steps = encoder_along(in_full, in_full.machine(()), in_full.machine(having.effects))
        assert (steps < 5 * variance_along(in_full, having, nothing, having)) is is_chance


def test_every_kth_sample_is_weighed_as_all_are(problem: Problem) -> None:
    (evidence,) = problem.evidence
    predicted, every = problem.predictor.predict(problem.machine(()), evidence), evidence.thinning
    rows = evidence.counted[::every]
    for name in evidence.channels:
        left = evidence.measured[name] - predicted[name]
        whole, thin = evidence.evened(name, left, 1)[::every][rows], evidence.evened(name, left, every)[rows]
        # of what folds onto the edge the band's filter leaves 1.3e-3: (f / edge)^8 at 2.3 times the edge
        assert np.linalg.norm(whole - thin) < 1.3e-3 * np.linalg.norm(whole)


def test_of_two_laws_of_as_many_values_neither_comes_first_by_their_order(problem: Problem) -> None:
    first, second = (Standing(problem, fit(problem, [one])) for one in (FORCE, ConstantForce.of(force=-5.0)))
    mode, other = (Standing(problem, fit(problem, [one], iterations=0)) for one in (MODE, MODE.with_values(mass=5.0)))
    for a, b in ((first, second), (mode, other)):
        assert odds_between(a, b, COUNT) == pytest.approx(-odds_between(b, a, COUNT), abs=1e-9)


def test_an_encoder_that_tells_its_motion_gives_nothing(tmp_path: Path) -> None:
    fine = calibrated_case(ENCODER_NULLS + 24_752, tmp_path)
    assert not any(evidence.at_draws for evidence in fine.evidence)
    assert encoder_along(fine, fine.machine(()), fine.machine([FORCE])) == 0.0


def test_a_torque_that_answers_the_steps_is_no_noise_beside_which_they_do_not_matter(tmp_path: Path) -> None:
    """What a loop answers beyond the band reads as noise of the torque; it is put right, and the steps asked again."""
    path = tmp_path / "rigid.toml"
    path.write_text(PLANT, encoding="utf-8")
    run = rigid_run("answering", Truth())
    rows, step = np.arange(len(run.time)), 2 * np.pi / 2**12
    coarse = step * np.round(run["motor_angle"] / step)
    answered = run["motor_torque"] + 0.3 * (-1.0) ** rows * (1 + 0.5 * np.sin(0.3 * rows))
    loud = run.with_channels({"motor_angle": coarse, "motor_torque": answered})
    problem, _, _ = prepared(read_plant(path), [loud], [], 1.0)
    (before,) = problem.evidence
    (after,) = calibrated(problem).evidence
    assert not before.at_draws
    # 2 mN m were added in the whole band; what is read of 0.3 N m beyond it is a hundred times that
    assert after.at_draws and after.noise["motor_torque"] < 0.3 * before.noise["motor_torque"]
    judged = levelled_alike(before, problem.evidence, [after], problem.plant)
    assert judged.noise == pytest.approx(after.noise) and judged.at_draws
    assert levelled_alike(before, problem.evidence, problem.evidence, problem.plant) is before
