"""The likeliest of the sets near one: the few that slopes put first are fitted, and compared with each other."""

from __future__ import annotations

from collections.abc import Container, Iterable, Sequence
from dataclasses import dataclass, replace

from feeddrive.diagnosis.calibration.calibrate import of_hours
from feeddrive.diagnosis.finding.attempt import (
    JOINT_ITERATIONS,
    Attempt,
    begun_beside,
    compared,
    refuse_at_an_end,
    refuse_of_no_hours,
)
from feeddrive.diagnosis.finding.columns import Neighbour
from feeddrive.diagnosis.finding.round import Round
from feeddrive.diagnosis.finding.sets import neighbours
from feeddrive.diagnosis.forms.open_map import likeliest_curve, log_odds_of_curves, with_curves_of
from feeddrive.diagnosis.forms.spring_law import LAWS, play_from_declared, with_likelier_law
from feeddrive.diagnosis.likelihood.fit import Fit, error_of, fit
from feeddrive.diagnosis.likelihood.problem import LEVEL, UNEXPLAINED, Problem
from feeddrive.diagnosis.likelihood.standing import Standing, gain_between, odds_between, regained, same_samples
from feeddrive.effects.base import Effect
from feeddrive.effects.transmission.backlash import Backlash
from feeddrive.errors import InputError

FITTED = 2
"""Sets one move away that are fitted in a round, and one two moves away where slopes say that it is likelier: starts
are near by design, so that slopes put the likeliest among the first."""

ASKED = 3 * FITTED
"""As many where an encoder does not tell the motion: what its steps give is asked of a fitted set alone, and a set that
slopes put first for it takes no place from a name behind."""


@dataclass(frozen=True)
class Near:
    """An effect that was not taken: logarithm of the odds for it, and the part that grows with the time recorded."""

    name: str
    gain: float
    speaks: float


@dataclass(frozen=True)
class Taken(Standing):
    """A likelier set: its recordings and fit, what was added, by how much it is likelier, and whether its law is."""

    name: str
    odds: float
    of_law: bool = False

    @property
    def names(self) -> list[str]:
        """Names that it adds."""
        return self.name.split(" with ") if self.name else []


def likelier(
    problem: Problem, found: Fit, now: Round, denied: Container[str], further: int = 1
) -> tuple[Taken | None, tuple[Near, ...]]:
    """The likeliest of the sets near one, fitted, None where none is likelier; and what comes near beside it.

    Args:
        problem: recordings.
        found: the set.
        now: candidates of this round.
        denied: names that are not asked for.
        further: sets two moves away that are fitted.
    """
    tried_here = [attempt for attempt in now.attempts if attempt.matters]
    here = [attempt for attempt in tried_here if same_samples(attempt.problem, problem)]
    sets = neighbours(problem, found, here, now.count)
    able = [one for one in sets if one.gain > 0]
    at_hand = Standing(problem, found)
    tried: list[Taken | None] = []
    given = dict[tuple[int, ...], float]()  # odds of names added: slopes do not know what the encoder's steps give
    most = ASKED if any(e.at_draws for e in problem.evidence) else FITTED
    for one in [each for each in able if each.is_next][:most] + [each for each in able if not each.is_next][:further]:
        if one.is_next and sum(each is not None and each.odds > 0 for each in tried) >= FITTED:
            continue
        if tried and problem.budget.skips("sets of effects that came near"):  # the likeliest in any case
            break
        taken = _fitted(at_hand, one, here, now.count, denied)
        tried.append(taken)
        if taken is not None and not one.dropped:
            given[one.added] = taken.odds
    for attempt in tried_here:
        if not same_samples(attempt.problem, problem):  # some samples tell less of it: compared on the others
            there = fit(attempt.problem, found.effects, iterations=0)
            away = neighbours(attempt.problem, there, [attempt], now.count)
            tried += [
                _fitted(at_hand, one, [attempt], now.count, denied) for one in away[:1] if one.gain > 0 and one.added
            ]
    ahead = [one for one in tried if one is not None and one.odds > 0]
    best = _of_nearest_form(_best(ahead, now.count), ahead, now.count)
    beside = [one for one in sets if not one.dropped and len(one.added) == 1 and one.speaks > 0]
    odds = [min(one.gain, given.get(one.added, one.gain)) for one in beside]
    return best, tuple(Near(here[x.added[0]].name, gain, x.speaks) for x, gain in zip(beside, odds, strict=True))


def _fitted(
    at_hand: Standing, one: Neighbour, attempts: Sequence[Attempt], count: int, denied: Container[str]
) -> Taken | None:
    """A set fitted; None where it cannot be simulated, or what it adds does not pay on blocks left out.

    A law of the nut's spring that does not pay is asked once more from the declared values on: those fitted without it
    stand in for it. So is every other likelier set, at the weights that it gives the channels itself.
    """
    problem, found = at_hand.problem, at_hand.fit
    kept = [effect for place, effect in enumerate(found.effects) if place not in one.dropped]
    added = [attempts[i] for i in one.added]
    # what shows in a brief passage alone is judged in blocks as short
    own = added[0].problem if len(added) == 1 else problem
    name = " with ".join(attempt.name for attempt in added)
    own = with_curves_of(own, [*kept, *(attempt.fit.effects[-1] for attempt in added)])
    starts = [[*kept, *(attempt.fit.effects[-1] for attempt in added)], [*one.effects]]
    try:
        if len(added) == 2:
            starts += [_restarted(problem, kept, *order) for order in (added, added[::-1])]
        nearest = min((start for start in starts if start), key=lambda start: error_of(own, start), default=[])
        result = fit(own, nearest, iterations=JOINT_ITERATIONS)
        again = regained(own, result.effects)
        if again is not own:  # what the play could not predict is to be predicted again
            own, result = again, fit(again, result.effects, iterations=JOINT_ITERATIONS)
        refuse_at_an_end(own, result.effects[len(kept) :])
        refuse_of_no_hours(own, result.effects)
        taken = Taken(own, result, name, _odds(at_hand, Standing(own, result), count))
        if not one.added or one.dropped or compared(own, name, result, found.effects).pays:
            return taken
        if taken.odds > 0 and (rested := _at_its_weights(taken, found, len(kept))) is not None:
            return replace(rested, odds=_odds(at_hand, rested, count))
        anew = of_likelier_law(taken, count, denied)
        if anew is None or anew is taken or not gain_between(at_hand, anew).pays:
            return None
        return replace(anew, odds=odds_between(at_hand, anew, count))
    except InputError:
        return None


def _at_its_weights(taken: Taken, found: Fit, kept: int) -> Taken | None:
    """A likelier set fitted to its end, each channel weighed by what itself leaves, where it then pays; else None.

    Beside a set that lacks an effect the channel that shows it weighs little: its fit comes to rest where declared
    values say most of it, and no block left out tells of one that is still on its way.
    """
    own = taken.problem.balanced(taken.fit.effects)
    result = fit(own, taken.fit.effects)
    refuse_at_an_end(own, result.effects[kept:])
    if not compared(own, taken.name, result, found.effects).pays:
        return None
    there = fit(taken.problem, result.effects, iterations=JOINT_ITERATIONS)
    return replace(taken, fit=there)


def _restarted(problem: Problem, kept: Sequence[Effect], first: Attempt, second: Attempt) -> list[Effect]:
    """One of two effects fitted, and the other started anew at what is left: alone each began at what both leave.

    Empty where the second has no start there.
    """
    before = fit(problem, [*kept, first.fit.effects[-1]], iterations=JOINT_ITERATIONS)
    return next(iter(begun_beside(problem, before, second.name)), [])


def _odds(at_hand: Standing, there: Standing, count: int) -> float:
    """Logarithm of the odds for a set against the one at hand; a law that goes takes its curve with it."""
    closed = with_curves_of(at_hand.problem, there.fit.effects)
    if closed is at_hand.problem:
        return odds_between(at_hand, there, count)
    bare = Standing(closed, fit(closed, at_hand.fit.effects, iterations=JOINT_ITERATIONS))
    return odds_between(bare, there, count) - log_odds_of_curves(closed, bare.fit, count, at_hand.problem)


def _best(likelier: Iterable[Taken], count: int) -> Taken | None:
    """The likeliest of sets, compared with each other: all may be far ahead of the set at hand."""
    best: Taken | None = None
    for one in sorted(likelier, key=lambda one: len(one.fit.coordinates)):
        if best is None or (odds_between(best, one, count) if _as_curved(best, one) else one.odds - best.odds) > 0:
            best = one
    return best


def _of_nearest_form(best: Taken | None, others: Sequence[Taken], count: int) -> Taken | None:
    """The likeliest set, or one with another law in its place that needs less of a curve to leave noise alone.

    A law of another form leaves much, and a law of another cause may by chance leave less than its own: a drop at low
    speed in place of a drag with the 1.5th power of it. So where much is left both are asked beside their curves.
    """
    if best is None or best.problem.plain_error(best.fit.effects) < UNEXPLAINED:
        return best
    size = len(best.fit.effects)
    rivals = [
        one
        for one in others
        if len(one.fit.effects) == size and _as_curved(best, one) and same_samples(best.problem, one.problem)
    ]
    if len(rivals) < 2:
        return best
    able = []
    for one in rivals:
        curve, opened = likeliest_curve(one.problem, one.fit, count)
        if curve.odds > 0:
            there = fit(opened, one.fit.effects, iterations=JOINT_ITERATIONS)
            if opened.plain_error(there.effects) * LEVEL**2 < 1:
                able.append((curve, one))
    return min(able, key=lambda pair: pair[0].left)[1] if able else best


def _as_curved(one: Standing, other: Standing) -> bool:
    """Whether the same laws' curves are open in two problems."""
    pairs = zip(one.problem.evidence, other.problem.evidence, strict=True)
    return all(mine.curves.keys() == its.curves.keys() for mine, its in pairs)


def with_play(problem: Problem, found: Fit, count: int) -> Taken | None:
    """A likelier set with free play that hides beside the fitted values; None where nothing is left that it may say.

    Its law is not yet the likelier: `of_likelier_law` asks for lost preload in its place, and settles the play again.
    """
    if problem.calibration is None or of_hours(problem) or problem.plain_error(found.effects) < UNEXPLAINED:
        return None
    there = play_from_declared(problem, found)
    odds = odds_between(Standing(problem, found), there, count) if there is not None else 0.0
    return Taken(there.problem, there.fit, Backlash.name, odds) if there is not None and odds > 0 else None


def of_likelier_law(taken: Taken | None, count: int, denied: Container[str]) -> Taken | None:
    """A likelier set with the likelier of free play and lost preload, where it adds one of them."""
    if taken is None or taken.of_law or not any(name in LAWS for name in taken.names):
        return taken
    there = with_likelier_law(taken.problem, taken.fit, count, denied)
    if there is None:
        return taken
    (law,) = [effect.name for effect in there.fit.effects if effect.name in LAWS]
    name = " with ".join(law if one in LAWS else one for one in taken.names)
    return Taken(there.problem, there.fit, name, taken.odds, True)
