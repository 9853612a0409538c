"""A recording that cannot show an effect: the effect is refused by name, with what the recording lacks."""

from __future__ import annotations

from dataclasses import replace

import pytest

from feeddrive.diagnosis.diagnose import diagnose
from feeddrive.diagnosis.result import Diagnosis
from feeddrive.errors import InputError
from feeddrive.recording import Recording
from tests.recovery.planted import axis_plant, pair

NEEDS_BOTH_DIRECTIONS = ("presliding", "coulomb_asymmetry", "viscous_asymmetry", "stribeck", "friction_vs_position")
NEEDS_TURNS = ("torque_ripple", "lead_error_periodic")

ONE_WAY = (1.45, 3.35)
"""The longest stroke in one direction, 14 revolutions [s]."""

SLOWER = 1.8
"""Its clock runs this much slower, so that it lasts longer than the 3 s that any recording needs. The torque then
does not belong to the motion; only what is refused is looked at."""

WITHIN_TWO_TURNS = (7.2, 10.6)
"""Slow motion to and fro over 1.3 revolutions [s]."""


def one_way() -> Recording:
    """A stroke without reversal."""
    part = pair("bench", "null")[0].between(*ONE_WAY)
    return replace(part, time=SLOWER * part.time, sample_time=SLOWER * part.sample_time)


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
    assert "the recording has 0 reversals; it needs two or more" in refused["backlash"]
    for name in NEEDS_BOTH_DIRECTIONS:
        assert "forward and" in refused[name]
        assert "it needs both" in refused[name]
    assert "revolutions" not in refused.get("torque_ripple", "")  # there are enough of them for a ripple


def test_less_than_two_turns_shows_no_periodic_effect() -> None:
    refused = reasons(diagnosed(pair("bench", "null")[0].between(*WITHIN_TWO_TURNS)))
    for name in NEEDS_TURNS:
        assert "revolutions; it needs 2" in refused[name]


def test_shorter_than_the_cut_ends_is_refused_as_input() -> None:
    fitted, judged = pair("bench", "null")
    with pytest.raises(InputError, match="lasts 2 s, too short to compare"):
        diagnose(axis_plant("bench"), [fitted.between(0.0, 2.0)], [judged])
