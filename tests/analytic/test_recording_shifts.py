"""Shifts of one recording: what they move, what they leave alone, and how a change is said."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from feeddrive.diagnosis.recordings.change_result import Measure
from feeddrive.diagnosis.recordings.change_words import Moved, change_reading, change_statement
from feeddrive.diagnosis.recordings.recordings import (
    RecordingShift,
    in_recording,
    is_shift,
    shift_of,
    target_of,
    without_shifts,
)
from feeddrive.effects.base import Effect, Port
from feeddrive.effects.friction.friction_deviation import FrictionDeviation
from feeddrive.effects.source.torque_ripple import TorqueRipple
from feeddrive.effects.transmission.backlash import Backlash
from feeddrive.files import plants_folder
from feeddrive.plant.file.plant_file import read_plant
from feeddrive.plant.plant import Plant


@pytest.fixture(scope="module")
def plant() -> Plant:
    """The bench axis."""
    return read_plant(Path(plants_folder()) / "bench_axis.toml")


def shift(effect: Effect, coordinate: int, recording: int, *by: float) -> RecordingShift:
    """A shift with its values."""
    return shift_of(target_of(effect, coordinate), recording, len(by)).with_values(shift=by)


def test_a_shift_moves_its_parameter_in_its_recording_alone(plant: Plant) -> None:
    level = FrictionDeviation.of(Port.TABLE, coulomb_factor=1.1, viscous_factor=0.9)
    effects = (Backlash.of(width=5e-6), level, shift(level, 0, 0, -0.1))
    # coordinates of friction factors have size one, so that a shift is a difference of factors
    assert in_recording(effects, plant, 0)[1].values["coulomb_factor"] == pytest.approx(1.0)
    assert in_recording(effects, plant, 0)[1].values["viscous_factor"] == 0.9
    for other in (1, None):
        assert in_recording(effects, plant, other) == effects[:2]
    assert without_shifts(effects) == effects[:2]
    assert [is_shift(effect) for effect in effects] == [False, False, True]


def test_a_shift_finds_the_sine_of_its_order_and_the_port_of_its_level(plant: Plant) -> None:
    ripples = [TorqueRipple.of(amplitude=0.1, order=n, phase=0.0) for n in (3.0, 6.0)]
    table, screw = (FrictionDeviation.of(port) for port in (Port.TABLE, Port.SCREW))
    # a sine's coordinates are its two components over its size
    half = -0.5 * 0.1 / TorqueRipple.parameter("amplitude").size
    effects = (*ripples, table, screw, shift(ripples[0], 0, 1, half, 0.0), shift(screw, 0, 1, 0.2))
    first, second, guide, drag = in_recording(effects, plant, 1)
    assert first.values["amplitude"] == pytest.approx(0.05)
    assert (second, guide) == (ripples[1], table)
    assert drag.values["coulomb_factor"] == pytest.approx(1.2)


def test_a_shift_of_an_effect_that_is_gone_does_nothing(plant: Plant) -> None:
    assert in_recording((shift(Backlash.of(width=5e-6), 0, 0, 1.0),), plant, 0) == ()


def moved(key: str, difference: float, half: float = 0.01, effect: str = "friction_deviation") -> Moved:
    """A difference of a factor from one."""
    return Moved(
        effect, Port.TABLE, key, "1", Measure(1 + difference, half), Measure(1.0, half), Measure(difference, half)
    )


def test_level_is_said_in_per_cent() -> None:
    told = change_statement(moved("coulomb_factor", 0.12), "recording 2", "recording 1")
    assert told == "guide Coulomb level 12 % (± 1.0 %) higher in recording 2 than in recording 1"


@pytest.mark.parametrize(
    ("level", "viscous", "read"),
    [(0.1, 0.0, "wear"), (0.0, -0.1, "warmer"), (0.0, 0.1, "colder"), (-0.1, -0.1, "warmed up"), (0.1, -0.1, "shape")],
)
def test_friction_is_read_from_both_parts(level: float, viscous: float, read: str) -> None:
    parts = [moved("coulomb_factor", level), moved("viscous_factor", viscous)]
    assert read in change_reading(parts[0], parts).lower()


def test_play_and_length_are_read() -> None:
    play = Moved("backlash", Port.TRANSMISSION, "width", "m", *(Measure(value, 1e-7) for value in (9e-6, 4e-6, 5e-6)))
    assert "wear" in change_reading(play, [play])
    told = change_statement(play, "b", "a")
    assert told == "free play grew from 4 to 9 µm (± 0.1 µm): a, then b"
    none = replace(play, there=Measure(3e-10, 1e-9))
    assert change_statement(none, "b", "a").startswith("free play grew from 0 to 9 µm")
    growth = Moved(
        "lead_error_cumulative",
        Port.TRANSMISSION,
        "slope",
        "m/m",
        *(Measure(value, 1e-7) for value in (11.7e-6, 0.0, 11.7e-6)),
    )
    assert "1 K warmer" in change_reading(growth, [growth])
