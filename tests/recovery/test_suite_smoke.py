"""One case of the recovery suite for every effect, at the size that is worth half of the error: named, and error gone.

All of them run by `make recovery-smoke`, and those of `FAST` with the other tests. The whole suite is `make recovery`.
"""

from __future__ import annotations

from typing import Any

import pytest

from feeddrive.effects.catalogue import EFFECTS, THERMAL_EFFECTS
from tests.recovery.suite.cases import smoke_cases
from tests.recovery.suite.figures import ERROR
from tests.recovery.suite.one import run
from tests.recovery.suite.verdict import Verdict

CASES = {next(iter(case.planted)): case for case in smoke_cases()}

KNOWN_MISSES: dict[str, str] = {}
"""Effect to why it is not named at this size. A strict list: an effect that is named comes off it."""

FAST = (
    "friction_deviation",
    "torque_ripple",
    "lead_error_periodic",
    "presliding",
    "viscosity_temperature",
    "heat_sink",
)
"""A friction, a source at the motor, the screw's lead, a contact, a film and a sink of heat: some ten seconds each.
Free play, and nothing planted, are among the fast cases of `test_planted_effects`."""


def parameter(name: str) -> Any:
    """The effect as a parameter, expected to fail where the package has no such effect or it is a known miss."""
    why = KNOWN_MISSES.get(name, "" if name in EFFECTS or name in THERMAL_EFFECTS else "no effect of this name yet")
    marks = [pytest.mark.xfail(reason=why)] if why else []
    return pytest.param(name, marks=marks if name in FAST else [*marks, pytest.mark.slow])


@pytest.mark.parametrize("name", [parameter(name) for name in CASES])
def test_effect_worth_half_of_the_error_is_named_and_its_error_goes(name: str) -> None:
    verdict = Verdict(run(CASES[name], with_rivals=False))
    assert "raised" not in verdict.record, verdict.record["raised"]
    assert verdict.right_in_sets, f"{verdict.record['label']}: found {verdict.names or 'nothing'}"
    assert verdict.error is not None
    assert verdict.error <= ERROR
