"""What is likelier than a further name, or than a declared value beyond its tolerance: a lead map, the curve of a law.

A law of another form than ours leaves something that further names, and declared values, take up each as far as it
helps. A curve over the stroke takes up what level it has beside the declared friction. The law with its own curve must
leave what counts as noise (`LEVEL`), for where more is left, more is missing than a form; or less than the law leaves
beside the likeliest name, which is then no more the cause of the rest.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from feeddrive.diagnosis.calibration.stated import is_within_tolerance, without_effects
from feeddrive.diagnosis.finding.attempt import JOINT_ITERATIONS
from feeddrive.diagnosis.finding.likelier import Taken
from feeddrive.diagnosis.finding.members import member, members_of
from feeddrive.diagnosis.finding.refitting import balanced, refitted
from feeddrive.diagnosis.finding.round import Round
from feeddrive.diagnosis.forms.open_map import (
    OfNoName,
    likeliest_curve,
    log_odds_of_map,
    open_curves,
    with_curves_anew,
    with_curves_of,
)
from feeddrive.diagnosis.friction_at_port import declared_level
from feeddrive.diagnosis.likelihood.coordinates import read_coordinates, write_coordinates
from feeddrive.diagnosis.likelihood.cross_validation import Comparison
from feeddrive.diagnosis.likelihood.fit import Fit, fit
from feeddrive.diagnosis.likelihood.law_curve import has_curve, products
from feeddrive.diagnosis.likelihood.problem import LEVEL, Problem
from feeddrive.diagnosis.likelihood.set_evidence import log_odds, log_prior_of_size
from feeddrive.diagnosis.likelihood.standing import Standing, odds_between, same_samples
from feeddrive.diagnosis.motion.predictability import has_play
from feeddrive.effects.base import Effect, Port, listed, number
from feeddrive.effects.friction.friction_deviation import FrictionDeviation
from feeddrive.effects.friction.friction_vs_position import FrictionVsPosition

TURNS = 3
"""Times that curves are taken anew at most."""

ALIKE = 0.2
"""Share by which a law may have changed for its curve to stay: a deviation of one is then wrong by a fifth."""


def of_no_name(problem: Problem, found: Fit, taken: Taken | None, now: Round) -> tuple[Problem, Fit] | None:
    """A set beside a lead map, or the curve of a law, where that is likelier than any further name; else None.

    A map that says nothing beside the likeliest name is none: over part of a stroke its curves are near a line.

    Args:
        problem: recordings.
        found: the set at hand.
        taken: the likeliest set near it; None where none is likelier.
        now: candidates of this round.
    """
    count = now.count
    likelier_map = log_odds_of_map(problem, found, count) > max(taken.odds if taken is not None else 0.0, 0.0)
    if likelier_map and (taken is None or log_odds_of_map(taken.problem, taken.fit, count) > 0):
        opened = replace(problem, evidence=tuple(e.with_map(True) for e in problem.evidence))
        return opened, fit(opened, found.effects)
    if taken is None:
        return None
    return (
        of_its_own_form(problem, found, taken, count)
        or _of_rival_form(problem, taken, now)
        or _of_another_form(taken, count)
    )


def of_its_own_form(problem: Problem, found: Fit, taken: Taken, count: int) -> tuple[Problem, Fit] | None:
    """A set beside the curve of one of its laws, where a likelier set lacks such a law and the curve is likelier still.

    What another form of a law leaves beside it is smaller once two others share what the law takes.
    """
    stays = members_of(taken.fit.effects)
    if not has_curve([effect for effect in found.effects if member(effect) not in stays]):
        return None
    curve, opened = likeliest_curve(problem, found, count)
    if curve.odds <= taken.odds:
        return None
    there = fit(opened, found.effects, iterations=JOINT_ITERATIONS)
    return (opened, there) if _leaves_less(Standing(opened, there), Standing(taken.problem, taken.fit)) else None


def _of_another_form(taken: Taken, count: int) -> tuple[Problem, Fit] | None:
    """A likelier set without one or all names that it adds, where the curve of another of its laws is likelier.

    Each channel weighs by what the likelier set leaves: where what it explains is many times the noise, channels still
    weighed by that hardly tell whether a curve reaches it as well.

    Of several the likeliest, over one variance: what is left beside a law far from its own form has another colour than
    beside one that is near, and odds over either are none between the two.
    """
    effects, added = taken.fit.effects, len(taken.names)
    first = len(effects) - added
    singly = [[place] for place in range(first, len(effects))]
    asked = []
    for gone in singly if added == 1 else [*singly, list(range(first, len(effects)))]:
        stays = [place for place in range(len(effects)) if place not in gone]
        if has_curve([effects[place] for place in stays]) and not has_play([effects[place] for place in gone]):
            asked.append(stays)
    if not asked:
        return None
    problem = with_curves_of(taken.problem, effects)
    problem, named = balanced(problem, fit(problem, effects, iterations=JOINT_ITERATIONS))
    able: list[tuple[OfNoName, tuple[Problem, Fit]]] = []
    for stays in asked:
        rest = [named.effects[place] for place in stays]
        without = fit(problem, rest, iterations=JOINT_ITERATIONS)
        curve, opened = likeliest_curve(problem, without, count)
        likelier = curve.odds > log_odds(problem, without, named, count, variance=curve.variance)
        there = fit(opened, rest, iterations=JOINT_ITERATIONS)
        if likelier and _leaves_less(Standing(opened, there), Standing(problem, named)):
            able.append((curve, (opened, without)))
    if not able:
        return None
    variance = min((curve for curve, _ in able), key=lambda one: one.left).variance

    def unlikeliness(one: tuple[OfNoName, tuple[Problem, Fit]]) -> float:
        return 0.5 * one[0].left / variance - log_prior_of_size(len(one[1][1].effects), count)

    return min(able, key=unlikeliness)[1]


def _of_rival_form(problem: Problem, taken: Taken, now: Round) -> tuple[Problem, Fit] | None:
    """A law over the variable of one that is added, beside its curve, where that is likelier; else None.

    Not asked where the likeliest set leaves noise.

    Far from its own form a law takes less than two others that share what it does: a friction of two directions that
    takes some speed was told as one that grows with it and a Stribeck drop. So the other law is begun as large as the
    one that is added, and has declared values and a curve of its own, before the two are held against each other. The
    likeliest set has the curve of one of its laws as well, where one is likely, and both are over one variance, of
    channels weighed alike.
    """
    if _is_noise(taken.problem, taken.fit):
        return None
    here = members_of(taken.fit.effects)
    able: list[tuple[OfNoName, Problem, Fit]] = []
    for attempt in now.attempts:
        law = attempt.fit.effects[-1]
        before = members_of(attempt.fit.effects[:-1])
        added = [one for one in taken.fit.effects if member(one) not in before]
        alike = [one for one in added if law.curve_over and one.curve_over == law.curve_over]
        if not alike or member(law) in here or not same_samples(attempt.problem, problem):
            continue
        rest = [one for one in taken.fit.effects if member(one) in before]
        other = _as_large_as(problem, alike[0], law)
        rested, plain = refitted(problem, fit(problem, [*rest, other], iterations=0))
        curve, opened = likeliest_curve(rested, plain, now.count)
        if curve.odds > 0:
            able.append((curve, opened, plain))
    if not able:
        return None
    curve, opened, plain = min(able, key=lambda one: one[0].left)
    weighed = taken.problem.weighed(opened.evidence[0].left)
    named = fit(weighed, taken.fit.effects, iterations=0 if weighed is taken.problem else JOINT_ITERATIONS)
    own, _ = likeliest_curve(weighed, named, now.count)
    left = min(own.left, named.squared_error) if own.odds > 0 else named.squared_error
    spared = log_prior_of_size(len(plain.effects), now.count) - log_prior_of_size(len(taken.fit.effects), now.count)
    if 0.5 * (left - curve.left) / curve.variance + spared <= 0:
        return None
    there = fit(opened, plain.effects, iterations=JOINT_ITERATIONS)
    return (opened, there) if _leaves_less(Standing(opened, there), Standing(taken.problem, taken.fit)) else None


def _as_large_as(problem: Problem, taken: Effect, law: Effect) -> Effect:
    """A law of a size at which it makes of the recordings as much of what another one does as it can."""
    dot = square = 0.0
    for e in problem.evidence:
        bare, *both = (problem.predictor.predict(problem.machine(some), e) for some in ([], [taken], [law]))
        mine, its = ({name: one[name] - bare[name] for name in e.channels} for one in both)
        more = products(mine, its, e)
        dot, square = dot + more[0], square + more[1]
    if not square > 0:
        return law
    (other,) = write_coordinates([law], problem.plant, read_coordinates([law], problem.plant) * dot / square)
    return other


def curve_of_value(
    problem: Problem, found: Fit, beyond: tuple[Problem, Fit, Comparison], count: int
) -> tuple[Problem, Fit] | None:
    """A set beside the curve of one of its laws, where that is likelier than a declared value beyond its tolerance.

    A law of another form than ours draws declared values along, each as far as it helps.
    """
    if not has_curve(found.effects):
        return None
    curve, opened = likeliest_curve(problem, found, count)
    if curve.odds <= max(odds_between(Standing(problem, found), Standing(*beyond[:2]), count), 0.0):
        return None
    there = fit(opened, found.effects, iterations=JOINT_ITERATIONS)
    return with_its_curves(opened, there) if _leaves_less(Standing(opened, there), Standing(*beyond[:2])) else None


def with_level_in_curve(beyond: tuple[Problem, Fit, Comparison]) -> tuple[Problem, Fit] | None:
    """A set in which the level that a guide has more is that of its curve over the stroke; None where it has none.

    To a recording the two are one number, and a curve with a level is a name less than two.

    Args:
        beyond: a set with a declared value as an effect beyond its tolerance, the last one.
    """
    problem, effects = beyond[0], [*beyond[1].effects]
    deviation = effects.pop()
    if not isinstance(deviation, FrictionDeviation) or deviation.port is not Port.TABLE:
        return None
    for place, effect in enumerate(effects):
        if not isinstance(effect, FrictionVsPosition) or not isinstance(effect.values["delta_force"], tuple):
            continue
        if is_within_tolerance(deviation.with_values(viscous_factor=1.0), problem.plant):
            return None
        more = (number(deviation.values["coulomb_factor"]) - 1) * declared_level(problem.plant, Port.TABLE)
        curve = tuple(force + more for force in listed(effect.values["delta_force"]))
        effects[place] = effect.with_values(delta_force=curve)
        there = without_effects(problem, [deviation], effects)
        return refitted(there, fit(there, effects))
    return None


def with_its_curves(problem: Problem, found: Fit) -> tuple[Problem, Fit]:
    """A set fitted beside the curves of its laws, anew where a law is of another size than when its curve was taken.

    A curve is as large as its law at most. Fitted alone a law of another form may be a third of what it is beside its
    curve, and values that stood in for the rest stay where they stood.
    """
    for _ in range(TURNS):
        before = read_coordinates(found.effects, problem.plant)
        problem, found = refitted(problem, found)
        there = read_coordinates(found.effects, problem.plant)
        if not open_curves(problem) or len(there) != len(before):
            break
        if np.all(np.abs(there - before) <= ALIKE * np.maximum(np.abs(before), np.abs(there))):
            break
        problem = with_curves_anew(problem, found.effects)
        found = fit(problem, found.effects, iterations=JOINT_ITERATIONS)
    return problem, found


def _leaves_less(curved: Standing, named: Standing) -> bool:
    """Whether a set beside a curve leaves what counts as noise, or less than one with a name, as far as levels tell."""
    if _is_noise(curved.problem, curved.fit):
        return True
    return _level(curved.problem, curved.fit) < LEVEL**2 * _level(named.problem, named.fit)


def _is_noise(problem: Problem, found: Fit) -> bool:
    """Whether what a set leaves counts as noise."""
    return _level(problem, found) * LEVEL**2 < 1


def _level(problem: Problem, found: Fit) -> float:
    """Squared error per row, every channel over its noise, whatever else the channels are weighed by."""
    total = 0.0
    for e, channels in zip(problem.evidence, problem.by_channel(found.residual), strict=True):
        total += sum(e.left.get(name, 1.0) ** 2 * float(rows @ rows) for name, rows in channels.items())
    return total / max(len(found.residual), 1)
