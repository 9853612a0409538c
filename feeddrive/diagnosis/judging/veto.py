"""Names are taken away again that their own evidence denies; what remains is refitted and judged anew.

An effect that the search took is not reported as found where

- a value of it ran to the end of what is physical: the end is no estimate;
- it does not lower the error on the judged data where its variable is as it was fitted (`where_fitted`); where they
  could hardly show it, or it lowers it by no more than the gain's scatter, the gain on blocks left out of the fit must
  be three times its scatter instead;
- the intervals of all its sizes hold the absent effect (no amplitude, a factor of one), or, where it says that a
  declared value is other, that value within its tolerance;
- with it friction would push the axis, which no plant file may hold, and without it not;
- a channel is predicted worse with what was found than as declared, by more than the scatter of its rms, and this
  effect worsens it most.

Declared values are asked first: no name goes for a channel that is as good with values fitted otherwise.

One name goes at a time, that with the least gain of those that are denied: of two that say the same the other may then
stand. So it may where the interval of one that carries holds none beside the other alone (`_instead`). An effect that
differs between the fitted recordings may be absent from the judged one, and is denied by the last alone. Where the
judged recording is known to differ in a level from the fitted ones (`judged_changes`), gain and worsening are asked
with that level allowed for. Where the plant as declared meets a channel as well as all that together, the level is no
excuse: worsening is then asked without it.

A name that takes the place of one that was not denied is not asked for its gain where the judged data do not tell the
two apart (`spared`): of two laws that predict the same there, a bound on each one's own gain would part them by luck.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, replace

import numpy as np

from feeddrive.diagnosis.calibration.stated import without_effects
from feeddrive.diagnosis.certainty.one_sided import is_told_by_slopes
from feeddrive.diagnosis.finding.attempt import with_short_blocks
from feeddrive.diagnosis.finding.refitting import at_rest, refitted
from feeddrive.diagnosis.finding.search import Search
from feeddrive.diagnosis.finding.sets import ITERATIONS
from feeddrive.diagnosis.judging.asked_of_fit import (
    AROUND_NONE,
    ends_reached,
    friction_that_pushes,
    sizes_around_none,
    values_within_tolerance,
)
from feeddrive.diagnosis.judging.judge import Judged, Share, share_beyond, share_of
from feeddrive.diagnosis.judging.where_fitted import unseen, where_fitted
from feeddrive.diagnosis.judging.worse import not_worse_than_declared, worse_by, worst_channel
from feeddrive.diagnosis.likelihood.coordinates import (
    read_coordinates,
    write_coordinates,
)
from feeddrive.diagnosis.likelihood.cross_validation import Comparison
from feeddrive.diagnosis.likelihood.evidence import UNSEEN
from feeddrive.diagnosis.likelihood.fit import fit, linear_step
from feeddrive.diagnosis.likelihood.standing import Standing, missed_by, regained
from feeddrive.diagnosis.likelihood.tolerances import SURE
from feeddrive.diagnosis.recordings.compared import JudgedChanges, judged_changes
from feeddrive.diagnosis.recordings.recordings import RecordingShift, without_shifts
from feeddrive.effects.base import Effect
from feeddrive.errors import InputError
from feeddrive.units.quantity import percent

CLEARLY_NEEDED = 0.1
"""Share of the squared error on judged data from which an effect is clearly needed: by one linear step, it is not
refitted without it, and no interval of a slope denies it."""


@dataclass(frozen=True)
class Denied:
    """An effect that is not reported, and why."""

    place: int
    gain: float
    reason: str


def without_denied(
    found: Search,
    judged: list[Judged],
    judge: Callable[[Search], list[Judged]],
    spared: Collection[str] = (),
) -> tuple[Search, list[Judged]]:
    """The search without the names that their own evidence denies, and its judged recordings.

    Args:
        found: what the search took.
        judged: recordings with the found effects in.
        judge: judges other effects.
        spared: names in the place of others that stood, which the judged data do not tell from those; none is denied
            for its gain.
    """
    while True:
        found, judged = not_worse_than_declared(found, judged, judge)  # no name is to go for what fitted values do
        if (denied := _first_denied(found, judged, spared)) is None:
            return found, judged
        effects = found.fit.effects
        gone = effects[denied.place]
        rest = _without_lost_shifts([effect for i, effect in enumerate(effects) if i != denied.place])
        still_named = any(effect.name == gone.name for effect in rest)
        reasons = found.denied if still_named else {**found.denied, gone.name: denied.reason}
        problem = without_effects(found.problem, [gone], rest)
        # the declared values were fitted beside what is gone; one step rarely takes them to where they are without it
        problem, fitted = at_rest(*refitted(problem, fit(problem, rest)))
        found = replace(found, problem=problem, fit=fitted, denied=reasons)
        judged = judge(found)


def _first_denied(found: Search, judged: Sequence[Judged], spared: Collection[str]) -> Denied | None:
    """The denied effect with the least gain on data not fitted; None where there is none."""
    effects, problem = found.fit.effects, found.problem
    named = range(len(without_shifts(effects)))
    if not named:
        return None
    shares = [_share(found, judged, i) for i in named]
    idle = ["" if effects[i].name in spared else _no_gain(found, i, share) for i, share in enumerate(shares)]
    worst = worst_channel(problem, judged)
    other = judged_changes(found, judged) if worst or any(idle) else None
    if other is not None and other.carries:
        # a recording in which the effect itself is another says nothing against it
        stands = [carries or moved for carries, moved in zip(other.carries, other.other, strict=True)]
        said = {change.effect: f"; {change.statement}" for change in reversed(other.stated)}
        idle = [
            "" if stood or not reason else f"{reason}{said.get(effects[i].name, '')}"
            for i, (reason, stood) in enumerate(zip(idle, stands, strict=True))
        ]
        if not worst or _brings_more(found, other, worst):
            worst = worst_channel(other.problem, other.allowed)
    at_end, around_none = ends_reached(problem, found.fit), sizes_around_none(problem, found.fit)
    as_declared = values_within_tolerance(problem, found.fit)
    pushing = friction_that_pushes(problem, effects)
    reasons = [at_end[i] or idle[i] or around_none[i] or as_declared[i] or pushing[i] for i in named]
    gains = [share.comparison.gain for share in shares]
    asked = [
        _instead(found, i, gains, shares[i].comparison)
        if shares[i].carries and reason == around_none[i]
        else Denied(i, gains[i], reason)
        for i, reason in enumerate(reasons)
        if reason and not _differs(effects, i)
    ]
    denied = [one for one in asked if one is not None]
    if worst and not denied:
        place = min(named, key=lambda i: shares[i].explains[worst])
        reason = f"with it {worst} is predicted worse than as declared on data not fitted, by more than its scatter"
        denied = [Denied(place, shares[place].comparison.gain, reason)]
    return min(denied, key=lambda one: one.gain, default=None)


def _brings_more(found: Search, other: JudgedChanges, name: str) -> bool:
    """Whether what differs in the judged recordings says of a channel what the plant as declared does not.

    It does where a named effect is itself another there. Else names and differences together have to meet the channel
    better than the plant as declared, which needs neither.
    """
    if any(target.meets(effect) for target in other.changes.targets for effect in without_shifts(found.fit.effects)):
        return True
    return worse_by(other.problem, other.allowed, name, than_after=True) > 0


def _instead(found: Search, place: int, gains: Sequence[float], judged: Comparison) -> Denied | None:
    """What goes for an effect that carries while its interval holds none: itself, or what makes that interval so wide.

    Of two that say the same either may go, and beside neither is the other told from none. That goes which data not
    fitted miss less. Where no other does, nothing goes if they are clear about it and no slope tells what is without
    it: bristles whose stiffness was known to a factor of three, beside widths of sign changes, took two thirds of the
    squared error, and a slope said that a stiffness without end lies within its interval.
    """
    effects = found.fit.effects
    less = [i for i in range(len(gains)) if gains[i] < gains[place] and not _differs(effects, i)]
    for other in sorted(less, key=lambda i: gains[i]):
        rest = tuple(effect for i, effect in enumerate(effects) if i != other)
        wide = regained(found.problem, rest)
        if not sizes_around_none(wide, fit(wide, rest, iterations=ITERATIONS))[place - (other < place)]:
            words = f"beside it {effects[place].name} is not told from none, which lowers the error more"
            return Denied(other, gains[other], words)
    stands = _is_clear(judged) and not is_told_by_slopes(found.problem, found.fit, place)
    return None if stands else Denied(place, gains[place], AROUND_NONE)


def _is_clear(comparison: Comparison) -> bool:
    return comparison.gain > max(CLEARLY_NEEDED, SURE * comparison.standard_error)


def _share(found: Search, judged: Sequence[Judged], place: int) -> Share:
    """What an effect explains where its variable is as it was fitted (`where_fitted`).

    Where that is much, the others are moved by one linear step only, not refitted.
    """
    problem, effects = found.problem, found.fit.effects
    there = where_fitted(problem, effects, judged, effects[place])
    if not there:
        return unseen(judged)
    judged = there
    rest = (*effects[:place], *effects[place + 1 :])
    if regained(problem, rest) is not problem:  # one step from samples that a free play predicts leads nowhere
        return share_of(problem, judged, effects, place)
    counts = [len(read_coordinates([effect], problem.plant)) for effect in effects]
    columns = slice(sum(counts[:place]), sum(counts[: place + 1]))
    step = linear_step(np.delete(found.fit.jacobian, columns, axis=1), problem.residual(rest))
    moved = write_coordinates(rest, problem.plant, np.delete(found.fit.coordinates, columns) + step)
    try:
        share = share_beyond(problem, judged, moved)
    except InputError:  # one step may lead to a plant that cannot be simulated
        return share_of(problem, judged, effects, place)
    return share if _is_clear(share.comparison) else share_of(problem, judged, effects, place)


def _without_lost_shifts(effects: Sequence[Effect]) -> tuple[Effect, ...]:
    """The effects without differences of recordings that belong to none of them."""
    machine = without_shifts(effects)
    return tuple(
        effect
        for effect in effects
        if not isinstance(effect, RecordingShift) or any(effect.target.meets(one) for one in machine)
    )


def _differs(effects: Sequence[Effect], place: int) -> bool:
    return any(isinstance(one, RecordingShift) and one.target.meets(effects[place]) for one in effects)


def _no_gain(found: Search, place: int, share: Share) -> str:
    """Why data not fitted deny an effect; empty where they do not."""
    comparison = share.comparison
    if share.carries:
        return ""
    if share.shows and not share.is_open:
        scatter = max(comparison.standard_error, comparison.least)
        gain = percent(comparison.gain, 2)
        return f"on the judged data it lowers the squared error by {gain}, scatter {percent(scatter, 2)}"
    inside, levelled = _left_out_gains(found, place)
    if any(one.gain > SURE * one.standard_error for one in (inside, *levelled)):
        return ""
    if share.size < UNSEEN:  # no judged sample meets it: it may be a passage shorter than a block, which its parts tell
        parts, _ = _left_out_gains(replace(found, problem=with_short_blocks(found.problem)), place)
        if parts.gain > max(parts.least, SURE * parts.standard_error):
            return ""
    return (
        f"the judged data hardly show it, and on blocks left out of the fit it lowers the squared error by "
        f"{percent(inside.gain, 2)}, scatter {percent(inside.standard_error, 2)}"
    )


def _left_out_gains(found: Search, place: int) -> tuple[Comparison, list[Comparison]]:
    """What an effect brings on blocks left out of the fit, the others refitted without it.

    Where it lowers the error at all, the comparison with every block over its own level is beside it: a block that
    alone goes to one end of the stroke is missed by far where it is left out, and makes the scatter of all.
    """
    problem, effects = found.problem, found.fit.effects
    rest = [*effects[:place], *effects[place + 1 :]]
    wide = regained(problem, rest)
    missed = missed_by(Standing(wide, fit(wide, rest, iterations=2)), Standing(problem, found.fit))
    gain = missed.gain
    return gain, [missed.levelled_gain] if gain.gain > gain.least else []
