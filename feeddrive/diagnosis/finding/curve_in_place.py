"""What is likelier than a further name, or than a declared value beyond its tolerance: a lead map, the curve of a law.

A law of another form than ours leaves something that further names, and declared values, take up each as far as it
helps. The law with its own curve must leave what counts as noise (`LEVEL`): where more is left, more is missing than a
form.
"""

from __future__ import annotations

from dataclasses import replace

from feeddrive.diagnosis.finding.attempt import JOINT_ITERATIONS
from feeddrive.diagnosis.finding.likelier import Taken
from feeddrive.diagnosis.finding.members import member, members_of
from feeddrive.diagnosis.finding.open_map import likeliest_curve, log_odds_of_map, with_curves_of
from feeddrive.diagnosis.finding.refitting import refitted
from feeddrive.diagnosis.likelihood.cross_validation import Comparison
from feeddrive.diagnosis.likelihood.fit import Fit, fit
from feeddrive.diagnosis.likelihood.law_curve import has_curve
from feeddrive.diagnosis.likelihood.problem import LEVEL, Problem
from feeddrive.diagnosis.likelihood.set_evidence import Standing, log_odds, odds_between
from feeddrive.diagnosis.motion.predictability import has_play


def of_no_name(problem: Problem, found: Fit, taken: Taken | None, count: int) -> tuple[Problem, Fit] | None:
    """A set beside a lead map, or the curve of a law, where that is likelier than any further name; else None.

    A map that says nothing beside the likeliest name is none: over part of a stroke its curves are near a line.
    """
    likelier_map = log_odds_of_map(problem, found, count) > max(taken.odds if taken is not None else 0.0, 0.0)
    if likelier_map and (taken is None or log_odds_of_map(taken.problem, taken.fit, count) > 0):
        opened = replace(problem, evidence=tuple(e.with_map(True) for e in problem.evidence))
        return opened, fit(opened, found.effects)
    return None if taken is None else of_its_own_form(problem, found, taken, count) or _of_another_form(taken, count)


def of_its_own_form(problem: Problem, found: Fit, taken: Taken, count: int) -> tuple[Problem, Fit] | None:
    """A set beside the curve of one of its laws, where a likelier set lacks such a law and the curve is likelier still.

    What another form of a law leaves beside it is smaller once two others share what the law takes. The law and its
    curve must leave what counts as noise, as beside another name.
    """
    stays = members_of(taken.fit.effects)
    if not has_curve([effect for effect in found.effects if member(effect) not in stays]):
        return None
    odds, opened = likeliest_curve(problem, found, count)
    if odds <= taken.odds:
        return None
    there = fit(opened, found.effects, iterations=JOINT_ITERATIONS)
    return (opened, there) if _level(opened, there) * LEVEL**2 < 1 else None


def _of_another_form(taken: Taken, count: int) -> tuple[Problem, Fit] | None:
    """A likelier set without one of the names that it adds, where the curve of another of its laws is likelier.

    The law and its curve must leave what counts as noise (`LEVEL`): where more is left, more than a form is missing.
    """
    effects, added = taken.fit.effects, len(taken.names)
    problem = with_curves_of(taken.problem, effects)
    best, chosen = 0.0, None
    for place in range(len(effects) - added, len(effects)):
        rest = [effect for i, effect in enumerate(effects) if i != place]
        if has_curve(rest) and not has_play(effects[place : place + 1]):
            without = fit(problem, rest, iterations=JOINT_ITERATIONS)
            odds, opened = likeliest_curve(problem, without, count)
            odds -= log_odds(problem, without, taken.fit, count)
            there = fit(opened, rest, iterations=JOINT_ITERATIONS)
            if odds > best and _level(opened, there) * LEVEL**2 < 1:
                best, chosen = odds, (opened, without)
    return chosen


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
    return refitted(opened, there) if _level(opened, there) * LEVEL**2 < 1 else None


def _level(problem: Problem, found: Fit) -> float:
    """Weighted squared error per row, of the channel that is met worst by its noise."""
    left = max((value for e in problem.evidence for value in e.left.values()), default=1.0)
    return left**2 * found.squared_error / max(len(found.residual), 1)
