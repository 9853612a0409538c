"""A law that takes far less than its first step promised: the declared values that it is told beside bend as well.

A candidate is fitted while what declared values may do is taken out along their slopes. A stiffness that falls over the
stroke moves the resonance that the declared stiffness sets: what is left of it beside these slopes is small, and every
step that a law is worth leaves the slopes behind. So its fit ends after a step that moved it by a third of the way,
and a lead error under a load that hangs, or nothing, took its place. Law and values in turn, with slopes of where they
are, are not held up.
"""

from __future__ import annotations

from collections.abc import Container, Sequence

from feeddrive.diagnosis.calibration.calibrate import of_hours
from feeddrive.diagnosis.calibration.together import fitted_together
from feeddrive.diagnosis.finding.attempt import JOINT_ITERATIONS, Attempt, refuse_at_an_end
from feeddrive.diagnosis.finding.likelier import FITTED, Taken
from feeddrive.diagnosis.finding.refitting import at_rest
from feeddrive.diagnosis.finding.round import FAIR_PART, Round
from feeddrive.diagnosis.likelihood.fit import Fit, fit
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.likelihood.set_evidence import log_prior_of_size
from feeddrive.diagnosis.likelihood.standing import Standing, gain_between, odds_between, same_samples
from feeddrive.effects.base import Effect
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
    least = _least_promise(problem, found, now, taken)
    short = [one for one in now.attempts if one.name not in denied and _fell_short(problem, found, one, least)]
    if not short or problem.budget.skips("laws that fell short of their first step"):
        return taken
    at_hand = _in_turn(problem, found.effects)  # values come to rest without the law as well
    for attempt in sorted(short, key=lambda one: -one.promised)[:FITTED]:
        try:
            other = _in_turn(problem, (*found.effects, attempt.fit.effects[-1]))
            refuse_at_an_end(other.problem, other.fit.effects[-1:])
            odds = odds_between(at_hand, other, now.count)
        except InputError:  # a machine on the way cannot be simulated
            continue
        if odds > (0.0 if taken is None else taken.odds) and gain_between(at_hand, other).pays:
            taken = Taken(other.problem, other.fit, attempt.name, odds)
    return taken


def _in_turn(problem: Problem, effects: Sequence[Effect]) -> Standing:
    """A set and the declared values fitted in turn, until no step leads to a likelier plant."""
    there, fitted = fitted_together(problem, effects)
    return Standing(*at_rest(there, fit(there, fitted, iterations=JOINT_ITERATIONS)))


def _least_promise(problem: Problem, found: Fit, now: Round, taken: Taken | None) -> float:
    """Squared error that a first step promises at least, to be asked: as much as makes it the likeliest set.

    That is a fair part of what the set at hand for the likeliest takes, and no less likely, values being moved or not:
    what one more name costs where none is likelier.
    """
    assert problem.calibration is not None
    if taken is None:
        size = len(found.effects)
        nats, most = log_prior_of_size(size, now.count) - log_prior_of_size(size + 1, now.count), 0.0
    else:
        nats, most = taken.odds, found.squared_error - taken.fit.squared_error
    return max(FAIR_PART * most, 2 * problem.calibration.variance * nats)


def _fell_short(problem: Problem, found: Fit, attempt: Attempt, least: float) -> bool:
    """Whether a fit took less than `HALF` of what its first step promised, and that is more than the `least`."""
    if not attempt.promised or not same_samples(attempt.problem, problem):
        return False
    took = found.squared_error - attempt.fit.squared_error
    return took < HALF * attempt.promised and attempt.promised > least
