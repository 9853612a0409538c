"""The search: from set to set of effects by their evidence, until no set near the last one is likelier.

Every round starts each candidate from values read off the residual of the set at hand, and fits those that promise a
fair part of the best. Sets near the one at hand are compared on these slopes (`sets`); the likeliest few are fitted,
all effects together, and the likeliest of them is taken if what it adds also lowers the error on blocks left out.
"""

from __future__ import annotations

from collections.abc import Callable, Container, Iterable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from feeddrive.diagnosis.calibration.beyond import beyond_tolerance, fitted_together, without_effects
from feeddrive.diagnosis.calibration.calibrate import (
    at_declared,
    calibrated,
    of_hours,
    recalibrated,
    recalibrated_by_rest,
    with_new_slopes,
)
from feeddrive.diagnosis.calibration.known import TOLERANCE
from feeddrive.diagnosis.certainty.one_sided import with_usual_sizes
from feeddrive.diagnosis.finding.attempt import JOINT_ITERATIONS, Attempt, compared, refuse_of_no_hours, started
from feeddrive.diagnosis.finding.materiality import is_material
from feeddrive.diagnosis.finding.open_map import likeliest_curve, log_odds_of_curves, log_odds_of_map, with_curves_of
from feeddrive.diagnosis.finding.round import Round, one_round
from feeddrive.diagnosis.finding.scene import scene_of
from feeddrive.diagnosis.finding.sets import Neighbour, neighbours
from feeddrive.diagnosis.finding.spring_law import LAWS, play_from_declared, soft_everywhere, with_likelier_law
from feeddrive.diagnosis.heat.heat_candidates import is_another
from feeddrive.diagnosis.judging.result import Trial
from feeddrive.diagnosis.likelihood.coordinates import write_coordinates
from feeddrive.diagnosis.likelihood.fit import LEVEL, UNEXPLAINED, Fit, Problem, fit
from feeddrive.diagnosis.likelihood.law_curve import has_curve
from feeddrive.diagnosis.likelihood.predictability import has_play
from feeddrive.diagnosis.likelihood.set_evidence import (
    Standing,
    gain_between,
    log_odds,
    odds_between,
    regained,
    same_samples,
)
from feeddrive.effects.base import Effect
from feeddrive.effects.transmission.backlash import Backlash
from feeddrive.errors import InputError

MOST_ROUNDS = 12
"""Sets gone through at most; an axis that lacks more needs another declaration."""

FITTED = 2
"""Sets one move away that are fitted in a round, and one two moves away where slopes say that it is likelier: starts
are near by design, so that slopes put the likeliest among the first."""


SMALL = "the recordings show it, and it is too small to matter on this machine"
"""Why an effect is not reported that the search met beside the others."""


ANOTHER = "its values have run to where it is another effect"
"""Why an effect is not searched further."""


@dataclass(frozen=True)
class Search:
    """What the search found, and everything that it tried.

    Attributes:
        problem: recordings with the samples that the effects found can predict.
        fit: of the effects found.
        trials: every candidate of every round.
        rounds: the same as fitted, the best first.
        impossible: candidate to why the recordings cannot show it.
        near: effects that may come beside those found, the likeliest first.
        begun: problem and fit that the search began with; None for one that is made of a fit.
        asked: what was asked of the judged recordings beside it and beside sets made of it (`recordings.compared`).
    """

    problem: Problem
    fit: Fit
    trials: tuple[Trial, ...]
    rounds: tuple[tuple[Attempt, ...], ...]
    impossible: dict[str, str]
    near: tuple[Near, ...] = ()
    begun: tuple[Problem, Fit] | None = None
    asked: list[Any] = field(default_factory=list, compare=False)


@dataclass(frozen=True)
class Near:
    """An effect that was not taken: logarithm of the odds for it, and the part that grows with the time recorded."""

    name: str
    gain: float
    speaks: float


@dataclass(frozen=True)
class _Taken(Standing):
    """A likelier set: its recordings and fit, what was added, by how much it is likelier, and whether its law is."""

    name: str
    odds: float
    of_law: bool = False


def search(
    problem: Problem, progress: Callable[[str], None] = lambda text: None, start: Search | None = None
) -> Search:  # fmt: skip
    """Find the effects that the declared plant lacks.

    Args:
        problem: declared plant and recordings.
        progress: called with a line that says what is going on.
        start: a search to go on from, without the names that it says are impossible.

    Returns:
        The effects found, fitted together, and the ledger of the search.
    """
    progress("fitting declared values within their tolerances")
    problem = calibrated(problem)
    found = fit(problem, start.fit.effects if start is not None else ())
    begun = (problem, found) if start is None or start.begun is None else start.begun
    problem, found = _balanced(problem, found)
    trials: list[Trial] = [*start.trials] if start is not None else []
    rounds: list[tuple[Attempt, ...]] = [*start.rounds] if start is not None else []
    denied = {**start.impossible} if start is not None else {}
    impossible: dict[str, str] = {**denied}
    met: set[tuple[tuple[str, str, str], ...]] = set()
    near: tuple[Near, ...] = ()
    while len(rounds) < MOST_ROUNDS and not (rounds and problem.budget.skips("further rounds of the search")):
        progress(f"round {len(rounds) + 1}: {len(found.effects)} effects so far")
        now, taken, near = _asked(problem, found, impossible, denied, len(rounds) + 1)
        of_map = log_odds_of_map(problem, found, now.count)
        if of_map > max(taken.odds if taken is not None else 0.0, 0.0):  # no name says it: it is not to look like one
            problem = replace(problem, evidence=tuple(e.with_map(True) for e in problem.evidence))
            problem, found = _refitted(problem, fit(problem, found.effects))
            continue
        curved = None if taken is None else _of_another_form(taken, now.count)
        if curved is not None:  # a law of another form says it: no second name
            problem, found = _refitted(*curved)
            continue
        after = None if taken is None else _refitted(*_with_taken(taken, found))
        begin = _begun_as_declared(problem, found)
        if begin is not None:
            again, its, beside = _asked(*begin, impossible, denied, len(rounds) + 1)
            there = None if its is None else _refitted(*_with_taken(its, begin[1]))
            here = (problem, found) if after is None else after
            if there is not None and odds_between(Standing(*here), Standing(*there), now.count) > 0:
                now, taken, near, after = again, its, beside, there
        rounds.append(tuple(attempt.for_the_record() for attempt in now.attempts))
        names = taken.name.split(" with ") if taken is not None else []
        trials += [_trial(len(rounds), attempt, attempt.name in names) for attempt in rounds[-1]]
        others = [effect for effect in found.effects if is_another(effect)] if taken is None else []
        others += soft_everywhere(problem, found) if taken is None else []
        if others:  # the search goes on with the name that the law has run to
            denied |= dict.fromkeys((effect.name for effect in others), ANOTHER)
            impossible |= denied
            rest = [one for one in found.effects if not any(one is other for other in others)]
            problem, found = _refitted(problem, fit(problem, rest))
        if after is not None:
            problem, found = after
            progress(f"found so far: {', '.join(effect.name for effect in found.effects)}")
            if _members(found) not in met:
                met.add(_members(found))
                continue
        # nothing likelier is near, or what was met: sets that only take each other's place, or one met beside others
        left_out = problem.budget.skips("declared values beyond their tolerances")
        beyond = None if left_out else _with_value_beyond(problem, found)
        if beyond is not None and _members(beyond[1]) not in met:
            met |= {_members(found), _members(beyond[1])}
            problem, found = beyond
            trials.append(Trial(len(rounds), found.effects[-1].name, 0.0, 0.0, True))
        elif not others:
            break
    problem, found = _where_friction_brakes(*_refitted(problem, fit(problem, found.effects)))
    closed = with_curves_of(problem, ())  # names are weighed, and rivals tried, against all that is left
    if closed is not problem:
        problem, found = closed, fit(closed, found.effects, iterations=JOINT_ITERATIONS)
    small = [one for one in found.effects if not is_material(one, problem.plant)]
    if small:
        rest = [one for one in found.effects if not any(one is other for other in small)]
        problem = without_effects(problem, small, rest)
        found = fit(problem, rest)
        impossible |= dict.fromkeys((one.name for one in small), SMALL)
    found = with_usual_sizes(problem, found)
    return Search(problem, found, tuple(trials), tuple(rounds), impossible, near, begun)


def _members(found: Fit) -> tuple[tuple[str, str, str], ...]:
    """Names of a set and where they act."""
    return tuple(sorted((effect.name, str(effect.port), effect.place) for effect in found.effects))


def _asked(
    problem: Problem, found: Fit, impossible: dict[str, str], denied: dict[str, str], number: int
) -> tuple[Round, _Taken | None, tuple[Near, ...]]:
    """A round beside a set, the likeliest set near it, None where none is likelier, and what comes near beside it."""
    now = one_round(scene_of(problem, found.effects), found, impossible, denied, number)
    taken, near = _likelier(problem, found, now, denied)
    if taken is None and Backlash.name not in denied:
        taken = _with_play(problem, found, now.count)
    return now, _of_likelier_law(taken, now.count, denied), near


def _of_another_form(taken: _Taken, count: int) -> tuple[Problem, Fit] | None:
    """A likelier set without one of the names that it adds, where the curve of another of its laws is likelier.

    The law and its curve must leave what counts as noise (`LEVEL`): where more is left, more than a form is missing.
    """
    effects, added = taken.fit.effects, len(taken.name.split(" with ")) if taken.name else 0
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


def _level(problem: Problem, found: Fit) -> float:
    """Weighted squared error per row, of the channel that is met worst by its noise."""
    left = max((value for e in problem.evidence for value in e.left.values()), default=1.0)
    return left**2 * found.squared_error / max(len(found.residual), 1)


def _with_play(problem: Problem, found: Fit, count: int) -> _Taken | None:
    """A likelier set with free play that hides beside the fitted values; None where nothing is left that it may say."""
    if problem.calibration is None or of_hours(problem) or problem.plain_error(found.effects) < UNEXPLAINED:
        return None
    there = play_from_declared(problem, found)
    odds = odds_between(Standing(problem, found), there, count) if there is not None else 0.0
    return _Taken(there.problem, there.fit, Backlash.name, odds) if there is not None and odds > 0 else None


def _with_taken(taken: _Taken, found: Fit) -> tuple[Problem, Fit]:
    problem = without_effects(taken.problem, found.effects, taken.fit.effects)
    return with_curves_of(problem, taken.fit.effects), taken.fit


def _begun_as_declared(problem: Problem, found: Fit) -> tuple[Problem, Fit] | None:
    """A set beside the values as declared, where one has gone beyond its tolerance and much is left; else None.

    Such values stand in for what is missing, which hides beside them. Or one of them is beyond its tolerance, and then
    all that is missing beside the declared ones is that: so both are asked, and the likelier goes on.
    """
    known = problem.calibration
    if known is None or of_hours(problem) or np.max(np.abs(known.coordinates), initial=0.0) <= TOLERANCE:
        return None
    if problem.plain_error(found.effects) < UNEXPLAINED or problem.budget.skips("rounds beside the declared values"):
        return None
    there = with_new_slopes(at_declared(problem), found.effects)
    return there, fit(there, found.effects, iterations=JOINT_ITERATIONS)


def _likelier(
    problem: Problem, found: Fit, now: Round, denied: Container[str]
) -> tuple[_Taken | None, tuple[Near, ...]]:
    """The likeliest of the sets near one, fitted, None where none is likelier; and what comes near beside it."""
    here = [attempt for attempt in now.attempts if same_samples(attempt.problem, problem)]
    sets = neighbours(problem, found, here, now.count)
    able = [one for one in sets if one.gain > 0]
    chosen = [one for one in able if one.is_next][:FITTED] + [one for one in able[:1] if not one.is_next]
    at_hand = Standing(problem, found)
    tried: list[_Taken | None] = []
    for one in chosen:  # the likeliest in any case
        if not tried or not problem.budget.skips("sets of effects that came near"):
            tried.append(_fitted(at_hand, one, here, now.count, denied))
    for attempt in now.attempts:
        if not same_samples(attempt.problem, problem):  # some samples tell less of it: compared on the others
            there = fit(attempt.problem, found.effects, iterations=0)
            away = neighbours(attempt.problem, there, [attempt], now.count)
            tried += [
                _fitted(at_hand, one, [attempt], now.count, denied) for one in away[:1] if one.gain > 0 and one.added
            ]
    best = _best((one for one in tried if one is not None and one.odds > 0), now.count)
    beside = [one for one in sets if not one.dropped and len(one.added) == 1 and one.speaks > 0]
    return best, tuple(Near(here[one.added[0]].name, one.gain, one.speaks) for one in beside)


def _of_likelier_law(taken: _Taken | None, count: int, denied: Container[str]) -> _Taken | None:
    """A likelier set with the likelier of free play and lost preload, where it adds one of them."""
    names = taken.name.split(" with ") if taken is not None else []
    if taken is None or taken.of_law or not any(name in LAWS for name in names):
        return taken
    there = with_likelier_law(taken.problem, taken.fit, count, denied)
    if there is None:
        return taken
    (law,) = [effect.name for effect in there.fit.effects if effect.name in LAWS]
    name = " with ".join(law if one in LAWS else one for one in names)
    return _Taken(there.problem, there.fit, name, taken.odds, True)


def _best(likelier: Iterable[_Taken], count: int) -> _Taken | None:
    """The likeliest of sets, compared with each other: all may be far ahead of the set at hand."""
    best: _Taken | None = None
    for one in sorted(likelier, key=lambda one: len(one.fit.coordinates)):
        if best is None or (odds_between(best, one, count) if _as_curved(best, one) else one.odds - best.odds) > 0:
            best = one
    return best


def _as_curved(one: Standing, other: Standing) -> bool:
    """Whether the same laws' curves are open in two problems."""
    pairs = zip(one.problem.evidence, other.problem.evidence, strict=True)
    return all(mine.curves.keys() == its.curves.keys() for mine, its in pairs)


def _fitted(
    at_hand: Standing, one: Neighbour, attempts: Sequence[Attempt], count: int, denied: Container[str]
) -> _Taken | None:
    """A set fitted; None where it cannot be simulated, or what it adds does not pay on blocks left out.

    A law of the nut's spring that does not pay is asked once more from the declared values on: those fitted without it
    stand in for it.
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
        nearest = min((start for start in starts if start), key=lambda start: _error(own, start), default=[])
        result = fit(own, nearest, iterations=JOINT_ITERATIONS)
        again = regained(own, result.effects)
        if again is not own:  # what the play could not predict is to be predicted again
            own, result = again, fit(again, result.effects, iterations=JOINT_ITERATIONS)
        refuse_of_no_hours(own, result.effects)
        taken = _Taken(own, result, name, _odds(at_hand, Standing(own, result), count))
        if not one.added or one.dropped or compared(own, name, result, found.effects).comparison.pays:
            return taken
        anew = _of_likelier_law(taken, count, denied)
        if anew is None or anew is taken or not gain_between(at_hand, anew).pays:
            return None
        return replace(anew, odds=odds_between(at_hand, anew, count))
    except InputError:
        return None


def _odds(at_hand: Standing, there: Standing, count: int) -> float:
    """Logarithm of the odds for a set against the one at hand; a law that goes takes its curve with it."""
    closed = with_curves_of(at_hand.problem, there.fit.effects)
    if closed is at_hand.problem:
        return odds_between(at_hand, there, count)
    bare = Standing(closed, fit(closed, at_hand.fit.effects, iterations=JOINT_ITERATIONS))
    return odds_between(bare, there, count) - log_odds_of_curves(closed, bare.fit, count, at_hand.problem)


def _restarted(problem: Problem, kept: Sequence[Effect], first: Attempt, second: Attempt) -> list[Effect]:
    """One of two effects fitted, and the other started anew at what is left: alone each began at what both leave.

    Empty where the second has no start there.
    """
    before = fit(problem, [*kept, first.fit.effects[-1]], iterations=JOINT_ITERATIONS)
    (candidate,) = [one for one in problem.predictor.candidates if one.name == second.name]
    anew = started(scene_of(problem, before.effects), candidate)
    if not anew:
        return []
    best = min(anew, key=lambda attempt: attempt.fit.squared_error).fit
    return [*before.effects, *write_coordinates(best.effects[-1:], problem.plant, best.coordinates)]


def _error(problem: Problem, effects: Sequence[Effect]) -> float:
    return fit(problem, effects, error_only=True).squared_error


def _refitted(problem: Problem, found: Fit) -> tuple[Problem, Fit]:
    """Declared values and effects fitted in turn, with new slopes of the values.

    Values gone beyond their tolerances may have stood in for what was missing: they begin as declared as well.
    """
    if problem.calibration is None:
        return _balanced(problem, found if not found.held else fit(problem, found.effects, iterations=0))
    there = recalibrated_by_rest(problem, found.effects)
    result = there, fit(there, found.effects, iterations=JOINT_ITERATIONS)
    assert there.calibration is not None
    # That of hours has begun as declared, and other weights are no lower error.
    if not of_hours(there) and np.max(np.abs(there.calibration.coordinates), initial=0.0) > TOLERANCE:
        anew = recalibrated(at_declared(problem), found.effects)
        other = anew, fit(anew, found.effects, iterations=JOINT_ITERATIONS)
        result = min(result, other, key=lambda one: one[1].squared_error)
    return _balanced(*result)


def _where_friction_brakes(problem: Problem, found: Fit) -> tuple[Problem, Fit]:
    """A set beside values with which friction takes power; begun as declared where it would push the axis.

    A drag that stood in for what a name now takes leaves nothing to take it from, and steps stay where friction takes
    power only from where it does.
    """
    if problem.calibration is None or of_hours(problem) or problem.possible(found.effects):
        return problem, found
    there, effects = fitted_together(at_declared(problem), found.effects)
    return there, fit(there, effects)


def _balanced(problem: Problem, found: Fit) -> tuple[Problem, Fit]:
    """Each channel weighed by what is left of it, and the set fitted so."""
    if of_hours(problem):
        return problem, found
    for _ in range(JOINT_ITERATIONS):
        there = problem.balanced(found.effects)
        if there is problem:
            break
        problem, found = there, fit(there, found.effects, iterations=JOINT_ITERATIONS)
    return problem, found


def _with_value_beyond(problem: Problem, found: Fit) -> tuple[Problem, Fit] | None:
    """A set with the declared value as an effect that is beyond its tolerance; None where none is.

    Free of its tolerance a value can only lower the error. Where it does not, slopes alone said so: beside a free play
    a step of a value moves the contacts, and what the slope then tells holds for that step.
    """
    beyond = beyond_tolerance(problem, found)
    if beyond is None:
        return None
    freed, effect = beyond
    there, result = _refitted(freed, fit(freed, (*found.effects, effect)))
    alike = there.weighed(problem.evidence[0].left)
    error = (result if alike is there else fit(alike, result.effects, iterations=0)).squared_error
    return (there, result) if error < found.squared_error else None


def _trial(number: int, attempt: Attempt, taken: bool) -> Trial:
    return Trial(number, attempt.name, attempt.comparison.gain, attempt.comparison.standard_error, taken)
