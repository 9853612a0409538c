"""Rests of the load on a flank of a play: where a recording tells them, and what a simulation makes of them."""

from __future__ import annotations

import numpy as np
import pytest

from feeddrive.diagnosis.motion.band import comparison_band
from feeddrive.diagnosis.motion.flank_rests import _sides, flank_rests
from feeddrive.effects.transmission.backlash import Backlash
from feeddrive.files import find_plant
from feeddrive.plant.analysis.modes import held_modes
from feeddrive.plant.analysis.steady import steady_motion
from feeddrive.plant.file.plant_file import read_plant
from feeddrive.recording import Recording
from feeddrive.simulate.driven import FlankRests, _rests_there, motor_motion, simulate_driven
from feeddrive.typing import FloatArray

PLANT = read_plant(find_plant("bench_axis"))
RADIUS = PLANT.chain.motor_radius
STEP, SPEED, STROKE = 1e-3, 0.1, 1.0
TIME: FloatArray = STEP * np.arange(8000, dtype=np.float64)
PLAY = 0.2e-3
NOISE = 0.2e-6


def strokes() -> FloatArray:
    """Motor angle of strokes of one second to and fro, turned about within 50 ms."""
    rate = SPEED / RADIUS * np.tanh(np.sin(np.pi * TIME / STROKE) / 0.05)
    return np.asarray(np.cumsum(rate) * STEP, dtype=np.float64)


def recorded(play: float, bounce: float, lead_error: float = 3e-6) -> Recording:
    """Strokes with a table that lags half a play, and bounces for 0.3 s behind each turn."""
    angle = strokes()
    side, since = np.sign(np.sin(np.pi * TIME / STROKE)), TIME % STROKE
    bounces = bounce * np.abs(np.sin(2 * np.pi * 40 * since)) * (since < 0.3)
    table = RADIUS * angle - side * (0.5 * play - bounces) + lead_error * np.sin(angle)
    table = table + NOISE * np.random.default_rng(3).standard_normal(len(TIME))
    return Recording("strokes", TIME, {"motor_angle": angle, "table_position": table}, STEP)


def test_rests_are_told_behind_the_bounces_and_not_before_the_contact_has_forgotten() -> None:
    told = flank_rests(recorded(PLAY, 20e-6), PLANT, comparison_band(PLANT, 1 / STEP))
    assert told is not None
    rests, bouncing = told
    slowest = min((pole for pole in held_modes(PLANT, PLANT.middle).poles if pole.imag > 0), key=lambda p: p.imag)
    forgotten = -1 / slowest.real
    since = TIME[rests.samples] % STROKE
    assert np.array_equal(rests.sides, [1, -1] * 4)  # one a stroke, pushed the way it goes
    assert (since > 0.3 + forgotten).all() and (since < 0.3 + forgotten + 0.05).all()
    turned = TIME % STROKE
    assert bouncing[(turned > 0.02) & (turned < 0.3)].all()
    assert not bouncing[(turned > forgotten + 0.4) & (turned < 0.95)].any()


def test_slow_travel_errors_hide_no_flank() -> None:
    """A screw that is too long by half of the play over the stroke, and bent by a quarter: class 7 of ISO 3408-3."""
    plain = recorded(PLAY, 20e-6)
    place = plain["table_position"] / np.ptp(plain["table_position"])
    table = plain["table_position"] + 0.5 * PLAY * place + 0.25 * PLAY * place**2
    bent = Recording("strokes", TIME, {"motor_angle": plain["motor_angle"], "table_position": table}, STEP)
    told, without = (flank_rests(one, PLANT, comparison_band(PLANT, 1 / STEP)) for one in (bent, plain))
    assert told is not None and without is not None
    assert np.array_equal(told[0].sides, without[0].sides)
    assert np.max(np.abs(told[0].samples - without[0].samples)) * STEP < 0.05


def test_where_the_load_is_says_which_flank_it_rides_on() -> None:
    """A load that is driven hard stretches away from the other flank; in the middle it rides on neither."""
    flanks = {1.0: -4.6e-6, -1.0: 4.5e-6}  # of a play of 7.5 µm on the bench
    places = np.array([-4.6e-6, -7.2e-6, 4.0e-6, 7.1e-6, -0.5e-6, 2.0e-6])
    assert _sides(places, flanks).tolist() == [1, 1, -1, -1, 0, 0]
    assert not _sides(places, {1.0: 1e-6, -1.0: -1e-6}).any()  # flanks the wrong way round are none


@pytest.mark.parametrize("play", [0.0, 5e-6])
def test_of_a_play_as_small_as_the_travel_errors_nothing_is_told(play: float) -> None:
    assert flank_rests(recorded(play, 0.25 * play), PLANT, comparison_band(PLANT, 1 / STEP)) is None


def test_a_load_begun_anew_rides_on_its_flank_as_in_steady_motion() -> None:
    plant = PLANT.with_effects(Backlash.of(width=PLAY))
    motion = motor_motion(TIME[:2000], strokes()[:2000])
    rests = FlankRests(np.array([600, 1600]), np.array([1.0, -1.0]))
    free, anew = simulate_driven(plant, motion), simulate_driven(plant, motion, rests=rests)
    behind = anew.table_position - RADIUS * anew.motor_angle
    for sample, side in ((600, 1), (1600, -1)):
        speed = RADIUS * anew.motor_speed[sample]
        state = steady_motion(plant, float(speed), 0.1).state
        lag = RADIUS * state[0] - state[len(plant.chain.coordinates) - 1]
        assert side * lag > 0.5 * PLAY
        # what the motor still accelerates by, and what it then moves the load on its spring, is far below a nanometre
        assert behind[sample : sample + 300] == pytest.approx(-lag, abs=2e-9)
    assert np.array_equal(anew.table_position[:600], free.table_position[:600])


def shaken() -> FloatArray:
    """Motor angle of strokes, shaken at 60 Hz by less than what lifts the load off its flank."""
    return np.asarray(strokes() + 2e-6 / RADIUS * np.sin(2 * np.pi * 60 * TIME), dtype=np.float64)


@pytest.mark.parametrize(("ringing", "goes_on"), [(0.4e-6, True), (0.1e-6, False)])
def test_a_load_that_is_as_quiet_as_the_rests_goes_on_with_what_shakes_it(ringing: float, goes_on: bool) -> None:
    """On its spring it is shaken by 0.2 µm rms against the motor; begun anew it would be where it rides without."""
    plant = PLANT.with_effects(Backlash.of(width=PLAY))
    motion = motor_motion(TIME[:2000], shaken()[:2000])
    rests = FlankRests(np.array([1600]), np.array([-1.0]), 100, 17, ringing)
    free, told = (simulate_driven(plant, motion, rests=each).table_position for each in (None, rests))
    assert np.array_equal(free, told) == goes_on


def test_a_load_on_the_other_flank_does_not_rest_there_however_quiet_it_is() -> None:
    rests = FlankRests(np.array([1600]), np.array([1.0]), 100, 17, 1e-6)
    behind, force = np.full(400, -0.1e-3), np.full(400, 90.0)
    assert _rests_there(behind, force, 0.1e-3, rests)
    assert not _rests_there(behind, -force, 0.1e-3, rests)
    assert not _rests_there(behind + 2e-6 * np.sin(np.arange(400)), force, 0.1e-3, rests)


def test_a_plant_without_play_goes_on() -> None:
    motion = motor_motion(TIME[:2000], strokes()[:2000])
    rests = FlankRests(np.array([600]), np.array([1.0]))
    one, other = (simulate_driven(PLANT, motion, rests=each) for each in (None, rests))
    assert np.array_equal(one.table_position, other.table_position)
