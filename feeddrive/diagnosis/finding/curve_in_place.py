"""What is likelier than a further name, or than a declared value beyond its tolerance: a lead map, the curve of a law.

A law of another form than ours leaves something that further names, and declared values, take up each as far as it
helps. The law with its own curve must leave what counts as noise (`LEVEL`): where more is left, more is missing than a
form.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import NamedTuple

from feeddrive.diagnosis.finding.attempt import JOINT_ITERATIONS, Attempt
from feeddrive.diagnosis.finding.likelier import Taken
from feeddrive.diagnosis.finding.members import member, members_of
from feeddrive.diagnosis.finding.open_map import likeliest_curve, log_odds_of_map, with_curves_of
from feeddrive.diagnosis.finding.refitting import refitted
from feeddrive.diagnosis.likelihood.cross_validation import Comparison
from feeddrive.diagnosis.likelihood.fit import Fit, fit
from feeddrive.diagnosis.likelihood.law_curve import has_curve
from feeddrive.diagnosis.likelihood.problem import LEVEL, Problem
from feeddrive.diagnosis.likelihood.set_evidence import Standing, log_odds, odds_between, same_samples
from feeddrive.diagnosis.motion.predictability import has_play

LAWS = 5
"""Candidates, by what they bring alone, that are asked beside their curves: it spares work."""


def of_no_name(
    problem: Problem, found: Fit, taken: Taken | None, count: int, attempts: Sequence[Attempt] = ()
) -> tuple[Problem, Fit] | None:
    """A set beside a lead map, or the curve of a law, where that is likelier than any further name; else None.

    A map that says nothing beside the likeliest name is none: over part of a stroke its curves are near a line.

    Args:
        problem: recordings.
        found: a set.
        taken: a likelier one, None where there is none.
        count: candidates and starts that were tried.
        attempts: of the round, the best first.
    """
    likelier_map = log_odds_of_map(problem, found, count) > max(taken.odds if taken is not None else 0.0, 0.0)
    if likelier_map and (taken is None or log_odds_of_map(taken.problem, taken.fit, count) > 0):
        opened = replace(problem, evidence=tuple(e.with_map(True) for e in problem.evidence))
        return opened, fit(opened, found.effects)
    if taken is None:
        return None
    own = of_its_own_form(problem, found, taken, count)
    if own is not None:
        return own
    likelier = [*_of_another_form(taken, count), *_of_one_law(problem, found, taken, count, attempts)]
    return max(likelier, key=lambda one: one.odds).there if likelier else None


def of_its_own_form(problem: Problem, found: Fit, taken: Taken, count: int) -> tuple[Problem, Fit] | None:
    """A set beside the curve of one of its laws, where a likelier set lacks such a law and the curve is likelier still.

    What another form of a law leaves beside it is smaller once two others share what the law takes.
    """
    stays = members_of(taken.fit.effects)
    if not has_curve([effect for effect in found.effects if member(effect) not in stays]):
        return None
    odds, opened = likeliest_curve(problem, found, count)
    if odds <= taken.odds:
        return None
    there = fit(opened, found.effects, iterations=JOINT_ITERATIONS)
    return (opened, there) if _leaves_little(opened, there) else None


class _Curved(NamedTuple):
    """A set beside the curve of one of its laws, and by how much it is likelier than one of further names."""

    odds: float
    there: tuple[Problem, Fit]


def _of_another_form(taken: Taken, count: int) -> Iterator[_Curved]:
    """A likelier set without one of the names that it adds, where the curve of another of its laws is likelier."""
    effects, added = taken.fit.effects, len(taken.names)
    problem = with_curves_of(taken.problem, effects)
    for place in range(len(effects) - added, len(effects)):
        rest = [effect for i, effect in enumerate(effects) if i != place]
        if has_curve(rest) and not has_play(effects[place : place + 1]):
            without = fit(problem, rest, iterations=JOINT_ITERATIONS)
            odds, opened = likeliest_curve(problem, without, count)
            odds -= log_odds(problem, without, taken.fit, count)
            if odds > 0 and _leaves_little(opened, fit(opened, rest, iterations=JOINT_ITERATIONS)):
                yield _Curved(odds, (opened, without))


def _of_one_law(
    problem: Problem, found: Fit, taken: Taken, count: int, attempts: Sequence[Attempt]
) -> Iterator[_Curved]:
    """One law beside its curve in place of two names that a likelier set adds, where it is likelier.

    A law of another form may be worth less by itself than two others that share what it takes.
    """
    if len(taken.names) < 2 or not taken.odds < math.inf:
        return
    before = with_curves_of(problem, found.effects)
    for attempt in [one for one in attempts if same_samples(one.problem, problem)][:LAWS]:
        law = attempt.fit.effects[-1]
        if not has_curve([law]) or has_play([law]):
            continue
        alone = fit(before, [*found.effects, law], iterations=JOINT_ITERATIONS)
        odds, opened = likeliest_curve(before, alone, count)
        odds += log_odds(before, found, alone, count) - taken.odds
        there = fit(opened, alone.effects, iterations=JOINT_ITERATIONS)
        if odds > 0 and _leaves_little(opened, there):
            yield _Curved(odds, (opened, there))


def curve_of_value(
    problem: Problem, found: Fit, beyond: tuple[Problem, Fit, Comparison], count: int
) -> tuple[Problem, Fit] | None:
    """A set beside the curve of one of its laws, where that is likelier than a declared value beyond its tolerance.

    A law of another form than ours draws declared values along, each as far as it helps.
    """
    if not has_curve(found.effects):
        return None
    odds, opened = likeliest_curve(problem, found, count)
    if odds <= max(odds_between(Standing(problem, found), Standing(*beyond[:2]), count), 0.0):
        return None
    there = fit(opened, found.effects, iterations=JOINT_ITERATIONS)
    return refitted(opened, there) if _leaves_little(opened, there) else None


def _leaves_little(problem: Problem, found: Fit) -> bool:
    """Whether a set beside a curve leaves what counts as noise (`LEVEL`)."""
    return _level(problem, found) * LEVEL**2 < 1


def _level(problem: Problem, found: Fit) -> float:
    """Weighted squared error per row, of the channel that is met worst by its noise."""
    left = max((value for e in problem.evidence for value in e.left.values()), default=1.0)
    return left**2 * found.squared_error / max(len(found.residual), 1)
