"""Every planted effect is named, alone, with its size; where nothing is planted nothing is found.

The recordings are those of `tests/generator`, which shares no code with the package. With `-s` each case prints a row:
found and planted values, and the error left over that of the plant with what was planted.
"""

from __future__ import annotations

from typing import Any

import pytest

from tests.recovery.planted import TRUTH, null_errors, verdict

SMOKE = ("bench/null", "bench/torque_ripple", "bench/backlash", "light/stribeck")
"""Run in every suite: nothing, a source, a transmission and a friction effect. The others are marked slow."""

CASES = [f"{axis}/{case}" for axis, cases in TRUTH.items() for case in cases]


def marked(case: str) -> Any:
    """The case as a parameter, slow where it is not in the smoke set."""
    return pytest.param(case, marks=() if case in SMOKE else pytest.mark.slow)


def test_smoke_cases_exist() -> None:
    assert set(SMOKE) <= set(CASES)


@pytest.mark.parametrize("case", [marked(case) for case in CASES])
def test_what_was_planted_is_found_and_nothing_else(case: str) -> None:
    axis, name = case.split("/")
    judged = verdict(axis, name)
    print(f"\n{judged.line(case)}")
    assert judged.misses == []


@pytest.mark.parametrize("axis", list(TRUTH))
def test_declared_plant_leaves_the_sensor_noise_on_null(axis: str) -> None:
    """The prediction itself is near the noise, so that no ratio can hide a poor one."""
    for channel in null_errors(axis).values():
        # 1.25: the motor motion that goes in is quantised and differentiated, and adds to the noise of the channel.
        assert channel.after.rms <= 1.25 * channel.noise_rms, channel.name
