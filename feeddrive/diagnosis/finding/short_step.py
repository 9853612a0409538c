"""A law that takes far less than its first step promised: the declared values that it is told beside bend as well.

A candidate is fitted while what declared values may do is taken out along their slopes. A stiffness that falls over the
stroke moves the resonance that the declared stiffness sets: what is left of it beside these slopes is small, and every
step that a law is worth leaves the slopes behind. So its fit ends after a step that moved it by a third of the way,
and a lead error under a load that hangs, or nothing, took its place. Law and values in turn, with slopes of where they
are, are not held up.
"""

from __future__ import annotations

from collections.abc import Container

from feeddrive.diagnosis.calibration.calibrate import of_hours
from feeddrive.diagnosis.calibration.together import fitted_together
from feeddrive.diagnosis.finding.attempt import JOINT_ITERATIONS, Attempt, refuse_at_an_end
from feeddrive.diagnosis.finding.likelier import FITTED, Taken
from feeddrive.diagnosis.finding.refitting import at_rest
from feeddrive.diagnosis.finding.round import FAIR_PART, Round
from feeddrive.diagnosis.likelihood.fit import Fit, fit
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.likelihood.set_evidence import Standing, gain_between, odds_between, same_samples
from feeddrive.errors import InputError

HALF = 0.5
"""Share of what its first step promised that a fit takes at least where the prediction is about straight."""


def with_values_moved(
    problem: Problem, found: Fit, now: Round, taken: Taken | None, denied: Container[str]
) -> Taken | None:
    """The likeliest set near one, or a likelier one with a law whose fit fell short, fitted in turn with the values.

    Args:
        problem: recordings.
        found: the set at hand.
        now: what was tried beside it.
        taken: the likeliest set near it; None where none is likelier.
        denied: names that are not asked.
    """
    if problem.calibration is None or of_hours(problem):
        return taken
    most = found.squared_error - (found if taken is None else taken.fit).squared_error
    short = [one for one in now.attempts if one.name not in denied and _fell_short(problem, found, one, most)]
    at_hand = Standing(problem, found)
    for attempt in sorted(short, key=lambda one: -one.promised)[:FITTED]:
        if problem.budget.skips("beside moving declared values", attempt.name):
            break
        try:
            there, effects = fitted_together(problem, (*found.effects, attempt.fit.effects[-1]))
            there, its = at_rest(there, fit(there, effects, iterations=JOINT_ITERATIONS))
            refuse_at_an_end(there, its.effects[-1:])
            other = Standing(there, its)
            odds = odds_between(at_hand, other, now.count)
            best = odds > 0 and (taken is None or odds_between(taken, other, now.count) > 0)
        except InputError:  # a machine on the way cannot be simulated
            continue
        if best and gain_between(at_hand, other).pays:
            taken = Taken(there, its, attempt.name, odds)
    return taken


def _fell_short(problem: Problem, found: Fit, attempt: Attempt, most: float) -> bool:
    """Whether a fit took less than `HALF` of what its first step promised, and that is a fair part of `most`."""
    if not attempt.promised or not same_samples(attempt.problem, problem):
        return False
    took = found.squared_error - attempt.fit.squared_error
    return took < HALF * attempt.promised and attempt.promised > FAIR_PART * most
