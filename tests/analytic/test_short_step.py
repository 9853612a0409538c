"""A fit that takes far less than its first step promised, and one that takes what is left to take."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from feeddrive.diagnosis.finding.attempt import Attempt
from feeddrive.diagnosis.finding.likelier import Taken
from feeddrive.diagnosis.finding.round import Round
from feeddrive.diagnosis.finding.short_step import _fell_short, _least_promise
from feeddrive.diagnosis.likelihood.cross_validation import Comparison
from feeddrive.diagnosis.likelihood.fit import Fit
from feeddrive.diagnosis.likelihood.problem import Problem


class _Recordings:
    """A problem as far as its samples: none."""

    evidence: tuple[()] = ()


def _fit(square: float) -> Fit:
    return Fit((), np.array([np.sqrt(square)]), np.zeros((1, 0)), np.zeros(0))


@pytest.mark.parametrize(
    ("left", "promised", "least", "expected"),
    [
        (80.0, 50.0, 0.0, True),  # 20 of the 50 that were promised
        (70.0, 50.0, 0.0, False),  # 30 of them
        (80.0, 0.0, 0.0, False),  # never fitted
        (99.0, 5.0, 18.0, False),
        (99.0, 30.0, 18.0, True),
    ],
)
def test_a_fit_falls_short_of_its_first_step(left: float, promised: float, least: float, expected: bool) -> None:
    problem = cast(Problem, cast(Any, _Recordings()))
    none = Comparison(0.0, 1.0, 0.005)
    attempt = replace(Attempt("payload", _fit(left), none, problem, none), promised=promised)
    assert _fell_short(problem, _fit(100.0), attempt, least) is expected


@pytest.mark.parametrize(
    ("after", "odds", "least"),
    [
        (40.0, 1.0, 18.0),  # 0.3 of the 60 that the likeliest set takes
        (94.0, 6.0, 36.0),  # two variances a nat: as likely a set
        (None, 0.0, 6.0 * np.log(99)),  # what a first name costs among fifty: p(S) of none over that of one, 2 K - 1
    ],
)
def test_a_first_step_is_asked_that_promises_the_likeliest_set(after: float | None, odds: float, least: float) -> None:
    problem = cast(Problem, SimpleNamespace(calibration=SimpleNamespace(variance=3.0)))
    taken = None if after is None else Taken(problem, _fit(after), "payload", odds)
    assert _least_promise(problem, _fit(100.0), Round((), 50), taken) == pytest.approx(least)
