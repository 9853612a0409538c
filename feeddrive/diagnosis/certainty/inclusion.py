"""Odds for every name: of those taken against the sets without them, of others against the set as it is.

    odds(m) = 1 / (Σ E(without m) / E + Σ E(rival in the place of m) / E)

with the evidence E of `likelihood.set_evidence`, each set beside the declared values that suit it best: a set without a
name has values of its own, which take over some of what the name explained. What the data say for a further effect
grows with the time that is recorded, what it costs does not: so a recording of the same kind that settles it is so many
times as long. What speaks for the curve of a law speaks for the law: without the law there is none.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.special import logsumexp

from feeddrive.diagnosis.calibration.beyond import log_chance_of_values
from feeddrive.diagnosis.calibration.stated import without_effects
from feeddrive.diagnosis.certainty.ambiguity import AGAINST, Rival
from feeddrive.diagnosis.finding.attempt import JOINT_ITERATIONS
from feeddrive.diagnosis.finding.likelier import Near
from feeddrive.diagnosis.finding.members import members_of
from feeddrive.diagnosis.finding.refitting import at_rest, to_rest
from feeddrive.diagnosis.finding.search import Search
from feeddrive.diagnosis.finding.sets import SURE, members_weighed
from feeddrive.diagnosis.forms.open_map import log_odds_of_curves, open_curves, with_curves_of
from feeddrive.diagnosis.judging.result import PossibleEffect
from feeddrive.diagnosis.likelihood.fit import fit
from feeddrive.diagnosis.likelihood.standing import Standing, odds_between
from feeddrive.diagnosis.recordings.recordings import is_shift, without_shifts

OPEN = 0.5 * AGAINST
"""Logarithm of the odds, either way, within which a name is possible: those that refuse a rival."""

FOLLOWED = 0.25
"""Share of the odds against a set that its next step to rest may promise: where a narrow valley was met, 3.4 times what
a step promised followed in all."""

MOST = 1e6
"""Odds that are reported at most: beyond, the model that they are odds under is what is in doubt."""


def odds_for(found: Search, rivals: Sequence[Sequence[Rival]]) -> tuple[float, ...]:
    """Odds for every effect that was taken, at most `MOST`.

    Args:
        found: what the search took.
        rivals: per effect, those that do as well in its place.
    """
    members = _members_at_rest(found)[: len(without_shifts(found.fit.effects))]
    result = []
    for one, alike in zip(members, rivals, strict=False):
        against = float(logsumexp([one.gain, *(-0.5 * rival.odds for rival in alike)]))
        result.append(float(np.exp(np.clip(-against, -math.log(MOST), math.log(MOST)))))
    return tuple(result)


def asserted(found: Search) -> Search:
    """The search with the names alone for which the odds are 20 to 1 or more; the others may be.

    The search takes a set that is likelier at all, so that what such a name explains is not taken for another. The
    least likely goes first: of two that share what they explain the other is then likelier. Laws that cannot be told
    from each other are one name here: their odds against each other are told, and they stand as an ambiguous set.

    Args:
        found: what the search took, judged on data not fitted.
    """
    if any(is_shift(effect) for effect in found.fit.effects):
        return found  # what one recording has otherwise belongs to the effect taken
    while found.fit.effects:
        members = _members_at_rest(found)
        place = max(range(len(members)), key=lambda i: members[i].gain)
        one = members[place]
        if one.gain <= -OPEN:
            return found
        near = Near(found.fit.effects[place].name, -one.gain, -one.speaks)
        found = replace(found, problem=one.without.problem, fit=one.without.fit, near=(near, *found.near))
    return found


@dataclass(frozen=True)
class _Member:
    """A member of a set, and the set without it.

    Attributes:
        gain: logarithm of the odds for the set without it.
        speaks: part of it that grows with the time recorded.
        without: that set, its declared values at rest.
    """

    gain: float
    speaks: float
    without: Standing


def _members_at_rest(search: Search) -> tuple[_Member, ...]:
    """Per member of a set, the set without it; both with their declared values at rest.

    Slopes say of the values what holds near the set at hand. A stiffness along the stroke that is forty nats likelier
    than nothing by them may be what a spring a deviation softer says as well, and beside an encoder whose steps show
    the values that stand beside a braked mode tell it, where those that suit the set without it tell nothing.
    """
    for fitted, weighed in search.weighed:
        if fitted is search.fit:
            return weighed  # type: ignore[no-any-return]
    weighed = _weighed_at_rest(search)
    search.weighed.append((search.fit, weighed))
    return weighed


def _weighed_at_rest(search: Search) -> tuple[_Member, ...]:
    problem, found, count = search.problem, search.fit, search.count
    members = members_weighed(problem, found, count)
    stands, curves = Standing(*at_rest(problem, found)), _odds_of_curves(search)
    result = []
    for place, one in enumerate(members):
        named = found.effects[place]
        without, gain = _without_at_rest(search, stands, place)
        gain -= curves.get(named.name, 0.0)
        if gain > -OPEN:  # what declared values beyond their tolerances explain, their tolerances deny
            chance = log_chance_of_values(without.problem, without.fit, named)
            gain = min(gain, chance) if chance < 0 else gain
        result.append(_Member(gain, min(gain - one.gain + one.speaks, 0.0), without))
    return tuple(result)


def _without_at_rest(search: Search, stands: Standing, place: int) -> tuple[Standing, float]:
    """A set without one member, its declared values at rest, and the logarithm of the odds for it.

    It comes no further than to where it is sure that at rest it is no likelier.
    """
    problem, found = search.problem, search.fit
    rest = [effect for i, effect in enumerate(found.effects) if i != place]
    there = without_effects(problem, [found.effects[place]], rest)
    for on_the_way in to_rest(there, fit(there, rest)):
        without = Standing(on_the_way.problem, on_the_way.fit)
        gain = odds_between(stands, without, search.count)
        if gain <= -SURE and on_the_way.promised < -FOLLOWED * gain:
            break
    return without, gain


def _odds_of_curves(found: Search) -> dict[str, float]:
    """Law of another form to the logarithm of the odds for its curve, where the plant does not carry it beside it."""
    if found.opened is None or members_of(found.opened[1].effects) != members_of(found.fit.effects):
        return {}
    problem, fitted = found.opened
    result = {}
    for name in open_curves(problem):
        if name not in found.problem.tables:
            closed = with_curves_of(problem, [effect for effect in fitted.effects if effect.name != name])
            alone = fit(closed, fitted.effects, iterations=JOINT_ITERATIONS)
            result[name] = max(log_odds_of_curves(closed, alone, found.count, problem), 0.0)
    return result


def possible_effects(found: Search, rivals: Sequence[Sequence[Rival]]) -> tuple[PossibleEffect, ...]:
    """Names that may be, beside those taken or in their place, the likeliest first."""
    taken = {effect.name for effect in found.fit.effects}
    result = []
    for effect, alike in zip(found.fit.effects, rivals, strict=False):
        for rival in alike:
            settles = f"an experiment in which {rival.effect.signature.variable.replace('_', ' ')} varies otherwise"
            odds = math.exp(-0.5 * max(rival.odds, -2 * OPEN))
            result.append(PossibleEffect(rival.effect.name, odds, effect.name, settles))
    known = taken | {one.name for one in result}
    for near in found.near:
        if near.name in known or near.gain <= -OPEN:
            continue
        # Half a nat a value is what chance gives: a motion that promises less does not speak of the effect.
        longer = (OPEN - near.gain + near.speaks) / near.speaks if near.speaks > 0.5 else 0.0
        if longer > 1:
            settles = f"a recording of the same motion {math.ceil(10 * longer) / 10:g} times as long"
        else:
            settles = "a recording of another motion: on blocks left out of the fit it does not pay"
        result.append(PossibleEffect(near.name, min(math.exp(min(near.gain, OPEN)), MOST), "", settles))
        known.add(near.name)
    return tuple(sorted(result, key=lambda one: -one.odds))
