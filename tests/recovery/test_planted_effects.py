"""Every planted effect is named, alone, with its size; where nothing is planted nothing is found.

The recordings are those of `tests/generator`, which shares no code with the package. With `-s` each case prints a row:
found and planted values, and the error left over that of the plant with what was planted.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

from feeddrive.diagnosis.judging.result import ChannelResult, Diagnosis
from tests.claims.book import CLAIMS
from tests.recovery.planted import TRUTH, null_errors, verdict

SMOKE = ("bench/null", "bench/torque_ripple", "light/stribeck")
"""Run in every suite: nothing, a source and a friction effect. The others are marked slow."""

CASES = [f"{axis}/{case}" for axis, cases in TRUTH.items() for case in cases]


def value(key: str, unit: float) -> Callable[[Diagnosis], float]:
    """A parameter of the first effect, in a unit."""
    return lambda result: float(result.effects[0].parameters[key].value) / unit


def channel(result: Diagnosis, name: str) -> ChannelResult:
    """One channel of the result."""
    return next(one for one in result.channels if one.name == name)


def over_noise(name: str) -> Callable[[Diagnosis], float]:
    """Error of a channel after, over the noise of its sensor."""
    return lambda result: channel(result, name).after.rms / channel(result, name).noise_rms


def before(name: str, unit: float) -> Callable[[Diagnosis], float]:
    """Error of a channel of the declared plant, in a unit."""
    return lambda result: channel(result, name).before.rms / unit


def after(name: str, unit: float) -> Callable[[Diagnosis], float]:
    """Error of a channel after, in a unit."""
    return lambda result: channel(result, name).after.rms / unit


MEASURED: dict[str, dict[str, Callable[[Diagnosis], float]]] = {
    "bench/null": {
        "known.null": lambda result: len(result.effects),
        "known.null.torque": over_noise("motor_torque"),
        "known.null.position": over_noise("table_position"),
    },
    "bench/backlash": {
        "known.backlash.width": value("width", 1e-6),
        "known.backlash.before": before("table_position", 1e-6),
        "known.backlash.after": after("table_position", 1e-9),
    },
    "bench/torque_ripple": {
        "known.ripple.amplitude": value("amplitude", 1.0),
        "known.ripple.order": value("order", 1.0),
        "known.ripple.before": before("motor_torque", 1.0),
        "known.ripple.after": after("motor_torque", 1.0),
    },
    "bench/presliding": {
        "known.presliding.stiffness": value("stiffness", 1e6),
        "known.presliding.before": before("table_position", 1e-9),
        "known.presliding.after": after("table_position", 1e-9),
    },
}
"""Claims of the README's table and what measures them, by case."""


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
    for key, measured in MEASURED.get(case, {}).items():
        CLAIMS[key].check(measured(judged.result))


@pytest.mark.parametrize("axis", list(TRUTH))
def test_declared_plant_leaves_the_sensor_noise_on_null(axis: str) -> None:
    """The prediction itself is near the noise, so that no ratio can hide a poor one."""
    for channel in null_errors(axis).values():
        # 1.25: the motor motion that goes in is quantised and differentiated, and adds to the noise of the channel.
        assert channel.after.rms <= 1.25 * channel.noise_rms, channel.name
