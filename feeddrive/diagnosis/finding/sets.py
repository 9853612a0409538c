"""Sets of effects near the one at hand, compared by their evidence on one shared Jacobian, nothing being simulated.

Effects are added, dropped and swapped, two moves deep on a beam, so that two effects that hide each other, or that
together look like a third, are met as any other set. What a set is worth the products of its columns tell (`columns`).
The best are fitted exactly by the search.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

from feeddrive.diagnosis.finding.attempt import Attempt
from feeddrive.diagnosis.finding.columns import Columns, Neighbour
from feeddrive.diagnosis.likelihood.fit import Fit, fit
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.likelihood.set_evidence import log_prior_of_size
from feeddrive.diagnosis.likelihood.standing import Standing, odds_between, regained
from feeddrive.diagnosis.motion.predictability import has_play
from feeddrive.effects.base import Effect

BEAM = 12
"""Sets from which the next move is tried; those beyond are hundreds of nats behind where anything is decided."""

ITERATIONS = 6
"""Steps of a fit without one member."""

SURE = 20.0
"""Logarithm of the odds, as slopes tell them, from which a member is not asked again with the others refitted."""


def neighbours(problem: Problem, found: Fit, attempts: Sequence[Attempt], count: int) -> list[Neighbour]:
    """The sets near the one found, the likeliest first.

    Args:
        problem: recordings.
        found: a set, all its effects free.
        attempts: effects that may be added, fitted to the samples of `problem` while the set stayed as it is.
        count: candidates and starts that were tried.
    """
    columns = Columns(problem, found, attempts, count)
    nothing = Neighbour((), (), 0.0)
    known: dict[tuple[tuple[int, ...], tuple[int, ...]], Neighbour] = {((), ()): nothing}
    beam, near = [nothing], list[Neighbour]()
    for _ in range(2):
        fresh = []
        for one in beam:
            for dropped, added in _moves(one, found, attempts):
                if (dropped, added) not in known:
                    known[dropped, added] = columns.weighed(dropped, added)
                    fresh.append(known[dropped, added])
        if not near:  # an effect that makes the colour at hand is told from it by what it leaves alone
            fresh = [columns.weighed_closely(one) for one in fresh]
        beam = sorted(fresh, key=lambda one: -one.gain)[:BEAM]
        near += beam
    return sorted((one if one.effects else columns.weighed_closely(one) for one in near), key=lambda one: -one.gain)


def _moves(
    one: Neighbour, found: Fit, attempts: Sequence[Attempt]
) -> Iterator[tuple[tuple[int, ...], tuple[int, ...]]]:
    """Effects added, dropped and swapped from a set: places of members out, numbers of attempts in."""
    rest = [place for place in range(len(found.effects)) if place not in one.dropped]
    able = [i for i in range(len(attempts)) if i not in one.added and _may_join(one, attempts, i)]
    for place in rest:
        yield tuple(sorted((*one.dropped, place))), one.added
    for i in able:
        yield one.dropped, tuple(sorted((*one.added, i)))
        for place in rest:
            yield tuple(sorted((*one.dropped, place))), tuple(sorted((*one.added, i)))


def _may_join(one: Neighbour, attempts: Sequence[Attempt], i: int) -> bool:
    """Whether no other effect of the name, port and place was added already."""
    new = attempts[i].fit.effects[-1]
    others = [attempts[k].fit.effects[-1] for k in one.added if attempts[k].name == new.name]
    return not any(not new.repeatable or (other.port, other.place) == (new.port, new.place) for other in others)


def members_weighed(problem: Problem, found: Fit, count: int) -> tuple[Neighbour, ...]:
    """Per member of a set, the set without it as far as slopes tell: what is less likely has a gain below zero.

    Args:
        problem: recordings.
        found: a set, all its effects free.
        count: candidates that were tried.
    """
    columns = Columns(problem, found, (), count)
    return tuple(_without(columns, place) for place in range(len(found.effects)))


def _without(columns: Columns, place: int) -> Neighbour:
    """A set without one member, as `members_weighed`."""
    problem, found, count = columns.problem, columns.found, columns.count
    other = _that_predicts_more(problem, found, place)
    if other is None:
        return columns.weighed_closely(columns.weighed((place,), ()))
    gain = odds_between(Standing(problem, found), other, count)
    price = log_prior_of_size(len(found.effects) - 1, count) - log_prior_of_size(len(found.effects), count)
    return Neighbour((place,), (), gain, min(gain - price, 0.0), other.fit.effects)


def _that_predicts_more(problem: Problem, found: Fit, place: int) -> Standing | None:
    """A set without its only free play, fitted to the samples that this left out; None for another member."""
    if not has_play([found.effects[place]]):
        return None
    rest = [effect for i, effect in enumerate(found.effects) if i != place]
    wide = regained(problem, rest)
    return Standing(wide, fit(wide, rest, iterations=ITERATIONS)) if wide is not problem else None


def odds_of_member(problem: Problem, found: Fit, place: int, count: int) -> float:
    """Logarithm of the odds for one member; other arguments as `members_weighed`."""
    return -_without(Columns(problem, found, (), count), place).gain


def needed_members(problem: Problem, found: Fit, may_go: Callable[[Effect], bool]) -> Standing:
    """The set without the members that the data are likelier without, the least needed first.

    Args:
        problem: recordings.
        found: a set, all its effects free.
        may_go: whether a member may be left out.
    """
    count = len(problem.predictor.candidates)
    columns = Columns(problem, found, (), count)
    able = [place for place, effect in enumerate(found.effects) if may_go(effect)]
    for one in sorted((columns.weighed((place,), ()) for place in able), key=lambda one: -one.gain):
        rest = [effect for place, effect in enumerate(found.effects) if place not in one.dropped]
        wide = regained(problem, rest)
        without = Standing(wide, fit(wide, rest, iterations=ITERATIONS))
        if odds_between(Standing(problem, found), without, count) > 0:
            return needed_members(without.problem, without.fit, may_go)
        if one.gain < -SURE:
            break
    return Standing(problem, found)
