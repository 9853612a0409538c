"""Odds for what is of no name beside a set of effects, as for any further effect: a lead map, the form of a law."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from feeddrive.diagnosis.likelihood.evidence import Evidence
from feeddrive.diagnosis.likelihood.fit import Fit, linear_step
from feeddrive.diagnosis.likelihood.law_curve import law_curves
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.likelihood.set_evidence import log_prior_of_size, variance_along
from feeddrive.effects.base import Effect
from feeddrive.typing import FloatArray


class OfNoName(NamedTuple):
    """Columns of no name beside a set.

    Attributes:
        odds: logarithm of the odds for them; minus infinity where there are none.
        left: squared error beside them, with what their coordinates cost.
        variance: c, that both are over.
    """

    odds: float
    left: float
    variance: float


NONE = OfNoName(float("-inf"), float("inf"), 1.0)


def log_odds_of_map(problem: Problem, found: Fit, count: int) -> float:
    """Logarithm of the odds for a lead map beside a set; minus infinity where no stroke shows one, or it is open.

    Args:
        problem: recordings.
        found: the set.
        count: candidates and starts that were tried for a name.
    """
    if any(e.open_map for e in problem.evidence):
        return float("-inf")
    return _of_no_name(problem, found, count, {e: e.map_parts for e in problem.evidence}).odds


def likeliest_curve(problem: Problem, found: Fit, count: int) -> tuple[OfNoName, Problem]:
    """The problem without what the other forms of a law of a set may make of it, the law for which the odds are best.

    Args:
        problem: recordings.
        found: the set.
        count: candidates and starts that were tried for a name.

    Returns:
        The curve, of no odds where no law has one that is not open; and the problem.
    """
    best, chosen = NONE, problem
    for place, effect in enumerate(found.effects):
        if any(effect.name in e.curves for e in problem.evidence):
            continue
        parts = law_curves(problem, found.effects, place)
        curve = _of_no_name(problem, found, count, parts)
        if curve.odds > best.odds:
            opened = (e.with_curves({**e.curves, effect.name: parts[e]}) for e in problem.evidence)
            best, chosen = curve, replace(problem, evidence=tuple(opened))
    return best, chosen


def with_curves_anew(problem: Problem, effects: Sequence[Effect]) -> Problem:
    """The problem with its open curves as large as their laws are now: as what the law does, so far may its form go."""
    evidence = list(problem.evidence)
    for place, effect in enumerate(effects):
        if any(effect.name in e.curves for e in evidence):
            parts = law_curves(problem, effects, place)
            evidence = [
                e.with_curves({**e.curves, effect.name: parts[its]}) if its in parts else e
                for e, its in zip(evidence, problem.evidence, strict=True)
            ]
    return replace(problem, evidence=tuple(evidence))


def log_odds_of_curves(problem: Problem, found: Fit, count: int, curved: Problem) -> float:
    """Logarithm of the odds for the curves that are open in a problem and closed in another.

    Args:
        problem: where they are closed.
        found: a set fitted there.
        count: candidates and starts that were tried for a name.
        curved: where they are open.
    """
    parts = {
        e: [part for name, curve in its.curves.items() if name not in e.curves for part in curve]
        for e, its in zip(problem.evidence, curved.evidence, strict=True)
    }
    return _of_no_name(problem, found, count, parts).odds


def open_curves(problem: Problem) -> tuple[str, ...]:
    """Laws whose curves are open in any recording."""
    return tuple(sorted({name for e in problem.evidence for name in e.curves}))


def with_curves_of(problem: Problem, effects: Sequence[Effect]) -> Problem:
    """The problem with no curves open but those of these laws."""
    names = {effect.name for effect in effects}
    if all(e.curves.keys() <= names for e in problem.evidence):
        return problem
    kept = ({name: curve for name, curve in e.curves.items() if name in names} for e in problem.evidence)
    return replace(problem, evidence=tuple(e.with_curves(one) for e, one in zip(problem.evidence, kept, strict=True)))


def _of_no_name(
    problem: Problem, found: Fit, count: int, parts_of: Mapping[Evidence, Sequence[dict[str, FloatArray]]]
) -> OfNoName:
    """Columns of no name beside a set.

    They are linear in their coordinates, of size one: one step from the set, with all that the set may do, is exact as
    far as the set is straight. Source: `likelihood.set_evidence`, with a normal prior.
    """
    rows = [int(e.thinned(e.fit_rows).sum()) * len(e.channels) for e in problem.evidence]
    parts, first, total = [], 0, len(found.residual)
    for e, size in zip(problem.evidence, rows, strict=True):
        for part in parts_of.get(e, ()):
            column = np.zeros(total)
            column[first : first + size] = e.weighted(part, e.thinned(e.fit_rows))
            parts.append(column if problem.whitener is None else problem.whitener.applied(column))
        first += size
    if not parts:
        return NONE
    columns = np.column_stack(parts)
    own = found.jacobian.shape[1]
    wide = np.column_stack([found.jacobian, columns]) if own else columns
    straight = found.residual - wide @ linear_step(wide, found.residual)
    beside = replace(found, residual=straight, jacobian=wide)
    variance = variance_along(problem, beside, found, beside)
    prior = np.sqrt(variance) * np.eye(wide.shape[1])[own:]  # what a deviation costs: of a size of one, as the noise
    rest = np.concatenate([found.residual, np.zeros(len(prior))])
    least = rest - np.vstack([wide, prior]) @ linear_step(np.vstack([wide, prior]), rest)
    volumes = [np.linalg.slogdet(j.T @ j / variance + np.eye(j.shape[1]))[1] for j in (found.jacobian, wide)]
    size = len(found.effects)
    more = log_prior_of_size(size + 1, count) - log_prior_of_size(size, count)
    left = float(least @ least)
    odds = 0.5 * (found.squared_error - left) / variance - 0.5 * (volumes[1] - volumes[0]) + more
    return OfNoName(float(odds), left, variance)
