"""Motion that an encoder does not tell: its parts, and what a plant gains that answers the motor as a filter does."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from feeddrive.diagnosis.calibration.calibrate import calibrated
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.motion.axis_evidence import AxisEvidence
from feeddrive.diagnosis.motion.encoder_error import told_of
from feeddrive.diagnosis.motion.expected_motion import expected_motion
from feeddrive.diagnosis.motion.preparing import weighed_by
from feeddrive.diagnosis.motion.unsure_motion import HALF, LEAST, unsure_motions, without_share
from feeddrive.diagnosis.preparation import prepared
from feeddrive.diagnosis.suspicion.logged import declared_hold
from feeddrive.effects.chain.stiffness_deviation import StiffnessDeviation
from feeddrive.plant.file.plant_file import read_plant
from feeddrive.recording import read_recording
from feeddrive.simulate.driven import MotorMotion, motor_motion
from feeddrive.typing import FloatArray
from tests.recovery.fleet.case import case

RATE, EDGE = 500.0, 50.0
TIME = np.arange(4096) / RATE

COARSE = 4667
"""A machine as declared with 12 bits, of the fleet, at 500 Hz: beyond 20 Hz its encoder tells nothing of the motion."""


def burst(hertz: float) -> FloatArray:
    """A vibration that comes and goes, [rad]."""
    return np.asarray(1e-3 * np.sin(2 * np.pi * hertz * TIME) * np.exp(-(((TIME - 4.1) / 0.8) ** 2)))


def test_parts_add_up_to_the_share_of_the_motion() -> None:
    angle, share = burst(20.0), np.full(len(TIME) // 2 + 1, 0.04)
    parts = list(unsure_motions(angle, share, 1 / RATE, EDGE))
    # nodes in thirds of an octave hold all of a line between them, once as it is and once a quarter of a period later
    np.testing.assert_allclose(sum(parts[::2]), 0.04 * angle, atol=0.04e-3 * 0.01)
    late = sum(parts[1::2])
    assert abs(late @ angle) < 0.01 * np.linalg.norm(late) * np.linalg.norm(angle)
    assert np.linalg.norm(late) == pytest.approx(0.04 * np.linalg.norm(angle), rel=0.01)


@pytest.mark.parametrize("gain", [4.0, 8.0, 20.0])
def test_a_loop_that_turns_at_a_pole_of_the_load_is_held_by_the_parts(gain: float) -> None:
    """The sensitivity 1 / (1 + L) of a loop whose gain goes to nothing at 20 Hz, where the load is damped by 0.01."""
    hertz, damping = 20.0, 0.01
    angle = np.random.default_rng(1).standard_normal(len(TIME)) * np.hanning(len(TIME))
    share = np.full(len(TIME) // 2 + 1, 0.04)
    pole = 2 * np.pi * hertz * (-damping + 1j)
    frequency = np.fft.rfftfreq(len(TIME), 1 / RATE)
    over = frequency.clip(0.5 * frequency[1]) / hertz
    loop = gain / (1j * over) * (1 - over**2 + 2j * damping * over)
    inside = np.abs(np.log2(over)) < 1
    wanted = (0.04 / (1 + loop) * np.fft.rfft(angle))[inside]

    def missed(poles: list[complex]) -> float:
        parts = np.fft.rfft(list(unsure_motions(angle, share, 1 / RATE, EDGE, poles)))[:, inside].T
        columns, column = (np.concatenate([one.real, one.imag]) for one in (parts, wanted))
        left = column - columns @ np.linalg.lstsq(columns, column, rcond=None)[0]
        return float(left @ left / (column @ column))

    # of its power a thirtieth to a third is missed by thirds of an octave alone, more with a greater gain
    assert missed([pole]) < min(0.003, 0.1 * missed([]))


def test_a_sure_motion_has_no_parts() -> None:
    share = np.full(len(TIME) // 2 + 1, 0.5 * LEAST)
    assert list(unsure_motions(burst(20.0), share, 1 / RATE, EDGE)) == []


def test_what_is_more_error_than_motion_is_left_out() -> None:
    angle, hertz = burst(10.0) + burst(30.0), np.fft.rfftfreq(len(TIME), 1 / RATE)
    kept = without_share(angle, np.where(hertz > 20.0, HALF, 0.1), 1 / RATE)
    np.testing.assert_allclose(kept, 0.9 * burst(10.0), atol=0.01e-3)


def test_the_stroke_is_left_alone() -> None:
    stroke = 40 * (1 - np.cos(2 * np.pi * np.clip((TIME - 2) / 4, 0, 1)))
    share = np.where(np.fft.rfftfreq(len(TIME), 1 / RATE) > 15.0, 1.0, 0.0)
    # begun and ended with a jump of acceleration, whose part beyond 15 Hz is a ten-thousandth of a radian
    np.testing.assert_allclose(without_share(stroke, share, 1 / RATE), stroke, atol=5e-3)


@pytest.fixture(scope="module")
def problem(tmp_path_factory: pytest.TempPathFactory) -> Problem:
    plant_file, fitted, judged = case(COARSE).write(tmp_path_factory.mktemp("coarse"))
    plant, recordings = read_plant(plant_file), [read_recording(path) for path in (fitted, judged)]
    return prepared(plant, recordings[:1], recordings[1:], 0.75, declared_hold(plant, recordings))[0]


def test_a_plant_that_filters_the_motion_gains_nothing(problem: Problem) -> None:
    """The true plant led by the motion, and by less of it: as by a mode, whose load does not follow a fast motor."""
    (evidence,) = problem.evidence
    assert isinstance(evidence, AxisEvidence)
    rows, sample_time = evidence.thinned(evidence.fit_rows), evidence.recording.sample_time
    hertz = np.fft.rfftfreq(len(rows), sample_time)

    def error(motion: MotorMotion) -> float:
        led = replace(evidence, motion=replace(motion, time=evidence.motion.time))
        predicted = evidence.weighted(problem.predictor.predict(problem.plant, led), rows)
        return float(np.sum((evidence.weighted(evidence.measured, rows) - predicted) ** 2))

    angle, whole = evidence.motion.angle[evidence.motion.samples], error(evidence.motion)
    for corner in (20.0, 25.0, 30.0, 36.0, 45.0):
        slow = without_share(angle, np.minimum(HALF * (hertz / corner) ** 4, 1.0), sample_time)
        less = error(motor_motion(np.arange(len(angle)) * sample_time, slow))
        # ten is what three values cost; with the steps' error in the motion it is a thousand
        assert 0.5 * (whole - less) < 10.0 * whole / (2 * rows.sum()), corner


def test_weights_are_those_of_the_machine_at_hand(problem: Problem) -> None:
    """As the declared plant shows the steps they are what was prepared; another stiffness shows them elsewhere."""
    (evidence,) = problem.evidence
    assert isinstance(evidence, AxisEvidence)
    as_declared = weighed_by(evidence, problem.plant)
    soft = weighed_by(evidence, problem.plant.with_effects(StiffnessDeviation.of(None, "all", factor=0.5)))
    assert isinstance(as_declared, AxisEvidence) and isinstance(soft, AxisEvidence)
    for name, gains in evidence.gains.items():
        np.testing.assert_allclose(as_declared.gains[name], gains, rtol=1e-9)
    # a softer table answers the steps otherwise, some hertz below its resonance too
    moved = soft.gains["table_position"] - evidence.gains["table_position"]
    assert np.max(np.abs(moved)) > 1e-3
    # the encoder tells the same motion to every machine; what it leaves open, the torque tells each for itself
    angles = []
    for one in (evidence, as_declared, soft):
        assert one.told is not None
        angles.append(one.motion.angle[one.motion.samples] - one.told)
    np.testing.assert_allclose(angles[1:], [angles[0]] * 2, atol=1e-9)


def test_declared_values_stay_where_nothing_is_other(problem: Problem) -> None:
    known = calibrated(problem).calibration
    assert known is not None
    # a posterior mean beyond two deviations of its prior is one of twenty at most; damping went to ten
    assert np.max(np.abs(known.coordinates)) < 2.0, dict(
        zip([value.key for value in known.values], known.coordinates, strict=True)
    )


def test_strokes_at_constant_speed_are_told_by_a_fine_encoder() -> None:
    """They move in lines of a spectrum; what is between them, or below them all, is as well known as anything."""
    step, rows = 2 * np.pi / 2**17, 8334
    strokes = 30.0 * np.abs((np.arange(rows) / RATE / 0.9) % 2 - 1)  # of 30 rad in 0.9 s, cut out of a long run
    turning = np.hanning(123)[1:-1]
    angle = np.convolve(np.pad(strokes, 60, mode="edge"), turning / np.sum(turning), mode="valid")
    expected = expected_motion(step * np.round(angle / step), step, 1 / RATE)
    share = told_of(expected).share
    left = without_share(expected.angle, share, 1 / RATE) - angle
    assert np.max(np.abs(left[250:-250])) < step  # half a second at either end is not compared


def test_a_vibration_that_comes_once_is_told_where_it_comes() -> None:
    """Strokes all along, and a burst of 60 Hz at the end: of the whole recording the steps make most at 60 Hz."""
    step, time = 2 * np.pi / 2**12, np.arange(20 * int(RATE)) / RATE
    strokes = 15.0 * (1 - np.cos(2 * np.pi * 0.4 * time))
    shaken = 1.5 * step * np.sin(2 * np.pi * 60.0 * time) * ((time > 17.5) & (time < 18.5))
    angle = strokes + shaken
    expected = expected_motion(step * np.round(angle / step), step, 1 / RATE)
    told = told_of(expected)
    known = told.known(expected.angle)
    hertz, over = np.fft.rfftfreq(len(time), 1 / RATE), np.fft.rfft(known - strokes)
    beyond = np.fft.irfft(np.where((hertz > 50) & (hertz < 70), over, 0), len(time))
    inside, before = (time > 17.6) & (time < 18.4), (time > 2) & (time < 17)
    # what is left of it is the steps' own error in 20 of 250 Hz, step / sqrt(12) * sqrt(20 / 250), and the expected
    # motion's taking away of as much again
    allowed = 2 * step / np.sqrt(12) * np.sqrt(20 / 250)
    assert np.sqrt(np.mean((beyond - shaken)[inside] ** 2)) < allowed < 0.2 * np.sqrt(np.mean(shaken[inside] ** 2))
    assert np.sqrt(np.mean(beyond[before] ** 2)) < 0.5 * allowed  # and none of the error elsewhere comes with it
    assert np.max(np.interp([55.0, 60.0, 65.0], hertz, told.share)) > 0.1


def test_a_rest_before_a_fast_stroke_stays_where_it_is() -> None:
    """16 bits at 4 kHz: the power of a rest is lost in rounding beside that of a stroke of 140 rad/s."""
    recording = case(703_320).fit
    angle, step, sample_time = recording["motor_angle"], 2 * np.pi / 2**16, 1 / 4000
    expected = expected_motion(angle, step, sample_time)
    told = told_of(expected)
    assert told.there.min() >= 0.0 and told.there.max() <= 1.0
    # what is left out is what the encoder does not tell: some of its steps
    assert np.max(np.abs(told.known(expected.angle) - angle)) < 4 * step
