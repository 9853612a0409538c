"""A fit that takes far less than its first step promised, and one that takes what is left to take."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, cast

import numpy as np
import pytest

from feeddrive.diagnosis.finding.attempt import Attempt
from feeddrive.diagnosis.finding.short_step import _fell_short
from feeddrive.diagnosis.likelihood.cross_validation import Comparison
from feeddrive.diagnosis.likelihood.fit import Fit
from feeddrive.diagnosis.likelihood.problem import Problem


class _Recordings:
    """A problem as far as its samples: none."""

    evidence: tuple[()] = ()


def _fit(square: float) -> Fit:
    return Fit((), np.array([np.sqrt(square)]), np.zeros((1, 0)), np.zeros(0))


@pytest.mark.parametrize(
    ("left", "promised", "most", "expected"),
    [
        (80.0, 50.0, 0.0, True),  # 20 of the 50 that were promised
        (70.0, 50.0, 0.0, False),  # 30 of them
        (80.0, 0.0, 0.0, False),  # never fitted
        (99.0, 5.0, 60.0, False),  # another takes 60: five more are not what is missing
        (99.0, 30.0, 60.0, True),
    ],
)
def test_a_fit_falls_short_of_its_first_step(left: float, promised: float, most: float, expected: bool) -> None:
    problem = cast(Problem, cast(Any, _Recordings()))
    none = Comparison(0.0, 1.0, 0.005)
    attempt = replace(Attempt("payload", _fit(left), none, problem, none), promised=promised)
    assert _fell_short(problem, _fit(100.0), attempt, most) is expected
