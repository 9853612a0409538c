"""Two effects that look most like a third: the search meets the pair as one of the sets near the one at hand."""

from __future__ import annotations

import pytest

from tests.recovery.suite.cases import all_cases
from tests.recovery.suite.figures import ERROR
from tests.recovery.suite.one import run
from tests.recovery.suite.verdict import Verdict


@pytest.mark.slow
@pytest.mark.parametrize(
    "label",
    [
        "stribeck + friction_deviation service bench",  # Stribeck friction of a hundred times the velocity comes first
        "position_spring + coulomb_asymmetry 50% bench",  # an asymmetry with a growth that is over at once
        "motor_heat + cooling 50% warm-up",  # a drift of the surroundings with nine values
    ],
)
def test_pair_that_looks_like_a_third_effect(label: str) -> None:
    case = next(case for case in all_cases() if case.label == label)
    verdict = Verdict(run(case, with_rivals=False))
    assert verdict.right, f"found {verdict.names}"
    assert verdict.error is not None
    assert verdict.error <= ERROR
