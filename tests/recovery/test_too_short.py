"""A recording that cannot show an effect: the effect is refused by name, with what the recording lacks."""

from __future__ import annotations

import pytest

from feeddrive.diagnosis.diagnose import diagnose
from feeddrive.diagnosis.finding.search import search
from feeddrive.diagnosis.judging.result import Diagnosis
from feeddrive.diagnosis.preparation import prepared
from feeddrive.effects.base import number
from feeddrive.errors import InputError
from feeddrive.recording import Recording
from tests.generator import BENCH
from tests.generator.effects import Effect as Planted
from tests.generator.effects import FrictionVsPosition, PlantedEffects
from tests.generator.profile import Profile
from tests.generator.recording import simulate
from tests.recovery.planted import axis_plant, pair

NEEDS_REVERSALS = ("backlash", "presliding", "coulomb_asymmetry", "viscous_asymmetry")
SHOWN_ONE_WAY = ("stribeck", "friction_vs_position", "load_dependent_friction")
NEEDS_TURNS = ("torque_ripple", "lead_error_periodic")

ONE_WAY = ((0.25, 0.06),)
"""A stroke in one direction, 12 revolutions in some 4 s: distance [m] and speed [m/s]."""

MOVING = (0.02, 4.15)
"""From its beginning to where it stops; a servo that stops turns back by an encoder step or two [s]."""

WITHIN_A_TURN = ((0.012, 0.02), (-0.012, 0.02)) * 4
"""Strokes to and fro over 0.6 revolutions: distance [m] and speed [m/s]."""


def one_way(*effects: Planted) -> Recording:
    """A stroke without reversal, recorded."""
    return recorded("one_way", ONE_WAY, *effects).between(*MOVING)


def recorded(name: str, strokes: tuple[tuple[float, float], ...], *effects: Planted) -> Recording:
    """Strokes alone."""
    profile = Profile(0.05, strokes, (), 0.0, 1.0, 0.6, 0.0, 2.0)
    channels = simulate(BENCH, PlantedEffects(effects), profile, 11)
    return Recording(name, channels.pop("time"), channels, BENCH.sample_time)


def diagnosed(fitted: Recording) -> Diagnosis:
    """The null case with another recording to fit."""
    result, _ = diagnose(axis_plant("bench"), [fitted], [pair("bench", "null")[1]])
    return result


def reasons(result: Diagnosis) -> dict[str, str]:
    """Refused name to reason; nothing that was found may be among them."""
    refused = {refused.name: refused.reason for refused in result.refused}
    assert not refused.keys() & {effect.name for effect in result.effects}
    return refused


def test_one_way_shows_no_effect_of_reversal_or_direction() -> None:
    refused = reasons(diagnosed(one_way()))
    for name in NEEDS_REVERSALS:
        assert "the recording has 0 reversals; it needs two or more" in refused[name]
    for name in SHOWN_ONE_WAY:  # asked, and not there
        assert "data not fitted" in refused[name] or "could not be fitted" in refused[name]
    assert "revolutions" not in refused.get("torque_ripple", "")  # there are enough of them for a ripple


def test_a_tight_place_is_found_in_one_direction() -> None:
    plant, bump = axis_plant("bench"), FrictionVsPosition(peak=20.0, centre=0.18, half_width=0.03)
    found = search(prepared(plant, [one_way(bump)], [], 1.0)[0]).fit.effects
    assert [effect.name for effect in found] == ["friction_vs_position"]
    assert number(found[0].values["centre"]) == pytest.approx(bump.centre, abs=0.005)


def test_less_than_a_turn_shows_no_periodic_effect() -> None:
    refused = reasons(diagnosed(recorded("short", WITHIN_A_TURN)))
    for name in NEEDS_TURNS:
        assert "revolutions; it needs 1" in refused[name]


def test_shorter_than_the_cut_ends_is_refused_as_input() -> None:
    fitted, judged = pair("bench", "null")
    with pytest.raises(InputError, match="lasts 2 s, too short to compare"):
        diagnose(axis_plant("bench"), [fitted.between(0.0, 2.0)], [judged])
