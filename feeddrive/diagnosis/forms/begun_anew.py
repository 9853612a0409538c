"""A set with a law in another form in the place of one, fitted to rest, and the likeliest of such sets."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from feeddrive.diagnosis.calibration.value_slopes import with_slopes
from feeddrive.diagnosis.finding.refitting import at_rest, refitted
from feeddrive.diagnosis.likelihood.fit import fit
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.likelihood.standing import Standing, odds_between
from feeddrive.effects.base import Effect
from feeddrive.errors import InputError


def begun_anew(problem: Problem, effects: Sequence[Effect], place: int, law: Effect) -> Standing | None:
    """The set with a law in the place of another, its values at rest; None where it cannot be simulated on the way."""
    others = (*effects[:place], law, *effects[place + 1 :])
    try:
        there = problem if problem.calibration is None else with_slopes(problem, others)
        return Standing(*at_rest(*refitted(there, fit(there, others))))
    except InputError:
        return None


def likeliest(here: Standing, begun: Iterable[Standing | None], count: int) -> Standing | None:
    """The likeliest of some sets; None where that at hand is.

    Args:
        here: the set at hand.
        begun: others; None for one that could not be fitted.
        count: candidates and starts that were tried.
    """
    best: tuple[float, Standing | None] = (0.0, None)
    for other in begun:
        try:
            if other is not None and (odds := odds_between(here, other, count)) > best[0]:
                best = odds, other
        except InputError:  # cannot be simulated on the motions that the encoder's steps may hide
            continue
    return best[1]
