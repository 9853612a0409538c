"""Two effects of which neither is likelier alone: each is taken for once, and what comes near beside it is asked.

A bristle breaks away at every reversal where friction drops with speed, and hardly at any where it does not. Alone
either leaves so much, of such a colour, that it is as likely as nothing, and no slope beside nothing tells of both.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from feeddrive.diagnosis.finding.attempt import JOINT_ITERATIONS, begun_beside
from feeddrive.diagnosis.finding.likelier import FITTED, Taken
from feeddrive.diagnosis.finding.round import FAIR_PART, Round
from feeddrive.diagnosis.likelihood.fit import Fit, fit
from feeddrive.diagnosis.likelihood.problem import UNEXPLAINED, Problem
from feeddrive.diagnosis.likelihood.standing import Standing, gain_between, odds_between, same_samples
from feeddrive.errors import InputError


def two_at_once(
    problem: Problem, found: Fit, now: Round, ask: Callable[[Problem, Fit], Taken | None]
) -> Taken | None:  # fmt: skip
    """The likeliest set of two effects or more that is likelier than none; None where there is none.

    Asked where much is left beside no effect at all, of those that take a fair part of it alone (`FAIR_PART`). Beside
    others each round costs as much as all before it, and what is left of a real axis is much at every end.

    Args:
        problem: recordings.
        found: nothing but the declared machine, beside which no effect is likelier.
        now: what was tried beside it.
        ask: the likeliest set near another one, a round beside that; None where none is likelier.
    """
    if found.effects or problem.plain_error(found.effects) < UNEXPLAINED or problem.budget.skips("two effects at once"):
        return None
    at_hand, ahead = Standing(problem, found), list[Taken]()
    able = [attempt for attempt in now.attempts if same_samples(attempt.problem, problem)]
    for first in sorted(able, key=lambda attempt: attempt.fit.squared_error)[:FITTED]:
        if first.fit.squared_error > (1 - FAIR_PART) * found.squared_error:
            break
        try:
            alone = fit(problem, first.fit.effects, iterations=JOINT_ITERATIONS)
            beside = ask(problem, alone)
            if beside is None:
                continue
            there = _first_anew(beside, first.name)
            odds = odds_between(at_hand, there, now.count)
            if odds > 0 and gain_between(at_hand, there).pays:
                ahead.append(replace(there, name=" with ".join((first.name, *beside.names)), odds=odds))
        except InputError:
            continue
    return max(ahead, key=lambda one: one.odds, default=None)


def _first_anew(taken: Taken, name: str) -> Taken:
    """The set with its first effect started anew beside the second, where less is left: it began at what both leave."""
    rest = [effect for effect in taken.fit.effects if effect.name != name]
    others = fit(taken.problem, rest, iterations=JOINT_ITERATIONS)
    best = taken
    for start in begun_beside(taken.problem, others, name):
        result = fit(taken.problem, start)
        if result.squared_error < best.fit.squared_error:
            best = replace(taken, fit=result)
    return best
