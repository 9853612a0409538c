"""Is a measured number wrong? One that contradicts recordings and declared values, against all that would explain it.

    holds:  p(y, n | S1) with the number as a row of the likelihood, beside the set S1 that was found with it
    wrong:  p(y | S0) q(n) beside the set S0 that is found without it,   q: log n ~ N(log f, w²)

| symbol | meaning | unit |
|---|---|---|
| y | rows of the recordings and of the other numbers over their noise | 1 |
| n, f | the number, and what the plant with S0 gives for it | SI |
| w | of a value beyond its tolerance (`likelihood.tolerances.BEYOND`): another machine, or a slip of a unit | 1 |

Both are Laplace approximations with the declared values taken out (`set_evidence`, `calibration`), on the same rows
with the same λ. A wrong number costs what one more effect does: it is one of the K candidates and the numbers. Only a
number is asked that all else contradicts: its residual when it is left out, over the deviation that it then has,

    z = (P r)_j / (λ P_jj)^1/2,   P = W' (1 - J J⁺) W

with W, J, r as in `calibration`, `fit`. Source: Cook and Weisberg, Residuals and Influence in Regression (1982), 2.2.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import TypeVar

import numpy as np

from feeddrive.diagnosis.finding.search import Search
from feeddrive.diagnosis.likelihood.fit import fit, linear_step
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.likelihood.set_evidence import log_prior_of_size, log_volume
from feeddrive.diagnosis.likelihood.tolerances import BEYOND, SURE
from feeddrive.diagnosis.numbers.measured_file import MeasuredNumber
from feeddrive.units.quantity import format_quantity


def most_doubtful(found: Search) -> int | None:
    """The number that all else contradicts most, by its place; None where none is contradicted.

    Args:
        found: with the numbers among its rows.
    """
    rows, known = found.problem.numbers, found.problem.whitener
    if not len(rows) or known is None:
        return None
    residual, contradicted = found.fit.residual, np.zeros(len(rows))
    for place in range(len(rows)):
        unit = np.zeros(len(residual))
        unit[len(residual) - len(rows) + place] = 1.0
        own = known.applied(unit)
        own = own - found.fit.jacobian @ linear_step(found.fit.jacobian, own)
        left = float(own @ own)
        # a number that alone tells what it is explained by leaves nothing to compare it with
        contradicted[place] = abs(float(own @ residual)) / math.sqrt(known.variance * left) if left > 1e-9 else 0.0
    most = int(np.argmax(contradicted))
    return most if contradicted[most] > SURE else None


def log_odds_wrong(number: MeasuredNumber, among: Search, without: Search) -> float:
    """Logarithm of the odds that a number is wrong.

    Args:
        number: which.
        among: the search with it.
        without: the search without it.
    """
    given = number.kind.of(without.problem.settled(without.fit.effects).machine(without.fit.effects), number.setting)
    assert without.problem.calibration is not None
    variance = without.problem.calibration.variance
    beyond = math.log(number.value / given) / BEYOND
    freely = -0.5 * beyond**2 - math.log(BEYOND * number.value * math.sqrt(2 * math.pi))
    count = sum(trial.round == 1 for trial in without.trials) + len(among.problem.numbers)
    shared = replace(among.problem, evidence=without.problem.evidence)
    return (
        _log_evidence(without, without.problem, variance, count, 1)
        + freely
        - _log_evidence(among, shared, variance, count, 0)
    )


def _log_evidence(found: Search, problem: Problem, variance: float, count: int, wrong: int) -> float:
    """log p(y|S) + log p(S), up to a constant of the recordings, with λ as said."""
    assert problem.calibration is not None
    problem = replace(problem, calibration=replace(problem.calibration, variance=variance))
    problem = replace(problem, numbers=problem.numbers.with_variance(variance))
    fitted, known = fit(problem, found.fit.effects, iterations=0), problem.whitener
    assert known is not None
    free = fitted.jacobian.T @ fitted.jacobian
    volume = log_volume(fitted.effects, problem.plant, fitted.coordinates, free, variance)
    normal = np.eye(known.columns.shape[1]) + known.columns.T @ known.columns / variance
    widths = sum(math.log(one.deviation * math.sqrt(2 * math.pi)) for one in problem.numbers.numbers)
    declared = 0.5 * float(np.linalg.slogdet(normal)[1])
    size = len(fitted.effects) + wrong
    return -0.5 * fitted.squared_error / variance + volume + log_prior_of_size(size, count) - declared - widths


def sentence(number: MeasuredNumber, found: Search) -> str:
    """What is said of a number that was not fitted.

    Args:
        number: which.
        found: the search without it.
    """
    given = number.kind.of(found.problem.settled(found.fit.effects).machine(found.fit.effects), number.setting)
    unit = number.kind.unit
    value, tolerance, other = (format_quantity(v, unit) for v in (number.value, 2 * number.deviation, given))
    return (
        f"{number.name}: {value} ± {tolerance} contradicts the recordings, which with the declared values within their "
        f"tolerances give {other}; it was not fitted. Measure it again, or look at its unit and at how it was measured"
    )


Found = TypeVar("Found")


def without_wrong(
    problem: Problem, settled: Found, search_of: Callable[[Found], Search], settle: Callable[[Problem], Found]
) -> tuple[Problem, Found, tuple[MeasuredNumber, ...]]:
    """What is found without the numbers that are likelier to be wrong than right.

    Args:
        problem: with all numbers.
        settled: what was found with them.
        search_of: its search.
        settle: finds anew.

    Returns:
        The problem without them, what was found in it, and the numbers that were left out.
    """
    wrong: list[MeasuredNumber] = []
    while (place := most_doubtful(search_of(settled))) is not None:
        numbers = problem.numbers.numbers
        fewer = replace(problem.numbers, numbers=(*numbers[:place], *numbers[place + 1 :]), _known={})
        other = settle(replace(problem, numbers=fewer))
        if log_odds_wrong(numbers[place], search_of(settled), search_of(other)) <= 0:
            break
        wrong.append(numbers[place])
        problem, settled = replace(problem, numbers=fewer), other
    return problem, settled, tuple(wrong)
