"""Recordings from 10 Hz to 20 kHz: what a slow one still shows and what it says it cannot; fast ones show the same."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path

import pytest

from feeddrive.diagnosis.diagnose import diagnose
from feeddrive.diagnosis.judging.result import Diagnosis
from feeddrive.errors import InputError
from feeddrive.recording import Recording
from tests.claims.book import CLAIMS
from tests.generator.axis import AXES
from tests.generator.effects import ChannelDelay, Effect, FrictionDeviation, PlantedEffects
from tests.generator.pair import Channels, recording_pair
from tests.generator.profile import train_profile, validate_profile
from tests.generator.recording import QUICK_STEP, simulate
from tests.recovery.declared_controller import controlled_plant
from tests.recovery.planted import axis_plant

PLANT = axis_plant("light")
STRONGER = FrictionDeviation(port="table", coulomb_factor=1.25, viscous_factor=0.8)


@cache
def strokes(effect: Effect | None, seconds: tuple[float, float]) -> tuple[Channels, Channels]:
    """Long strokes and slow swings without a torque chirp, at 2 kHz."""
    axis, planted = AXES["light"], PlantedEffects((effect,) if effect else ())
    profiles = train_profile(axis, seconds[0]), validate_profile(axis, seconds[1])
    return tuple(  # type: ignore[return-value]
        simulate(axis, planted, profile.without_chirp(), seed, QUICK_STEP)
        for profile, seed in zip(profiles, (81, 82), strict=True)
    )


def every(count: int, pair: tuple[Channels, Channels]) -> list[Recording]:
    """Every so many rows of a pair."""
    made = []
    for name, rows in zip(("fitted", "judged"), pair, strict=True):
        kept = {key: value[::count] for key, value in rows.items()}
        time = kept.pop("time")
        made.append(Recording(name, time, kept, float(time[-1] - time[0]) / (len(time) - 1)))
    return made


def diagnosed(pair: list[Recording]) -> Diagnosis:
    """The diagnosis of one to fit and one to judge."""
    return diagnose(PLANT, pair[:1], pair[1:])[0]


def names(result: Diagnosis) -> list[str]:
    """Effects in the order found."""
    return [effect.name for effect in result.effects]


def assert_friction_is_found(result: Diagnosis, tolerance: float) -> None:
    """The planted friction alone, its factors met."""
    assert names(result) == ["friction_deviation"]
    found = result.effects[0].parameters
    assert found["coulomb_factor"].value == pytest.approx(1.25, rel=tolerance)
    assert found["viscous_factor"].value == pytest.approx(0.8, rel=tolerance)


@pytest.mark.parametrize("effect", [None, pytest.param(STRONGER, marks=pytest.mark.slow)])
def test_strokes_at_100_hertz(effect: Effect | None) -> None:
    result = diagnosed(every(20, strokes(effect, (40.0, 30.0))))
    if effect:
        assert_friction_is_found(result, 0.02)  # 12 mN m of noise against 0.1 N m of friction, in 300 values
    else:
        assert names(result) == []
    said = [note for note in result.notes if "rows are 10 ms apart" in note]
    assert len(said) == 2
    # noise, and what an acceleration leaves that is just not seen between the rows
    assert all(channel.after.rms < 1.6 * channel.noise_rms for channel in result.channels)


def test_vibration_between_the_rows_is_no_effect() -> None:
    pair = recording_pair(AXES["light"], (), (83, 84), (40.0, 30.0))  # with a chirp from 5 Hz to 450 Hz
    result = diagnosed(every(20, pair))
    assert names(result) == []
    assert all(channel.after.rms < 1.6 * channel.noise_rms for channel in result.channels)


def test_motion_that_is_unknown_between_the_rows_is_refused() -> None:
    pair = recording_pair(AXES["light"], (), (83, 84), (14.0, 12.0))  # 140 rows, most of them between strokes
    with pytest.raises(InputError, match="the motion between rows 100 ms apart is known at"):
        diagnosed(every(200, pair))


@pytest.mark.parametrize("cycles", [2, 3])
def test_torque_of_a_faster_loop_is_no_delay(cycles: int) -> None:
    pair = every(cycles, recording_pair(AXES["light"], (), (87, 88), (6.8, 6.0)))
    result = diagnosed(pair)
    assert names(result) == []
    logged = f"logged every {0.5 * cycles:.3g} ms, and comes as from a drive that holds it for 0.5 ms"
    assert any(logged in note for note in result.notes)  # the generator's loop runs at 2 kHz


LATE = 0.7e-3


def late_pair() -> list[Recording]:
    """A loop of 2 kHz whose torque is recorded 0.7 ms late, every second cycle written."""
    late = ChannelDelay(channel="motor_torque", delay=LATE)
    return every(2, recording_pair(AXES["light"], (late,), (89, 90), (6.8, 6.0)))


def test_late_torque_of_a_loop_is_a_delay(tmp_path: Path) -> None:
    pair = late_pair()
    result = diagnose(controlled_plant(tmp_path, "light"), pair[:1], pair[1:])[0]
    assert names(result) == ["channel_delay"]
    CLAIMS["diagnosis.recorder"].check(1e3 * result.effects[0].parameters["delay"].value)
    assert any("the declared controller holds it for 0.5 ms" in note for note in result.notes)


def test_share_of_a_recorder_whose_loop_is_unknown_is_said() -> None:
    result = diagnosed(late_pair())
    assert names(result) == ["channel_delay"]
    found = result.effects[0].parameters["delay"].value
    # Rows of 1 ms tell the delay but for the half row at most that a recorder may add: here a quarter of one.
    assert found - 0.5e-3 < LATE < found
    (said,) = [note for note in result.notes if "own is" in note]
    assert f"{1e3 * found - 0.5:.3g} to {1e3 * found:.3g} ms" in said and "velocity_rate" in said


@pytest.mark.slow
@pytest.mark.parametrize("effect", [None, STRONGER])
def test_strokes_at_10_hertz(effect: Effect | None) -> None:
    result = diagnosed(every(200, strokes(effect, (90.0, 60.0))))
    if effect:
        assert_friction_is_found(result, 0.03)  # as at 100 Hz, of 100 values
    else:
        assert names(result) == []


@pytest.mark.slow
@pytest.mark.parametrize("effect", [None, STRONGER])
def test_20_kilohertz(effect: Effect | None) -> None:
    axis = replace(AXES["light"], sample_time=5e-5)
    pair = recording_pair(axis, (effect,) if effect else (), (85, 86), (6.8, 6.0))
    result = diagnosed(every(1, pair))
    if effect:
        assert_friction_is_found(result, 0.005)
    else:
        assert names(result) == []
    for channel in result.channels:
        assert channel.after.rms == pytest.approx(channel.noise_rms, rel=0.3)  # the noise is read off, not known
