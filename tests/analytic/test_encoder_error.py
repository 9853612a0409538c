"""The motion that is expected given steps of an encoder: it draws nothing towards none, and its error is as drawn."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from feeddrive.diagnosis.motion.band import Band
from feeddrive.diagnosis.motion.encoder_error import drawn_error
from feeddrive.diagnosis.motion.preparing import prepare
from feeddrive.diagnosis.motion.smoothest_motion import smoothest_motion
from feeddrive.files import find_plant
from feeddrive.plant.file.plant_file import read_plant
from feeddrive.recording.files.reading import read_recording
from feeddrive.typing import FloatArray

RATE, SECONDS, EDGE = 2000.0, 12.0, 150.0
TIME = np.arange(int(RATE * SECONDS)) / RATE
STEP = 2 * np.pi / 2**14


def motion() -> FloatArray:
    """Strokes, and a vibration of 5 to 60 Hz, a step large from top to bottom, in the last third."""
    swept = np.sin(2 * np.pi * (5 * TIME + 55 / (2 * SECONDS) * TIME**2))
    angle: FloatArray = 40 * np.sin(2 * np.pi * 0.4 * TIME) + 0.6 * STEP * swept * (TIME > 8.0)
    return angle


def acceleration(angle: FloatArray) -> FloatArray:
    """In the band, less what the steps cannot reach at the ends."""
    found = Band(EDGE, RATE).filter(np.gradient(np.gradient(angle, 1 / RATE), 1 / RATE))
    return found[1000:-1000]


def vibration_slope(given: FloatArray) -> float:
    """Slope of the true acceleration with the given one beyond the strokes: one where nothing is drawn to none."""
    high = [a - Band(3.0, RATE).filter(a) for a in (acceleration(motion()), acceleration(given))]
    return float(high[0] @ high[1] / (high[1] @ high[1]))


def test_expected_motion_draws_nothing_towards_none() -> None:
    measured = np.round(motion() / STEP) * STEP
    expected = smoothest_motion(measured, STEP)
    # the steps as they are take away a fifth of a mass and more; less than half of that is left
    assert vibration_slope(measured) < 0.8
    assert vibration_slope(expected) > 0.9


def test_error_of_the_acceleration_falls() -> None:
    measured = np.round(motion() / STEP) * STEP
    expected = smoothest_motion(measured, STEP)
    true = acceleration(motion())
    assert np.std(acceleration(expected) - true) < 0.5 * np.std(acceleration(measured) - true)


def test_drawn_error_is_of_the_size_of_what_is_left() -> None:
    true, left, drawn = acceleration(motion()), [], []
    for place in range(4):  # a stroke that turns on an edge of a step is told better than one between two
        at = motion() + STEP * place / 4
        expected = smoothest_motion(np.round(at / STEP) * STEP, STEP)
        left.append(np.mean((acceleration(expected) - true) ** 2))
        drawn.append(np.mean(acceleration(drawn_error(expected, STEP, place)) ** 2))
    # the four draws of either know their rms to a fifth; what lies below the steps is in neither
    assert np.sqrt(np.mean(drawn)) == pytest.approx(np.sqrt(np.mean(left)), rel=0.3)


def test_slow_motion_does_not_hold_the_lines_of_its_steps() -> None:
    """At 0.65 steps a row the third harmonic of the steps lies at 45 Hz, and is six times as strong as white steps."""
    step, rate = 2 * np.pi / 2**12, 1000.0
    angle = np.cumsum(np.where(TIME > 1.0, 0.652 * step, 0.0))
    moving = slice(4000, -1000)
    speed = [
        np.gradient(Band(EDGE, rate).filter(one), 1 / rate)[moving]
        for one in (angle, smoothest_motion(step * np.round(angle / step), step))
    ]
    assert np.std(speed[1]) < 0.01 * np.mean(speed[0])
    assert np.mean(speed[1]) == pytest.approx(np.mean(speed[0]), rel=1e-3)


def test_a_drive_that_hunts_about_the_edge_of_a_step_rests() -> None:
    """It writes jumps of a whole step, fourteen times a second, and hardly any of their acceleration is motion."""
    hunting = 0.02 * STEP * np.sin(2 * np.pi * 7.0 * TIME) + 0.5 * STEP
    measured = STEP * np.round(hunting / STEP)
    assert np.ptp(measured) == pytest.approx(STEP)
    found = smoothest_motion(measured, STEP)
    assert np.std(acceleration(found)) < 0.01 * np.std(acceleration(measured))


def test_no_motion_is_beyond_the_ends_of_its_steps_and_none_is_smoother() -> None:
    measured = STEP * np.round(motion() / STEP)
    found = smoothest_motion(measured, STEP)
    assert np.max(np.abs(found - measured)) <= 0.5 * STEP

    def rough(angle: FloatArray) -> float:
        return float(np.sum(np.diff(angle, 2) ** 2))

    assert rough(found) < rough(motion())  # which is one that the steps allow
    inwards = measured - found  # any way from there that stays within the ends makes it rougher
    bump = np.exp(-(((TIME[:, None] - np.linspace(1, SECONDS - 1, 9)) / 0.05) ** 2))
    for one in bump.T:
        assert rough(found + 0.01 * one * inwards) > rough(found) * (1 - 1e-6)


def test_fine_steps_leave_the_motion_alone() -> None:
    fine = STEP / 2**12
    measured = np.round(motion() / fine) * fine
    expected = smoothest_motion(measured, fine)
    assert np.max(np.abs(expected - measured)) < 5 * fine


def test_torque_of_unknown_scale_is_weighed_as_the_torque_itself() -> None:
    """What the encoder adds is a torque: beside a share of 30 N m it counts as a share."""
    unit = 30.0
    whole = read_recording(Path(__file__).parents[1] / "data" / "bench" / "backlash_train.csv.gz")
    plant = read_plant(find_plant("bench_axis"))
    rows, known = dict(whole.channels), prepare(whole, plant, 1.0)
    rows["motor_torque_share"] = rows.pop("motor_torque") / unit
    shared = prepare(replace(whole, channels=rows), plant, 1.0)
    assert set(shared.gains) == set(known.gains)
    # the declared plant lacks what was planted, which moves the scale that it sets by less than a hundredth
    assert unit * shared.known_to("motor_torque") == pytest.approx(known.known_to("motor_torque"), rel=0.01)
    for name, gains in known.gains.items():  # of powers, which go with the square of the scale
        np.testing.assert_allclose(shared.gains[name], gains, atol=0.02)
