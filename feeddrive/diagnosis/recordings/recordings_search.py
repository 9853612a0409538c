"""The search over several recordings: what the plant lacks in all of them, and what differs from one to the next.

A level that is other in one recording looks, to effects held in common, like a handful of effects that are not there;
and an effect that is not yet found looks, in recordings of other motions, like levels that differ. So both orders are
followed: differences first, held while the effects are searched; and effects first, the differences asked after them.
In either the differences are asked again with the effects in, and effects that then no longer pay are dropped. The
second order is spared where the first leaves no more than noise, or ends with the differences that it held. What one
recording alone shows is asked of it alone, where more of it is left than of another.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from feeddrive.diagnosis.calibration.calibrate import recalibrated
from feeddrive.diagnosis.calibration.value_slopes import with_new_slopes
from feeddrive.diagnosis.finding.attempt import with_predictable
from feeddrive.diagnosis.finding.members import member, members_of
from feeddrive.diagnosis.finding.search import Search, search
from feeddrive.diagnosis.finding.sets import needed_members
from feeddrive.diagnosis.likelihood.evidence import Evidence
from feeddrive.diagnosis.likelihood.fit import Fit, fit
from feeddrive.diagnosis.likelihood.problem import UNEXPLAINED, Problem
from feeddrive.diagnosis.likelihood.standing import Standing, odds_between, same_samples
from feeddrive.diagnosis.recordings.change_candidates import levels
from feeddrive.diagnosis.recordings.change_words import FACTORS
from feeddrive.diagnosis.recordings.changes import Changes, find_changes
from feeddrive.diagnosis.recordings.recordings import (
    RecordingPredictor,
    RecordingShift,
    in_recording,
    is_shift,
    shift_of,
    without_shifts,
)
from feeddrive.effects.base import Effect, listed, number

SAME = 0.01
"""Relative difference of squared errors that counts as none."""

EXPLAINED = "what was found earlier, and what differs, leave no more than noise: it was not searched"
"""Why an effect was not tried that is not among those found earlier."""

TURNED = 2
"""Steps of a fit that begins where another one of the same machine has ended."""

LEAST_FACTOR = 0.3
"""Least factor on declared friction or stiffness that is believed with no effect found yet; its inverse is the most."""


@dataclass(frozen=True)
class Searched:
    """A search over recordings.

    Attributes:
        search: with the effects as they are in the last recording, then the shifts of the earlier ones.
        changes: what differs between the fitted recordings; None where there is one recording.
    """

    search: Search
    changes: Changes | None


def search_recordings(
    problem: Problem,
    progress: Callable[[str], None] = lambda text: None,
    start: Sequence[Effect] = (),
    done: Search | None = None,
) -> Searched:
    """Find the effects that the plant lacks, and the parameters that differ between the recordings.

    Args:
        problem: declared plant and recordings; the last one is the machine as it is now.
        progress: called with a line that says what is going on.
        start: effects found earlier; they are asked again with all recordings before others are searched.
        done: a search of one recording, without such effects, that was made to its end.
    """
    if start:
        problem = numbered(problem)
        continued = _continued(problem, start, progress)
        kept = members_of(continued.search.fit.effects)
        if _explained(continued) or all(member(effect) in kept for effect in start):
            return _with_effects_of_one(problem, continued, progress) if len(problem.evidence) > 1 else continued
        return _better(continued, search_recordings(problem, progress))
    if len(problem.evidence) < 2:
        return Searched(normalised(done or search(problem, progress)), None)
    problem = numbered(problem)
    earlier = range(len(problem.evidence) - 1)
    progress("comparing the recordings")
    held = find_changes(problem, (), earlier)
    best = _followed(problem, held if _plausible(held) else _nothing(problem), earlier, progress)
    assert best.changes is not None
    confirmed = _levels_of(problem, best.changes) == (_levels_of(problem, held) if _plausible(held) else set())
    if not (confirmed or _explained(best) or problem.budget.skips("effects first, and then what differs")):
        nothing = _nothing(problem)
        other = nothing if _plausible(held) and held.targets else _levels_alone(problem, best.changes, earlier)
        best = _better(best, _followed(problem, other, earlier, progress))
    return _with_effects_of_one(problem, best, progress)


def _with_effects_of_one(problem: Problem, best: Searched, progress: Callable[[str], None]) -> Searched:
    """The search, or one with effects that the recording of which most is left shows by itself, where that is better.

    An effect that one recording alone has is worse than none in the others: asked of all in common it does not pay.
    Each recording is asked once, as long as one brings more.
    """
    asked: list[Evidence] = []
    while (apart := _left_most(best.search)) is not None and apart.recording not in [one.recording for one in asked]:
        if problem.budget.skips("effects of one recording alone"):
            break
        asked.append(apart)
        progress(f"searching {apart.recording.name} alone")
        found = without_shifts(best.search.fit.effects)
        alone = search(replace(problem, evidence=(apart,)), progress).fit.effects
        more = [effect for effect in alone if member(effect) not in members_of(found)]
        of_last = apart.recording is problem.evidence[-1].recording
        other = _better(best, _continued(problem, (*found, *more), progress, of_last)) if more else best
        if other is best:
            break
        best = other
    return best


def _left_most(found: Search) -> Evidence | None:
    """The recording of which most is left over its noise, where that is more than the level of another is known to.

    Channels are asked apart: a late torque is of the torque alone.
    """
    squares = found.problem.settled(found.fit.effects).plain_squares(found.fit.effects)
    least = {name: max(min(one.get(name, math.inf) for one in squares), 1.0) for one in squares for name in one}
    over = [max((square / least[name] for name, square in one.items()), default=0.0) for one in squares]
    worst = int(np.argmax(over))
    return found.problem.evidence[worst] if over[worst] > UNEXPLAINED else None


def _followed(problem: Problem, held: Changes, earlier: Sequence[int], progress: Callable[[str], None]) -> Searched:
    """Effects searched while some differences are held; then all differences, and the effects that still pay."""
    found = normalised(_searched(problem, held, progress))
    progress("comparing the recordings with the effects found")
    changes = find_changes(found.problem, found.fit.effects, earlier)
    if changes.targets:
        # the other declared values as they are most likely beside what differs
        needed = _still_needed(changes.problem, changes.fit)
        again = recalibrated(needed.problem, needed.fit.effects)
        changes = replace(changes, problem=again, fit=fit(again, needed.fit.effects))
    return Searched(replace(found, problem=changes.problem, fit=changes.fit), changes)


def _continued(
    problem: Problem, start: Sequence[Effect], progress: Callable[[str], None], of_last: bool = False
) -> Searched:
    """The effects found earlier, those that still pay; then what else is lacking, and what differs.

    They are those of the machine before: what differs is asked of the last recording, with these values held. Where
    they are those of the machine as it is in the last recording (`of_last`), it is asked of the others.
    """
    progress("asking again for the effects found earlier")
    last, predictable = len(problem.evidence) - 1, with_predictable(problem, start)
    if of_last:
        again = find_changes(predictable, start, range(last))
    else:
        again = _as_last(find_changes(predictable, start, [last] if last else []), last)
    if last > 1 and again.problem.plain_error(again.fit.effects) > UNEXPLAINED:  # those before differ as well
        again = find_changes(again.problem, without_shifts(again.fit.effects), range(last))
    needed = _still_needed(again.problem, again.fit)
    again = replace(again, problem=needed.problem, fit=needed.fit)
    if again.problem.plain_error(again.fit.effects) < UNEXPLAINED:
        every = dict.fromkeys((one.name for one in problem.predictor.candidates), EXPLAINED)
        return Searched(Search(again.problem, again.fit, (), (), {}, denied=every), again)
    more = _searched(needed.problem, again, progress)
    if not more.fit.effects:
        return Searched(replace(more, problem=again.problem, fit=again.fit), again)
    effects = (*without_shifts(again.fit.effects), *more.fit.effects)
    changes = find_changes(more.problem, effects, range(last))
    needed = _still_needed(changes.problem, fit(changes.problem, changes.fit.effects))
    changes = replace(changes, problem=needed.problem, fit=needed.fit)
    return Searched(replace(more, problem=changes.problem, fit=changes.fit), changes)


def _as_last(changes: Changes, last: int) -> Changes:
    """What differs in the last recording, as what differs in all others from the machine as it is in the last."""
    if not changes.targets:
        return changes
    problem, effects = changes.problem, changes.fit.effects
    back = [
        shift_of(one.target, number, len(listed(one.values["shift"]))).with_values(
            shift=tuple(-by for by in listed(one.values["shift"]))
        )
        for one in effects
        if isinstance(one, RecordingShift)
        for number in range(last)
    ]
    turned = fit(problem, [*in_recording(effects, problem.plant, last), *back], iterations=TURNED)
    return replace(changes, fit=turned)


def _still_needed(problem: Problem, found: Fit) -> Standing:
    """The set without effects that no longer pay; what differs by recording stays, and what it belongs to."""
    shifts = [effect for effect in found.effects if isinstance(effect, RecordingShift)]

    def may_go(effect: Effect) -> bool:
        return not is_shift(effect) and not any(shift.target.meets(effect) for shift in shifts)

    return needed_members(problem, found, may_go)


def _better(first: Searched, second: Searched) -> Searched:
    """The one with the lower error at the same samples; the one with fewer unknowns where that is a tie.

    Where they predict different samples, the likelier.
    """
    left = first.search.problem.evidence[0].left
    a, b = (_weighed(one.search, left) for one in (first, second))
    if not same_samples(a.problem, b.problem):
        return second if odds_between(a, b, len(a.problem.predictor.candidates)) > 0 else first
    errors = [one.fit.squared_error / len(one.fit.residual) for one in (a, b)]
    if abs(errors[0] - errors[1]) > SAME * min(errors):
        return first if errors[0] < errors[1] else second
    return min((first, second), key=lambda one: len(one.search.fit.coordinates))


def _weighed(found: Search, left: dict[str, float]) -> Standing:
    """A set that was found, its channels weighed as those of another."""
    problem = found.problem.weighed(left)
    return Standing(problem, found.fit if problem is found.problem else fit(problem, found.fit.effects, iterations=0))


def _explained(one: Searched) -> bool:
    return one.search.problem.plain_error(one.search.fit.effects) < UNEXPLAINED


def _nothing(problem: Problem) -> Changes:
    return Changes(problem, fit(problem, (), iterations=0), (), ())


def _plausible(held: Changes) -> bool:
    """Whether factors of what differs are such as a machine has; others stand for an effect that is not found yet."""
    factors = [effect.values.get(key, 1.0) for effect in held.fit.effects for key in FACTORS]
    return all(LEAST_FACTOR <= float(f) <= 1 / LEAST_FACTOR for f in factors if isinstance(f, float))


def numbered(problem: Problem, more: Sequence[Evidence] = ()) -> Problem:
    """The problem with its recordings numbered in their order, and further ones after them."""
    inner = problem.predictor
    inner = inner.inner if isinstance(inner, RecordingPredictor) else inner
    everything = (*problem.evidence, *more)
    numbers = {evidence.recording: number for number, evidence in enumerate(everything)}
    return replace(problem, predictor=RecordingPredictor(inner, numbers))


def _searched(problem: Problem, held: Changes, progress: Callable[[str], None]) -> Search:
    """The search on the declared plant with what differs held; its result on the declared plant."""
    if not held.fit.effects:
        return search(problem, progress)
    nuisance = problem.plant.with_effects(*held.fit.effects)
    found = search(replace(problem, plant=nuisance), progress)
    declared = with_new_slopes(replace(found.problem, plant=problem.plant), found.fit.effects)
    return replace(found, problem=declared, fit=fit(declared, found.fit.effects, iterations=0))


def _levels_of(problem: Problem, changes: Changes) -> set[tuple[str, str]]:
    """Names and ports of those differences that need no effect to be found first."""
    known = {(effect.name, effect.port) for effect in levels(problem, ())}
    return {(t.name, t.port) for t in changes.targets if (t.name, t.port) in known}


def _levels_alone(problem: Problem, changes: Changes, earlier: Sequence[int]) -> Changes:
    """What differs of the levels, fitted with nothing found."""
    wanted = [target for target in changes.targets if _levels_of(problem, replace(changes, targets=(target,)))]
    if not wanted:
        return _nothing(problem)
    kept = [
        effect
        for effect in changes.fit.effects
        if (effect.target in wanted if isinstance(effect, RecordingShift) else any(t.meets(effect) for t in wanted))
    ]
    return Changes(problem, fit(problem, kept), tuple(wanted), ())


def normalised(found: Search) -> Search:
    """The search with tabulated drifts scaled; the same drift, its fit taken again where it stands."""
    effects = [_scaled(effect) for effect in found.fit.effects]
    if tuple(effects) == found.fit.effects:
        return found
    return replace(found, fit=fit(found.problem, effects, iterations=0))


def _scaled(effect: Effect) -> Effect:
    if effect.name != "ambient_drift" or not isinstance(effect.values["time"], tuple):
        return effect
    shape = listed(effect.values["shape"])
    largest = max(shape, key=abs)
    if largest == 0:
        return effect
    amplitude = number(effect.values["amplitude"]) * largest
    return effect.with_values(amplitude=amplitude, shape=tuple(s / largest for s in shape))
