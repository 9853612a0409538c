"""The motion that is expected given steps of an encoder: it draws nothing towards none, and its error is as drawn."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from feeddrive.diagnosis.likelihood.band import Band
from feeddrive.diagnosis.likelihood.encoder_error import drawn_error, expected_motion
from feeddrive.diagnosis.likelihood.evidence import prepare
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
    expected = expected_motion(measured, STEP, 1 / RATE)
    # the steps as they are take away a fifth of a mass and more; less than half of that is left
    assert vibration_slope(measured) < 0.8
    assert vibration_slope(expected) > 0.9


def test_error_of_the_acceleration_falls() -> None:
    measured = np.round(motion() / STEP) * STEP
    expected = expected_motion(measured, STEP, 1 / RATE)
    true = acceleration(motion())
    assert np.std(acceleration(expected) - true) < 0.5 * np.std(acceleration(measured) - true)


def test_drawn_error_is_of_the_size_of_what_is_left() -> None:
    measured = np.round(motion() / STEP) * STEP
    expected = expected_motion(measured, STEP, 1 / RATE)
    left = drawn_error(expected, STEP, 1 / RATE, 0)
    true = acceleration(motion())
    # what is lost of the vibration below the steps is no part of the draw
    assert np.std(acceleration(left)) == pytest.approx(np.std(acceleration(expected) - true), rel=0.4)


def test_fine_steps_leave_the_motion_alone() -> None:
    fine = STEP / 2**12
    measured = np.round(motion() / fine) * fine
    expected = expected_motion(measured, fine, 1 / RATE)
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
    for name, gains in known.gains.items():
        np.testing.assert_allclose(shared.gains[name], gains, atol=0.01)
