"""The motion that is expected given steps of an encoder: it draws nothing towards none, and its error is as drawn."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from feeddrive.diagnosis.motion import expected_motion as expecting
from feeddrive.diagnosis.motion.band import Band
from feeddrive.diagnosis.motion.encoder_error import drawn_error
from feeddrive.diagnosis.motion.expected_motion import expected_motion
from feeddrive.diagnosis.motion.preparing import prepare
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
    expected = expected_motion(measured, STEP, 1 / RATE).angle
    # the steps as they are take away a fifth of a mass and more; less than half of that is left
    assert vibration_slope(measured) < 0.8
    assert vibration_slope(expected) > 0.9


def test_error_of_the_acceleration_falls() -> None:
    measured = np.round(motion() / STEP) * STEP
    expected = expected_motion(measured, STEP, 1 / RATE).angle
    true = acceleration(motion())
    assert np.std(acceleration(expected) - true) < 0.5 * np.std(acceleration(measured) - true)


def test_drawn_error_is_of_the_size_of_what_is_left() -> None:
    true, left, drawn = acceleration(motion()), [], []
    for place in range(4):  # a stroke that turns on an edge of a step is told better than one between two
        at = motion() + STEP * place / 4
        expected = expected_motion(np.round(at / STEP) * STEP, STEP, 1 / RATE)
        left.append(np.mean((acceleration(expected.angle) - true) ** 2))
        drawn.append(np.mean(acceleration(drawn_error(expected, place)) ** 2))
    # what is drawn from holds an error already, so that a draw has more
    assert np.sqrt(np.mean(left)) < np.sqrt(np.mean(drawn)) < 2 * np.sqrt(np.mean(left))


def test_error_of_a_motion_below_the_steps_is_drawn_as_large_as_it_is() -> None:
    """A fifth of the steps' power from 100 to 300 Hz: most is lost in what is expected, and what has lost it before
    would lose no more. Of that motion alone draws have half of the error."""
    rate = 8000.0
    time = np.arange(int(6 * rate)) / rate
    hertz = np.fft.rfftfreq(len(time), 1 / rate)
    inside = (hertz > 100) & (hertz < 300)
    noise = np.random.default_rng(4).standard_normal(len(time))
    noise = np.fft.irfft(np.where(inside, np.fft.rfft(noise), 0), len(time))
    angle = 40 * np.sin(2 * np.pi * 0.4 * time) + 0.03 * STEP * noise / np.std(noise)
    expected = expected_motion(STEP * np.round(angle / STEP), STEP, 1 / rate)

    def power(error: FloatArray) -> float:
        return float(np.sum(np.abs(np.fft.rfft(np.diff(error, 2), len(time)))[inside] ** 2))

    drawn = np.mean([power(drawn_error(expected, draw)) for draw in range(4)])
    # what is pooled where no motion is told is there more or less: a fifth of a level, and as much of four draws
    assert 0.7 < drawn / power(expected.angle - angle) < 1.4


def test_nothing_is_drawn_at_rest() -> None:
    """An axis that stands passes no step: a likely motion stands as well, and no friction turns with it."""
    angle = np.where(TIME < 6.0, 40 * np.sin(2 * np.pi * 0.4 * TIME), 40 * np.sin(2 * np.pi * 0.4 * 6.0))
    expected = expected_motion(STEP * np.round(angle / STEP), STEP, 1 / RATE)
    assert np.ptp((expected.likely(1) - expected.angle)[TIME > 6.5]) == 0.0
    assert np.ptp((expected.likely(1) - expected.angle)[TIME < 5.5]) > 0.0


def test_slow_motion_does_not_hold_the_lines_of_its_steps() -> None:
    """At 0.65 steps a row the third harmonic of the steps lies at 45 Hz, and is six times as strong as white steps."""
    step, rate = 2 * np.pi / 2**12, 1000.0
    angle = np.cumsum(np.where(TIME > 1.0, 0.652 * step, 0.0))
    moving = slice(4000, -1000)
    speed = [
        np.gradient(Band(EDGE, rate).filter(one), 1 / rate)[moving]
        for one in (angle, expected_motion(step * np.round(angle / step), step, 1 / rate).angle)
    ]
    assert np.std(speed[1]) < 0.01 * np.mean(speed[0])
    assert np.mean(speed[1]) == pytest.approx(np.mean(speed[0]), rel=1e-3)


def test_steps_of_fast_motion_are_white(monkeypatch: pytest.MonkeyPatch) -> None:
    """At 500 steps a row, unevenly, what a draw shows beyond white steps is of that draw alone, and none is taken.

    Taken in every window it moves the acceleration by a seventh of its error; the turns hold a few even windows.
    """
    step = STEP / 4
    angle = 40 * np.sin(2 * np.pi * 0.4 * TIME)
    measured = np.round(angle / step) * step
    found = acceleration(expected_motion(measured, step, 1 / RATE).angle)
    monkeypatch.setattr(expecting, "EVEN", np.inf)
    white = acceleration(expected_motion(measured, step, 1 / RATE).angle)
    assert np.std(found - white) < 0.01 * np.std(white - acceleration(angle))


def test_fine_steps_leave_the_motion_alone() -> None:
    fine = STEP / 2**12
    measured = np.round(motion() / fine) * fine
    expected = expected_motion(measured, fine, 1 / RATE).angle
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


@pytest.mark.parametrize("below", [0.05, -0.05, 0.1])
def test_angle_that_a_drive_holds_at_an_edge_of_two_steps_is_at_the_edge(below: float) -> None:
    """Held within a tenth of a step, and trembling by as much from row to row; then a rest inside a step, and strokes.

    The mean of what is measured is off by the share of rows beyond the edge; the edge is off by `below`.
    """
    held, strokes = TIME < 4.0, TIME > 8.0
    trembling = 0.1 * STEP * np.random.default_rng(5).normal(size=len(TIME))
    path = 40 * (1 - np.cos(2 * np.pi * 0.4 * (TIME - 8.0))) * strokes
    true = np.where(held, (0.5 - below) * STEP + trembling, 0.3 * STEP) + path
    measured = np.round(true / STEP) * STEP
    expected = expected_motion(measured, STEP, 1 / RATE).angle
    missed = float(np.mean((expected - true)[(TIME > 0.2) & (TIME < 3.8)])) / STEP
    mean = float(np.mean((measured - true)[(TIME > 0.2) & (TIME < 3.8)])) / STEP
    # the edge lies within 0.1; three samples in four on one side of it leave their mean twice as far off and more
    assert abs(missed) < abs(below) + 0.02 < 0.6 * abs(mean)
    inside = (TIME > 4.5) & (TIME < 7.5)
    assert np.max(np.abs(expected - measured)[inside]) < 0.02 * STEP
