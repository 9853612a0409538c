"""Two forms of a bristle: one that slips from the first move on, and one that is elastic up to where it breaks away.

A form is chosen where the bristle is first taken, by one step beside what was named then. Beside names that are taken
later the other one may be likelier: a bristle that creeps takes a part of a free play, which is then too narrow.
"""

from __future__ import annotations

from feeddrive.diagnosis.likelihood.fit import Fit, fit
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.likelihood.standing import Standing, odds_between
from feeddrive.diagnosis.starts.starts import BREAK_AWAY
from feeddrive.effects.friction.presliding import Presliding


def of_likelier_bristle(problem: Problem, found: Fit, count: int) -> tuple[Problem, Fit]:
    """The set with a bristle that breaks away in the place of one that slips throughout, where that is likelier.

    Args:
        problem: recordings.
        found: the set, all its effects free.
        count: candidates and starts that were tried.
    """
    effects = list(found.effects)
    slipping = [i for i, one in enumerate(effects) if isinstance(one, Presliding) and not one.values["break_away"]]
    if len(effects) < 2 or not slipping:  # alone both forms were started, and compared
        return problem, found
    for i in slipping:
        effects[i] = effects[i].with_values(break_away=BREAK_AWAY)
    there = fit(problem, effects)
    if not problem.possible(there.effects):
        return problem, found
    odds = odds_between(Standing(problem, found), Standing(problem, there), count)
    return (problem, there) if odds > 0 else (problem, found)
