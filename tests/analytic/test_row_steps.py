"""Steps of several rows: filters that change nothing in the band, and lengths that no comparison tells from rows."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from feeddrive.diagnosis.likelihood.evidence import UNSEEN
from feeddrive.diagnosis.motion.axis_evidence import AxisEvidence
from feeddrive.diagnosis.motion.band import Band
from feeddrive.diagnosis.motion.prediction import AxisPredictor
from feeddrive.diagnosis.motion.preparing import prepare
from feeddrive.diagnosis.motion.row_steps import in_longest_steps, in_told_steps
from feeddrive.effects.friction.guide_friction import GuideFriction
from feeddrive.effects.friction.presliding import Presliding
from feeddrive.plant.plant import Plant
from feeddrive.recording import Recording
from feeddrive.simulate.driven import GRID, FlankRests, motor_motion, simulate_driven
from feeddrive.simulate.row_steps import at_rows, at_steps, step_count
from tests.convergence.test_simulate import BENCH

ROW = 1.25e-4
FRICTION = GuideFriction.of(coulomb=200.0, viscous=0.0, smoothing_velocity=2e-4)
PLANT = Plant("sliding", BENCH, (FRICTION,))


@pytest.mark.parametrize("every", [2, 3, 8])
@pytest.mark.parametrize("rows", [2400, 2401, 2402])
def test_what_is_in_the_band_comes_back_as_it_was(every: int, rows: int) -> None:
    at = np.arange(rows)
    slow = 5.0 + np.sin(2 * np.pi * 0.1 / every * at + 0.3)  # a tenth of the steps' rate
    inner = slice(20 * every, -20 * every)
    steps = at_steps(slow, every)
    assert len(steps) == step_count(rows, every)
    assert np.abs(at_rows(steps, every, rows) - slow)[inner].max() < 1e-5  # 120 dB and what the window leaves
    assert at_rows(np.full(len(steps), 3.0), every, rows) == pytest.approx(np.full(rows, 3.0), rel=1e-14)
    fast = np.sin(2 * np.pi * 0.9 / every * at)  # would be read as a tenth
    assert np.abs(at_steps(fast, every))[20:-20].max() < 1e-5


def test_the_engine_takes_fewer_steps_and_says_the_same_in_the_band() -> None:
    time = ROW * np.arange(24001)
    motion = motor_motion(time, 12.0 * np.sin(2 * np.pi * 1.37 * time))
    rows, steps = simulate_driven(PLANT, motion), simulate_driven(PLANT, replace(motion, every=4))
    assert rows.report.samples == 4 * steps.report.samples
    band, inner = Band(150.0, 1 / ROW), slice(4000, -4000)
    jump = np.ptp(band.filter(rows.torque)[inner])
    # friction turns within a millisecond: what folds back of it in steps of half a millisecond
    assert np.abs(band.filter(steps.torque - rows.torque))[inner].max() < 2e-4 * jump
    # that moves the table by the torsion of the screw, some tens of nanometres between steps and less in the band
    assert np.abs(band.filter(steps.table_position - rows.table_position))[inner].max() < 1e-9
    np.testing.assert_array_equal(steps.motor_angle, motion.angle)


def test_rests_are_met_at_the_next_step() -> None:
    found = FlankRests(np.array([0, 1, 4, 6]), np.ones(4)).at_steps(4)
    assert found.samples.tolist() == [0, 1, 1, 2]


def test_steps_are_as_long_as_nothing_tells_them_from_rows() -> None:
    evidence, predictor = fast_recording(), AxisPredictor()
    found = in_longest_steps(evidence, PLANT, predictor)
    assert 1 < found.motion.every <= round(GRID / ROW)
    assert missed(found, PLANT) <= UNSEEN
    sharp = PLANT.with_effects(Presliding.of(stiffness=1e7, break_away=0.0))
    told = in_told_steps(found, sharp, predictor)
    assert isinstance(told, AxisEvidence)
    assert told.motion.every < found.motion.every
    assert missed(found, sharp) > UNSEEN >= missed(told, sharp)
    quiet = replace(evidence, noise={name: 1e-9 * noise for name, noise in evidence.noise.items()})
    assert in_longest_steps(quiet, PLANT, predictor).motion.every == 1
    assert in_told_steps(evidence, sharp, predictor) is evidence


def missed(evidence: AxisEvidence, plant: Plant) -> float:
    """Deviations of the noise between steps and rows."""
    rows = evidence.thinned(evidence.counted)
    steps, every = (AxisPredictor().predict(plant, one) for one in (evidence, evidence.in_steps(1)))
    return float(np.linalg.norm(evidence.weighted({name: steps[name] - every[name] for name in steps}, rows)))


def fast_recording() -> AxisEvidence:
    """Strokes with noise of torque and scale, at 8 kHz."""
    time, random = ROW * np.arange(40001), np.random.default_rng(5)
    angle = 12.0 * np.sin(2 * np.pi * 0.9 * time)
    run = simulate_driven(PLANT, motor_motion(time, angle))
    channels = {
        "motor_torque": run.torque + 0.02 * random.standard_normal(len(time)),
        "motor_angle": angle,
        "table_position": run.table_position + 2e-8 * random.standard_normal(len(time)),
    }
    return prepare(Recording("fast", time, channels, ROW), PLANT, 1.0)
