"""Effects that cannot be distinguished: a rival in an effect's place, with the same error on data not fitted.

A rival is in the set where the data give less than 20 to 1 against it (`rival_odds`). The true effect is left out of a
set in less than one of a hundred cases, however near the rival is, and a rival five standard deviations away comes into
a set in one of thirty. The contract's bound holds beside it: the same validation error within 5 %. Alone it would fill
the sets of all small effects, since to leave such an effect away altogether costs less.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import inf, log

import numpy as np

from feeddrive.diagnosis.calibration.declared import as_effect, says_other
from feeddrive.diagnosis.calibration.stated import given_back, said_by_effects
from feeddrive.diagnosis.calibration.together import fitted_together
from feeddrive.diagnosis.certainty.certainty_result import Ambiguity
from feeddrive.diagnosis.certainty.imitations import imitations_of
from feeddrive.diagnosis.certainty.rival_odds import Residuals, odds_and_distance
from feeddrive.diagnosis.certainty.same_by_law import softer_while_seen, twins_of
from feeddrive.diagnosis.finding.attempt import Attempt
from feeddrive.diagnosis.finding.elsewhere import elsewhere, where
from feeddrive.diagnosis.finding.search import Search
from feeddrive.diagnosis.finding.sets import odds_of_member
from feeddrive.diagnosis.forms.simpler_law import highest_seen
from feeddrive.diagnosis.forms.spring_law import hardly_carrying
from feeddrive.diagnosis.judging.judge import Judged
from feeddrive.diagnosis.likelihood.coordinates import at_its_limit
from feeddrive.diagnosis.likelihood.fit import Fit, fit
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.likelihood.standing import Standing, commonly_predicted, excess_beyond, regained, same_samples
from feeddrive.diagnosis.likelihood.tolerances import SURE
from feeddrive.effects.base import Effect
from feeddrive.effects.chain.stiffness_deviation import PARTS, StiffnessDeviation
from feeddrive.effects.chain.structural_mode import StructuralMode, resonates_within
from feeddrive.effects.transmission.backlash import Backlash
from feeddrive.errors import InputError
from feeddrive.plant.analysis.stiffness_budget import participation
from feeddrive.units.quantity import percent

SAME_ERROR = 1.05
"""Ratio of validation errors (rms) within which two effects count as the same."""

LARGEST_SET = 3
"""Names in an ambiguous set."""

AGAINST = 2 * log(20.0)
"""Twice the logarithm of the odds from which a rival is refused."""

NEAR = 0.5
"""Gain of a candidate over that of the one taken in the same round, from which it is tried in its place."""

MOST_RIVALS = 4
"""Rivals tried for one effect; each costs a joint fit."""

PASSES = 2
"""Times that a rival and declared values are fitted in turn: what a rival that is as good is behind by, two remove; of
one that is not the odds alone are asked, and nothing of its values is reported."""

WITHIN = {("position_spring", "constant_force")}
"""Laws that hold another within them, a spring of no stiffness a force: what the data do not tell from that is that."""

ITERATIONS = 12
"""Steps of that fit at most; it starts from values that were fitted in the round of the search, others with it."""


@dataclass(frozen=True)
class Rival:
    """An effect in the place of one that was taken.

    Attributes:
        place: number of the effect taken.
        fit: of all effects, the rival last but in its place.
        odds: Lambda of the module's docstring.
        distance: between the two predictions, in standard deviations of the noise.
        error_ratio: of the validation errors (rms), the rival's over that of what was taken.
        problem: with the declared values that are fitted beside it.
    """

    place: int
    fit: Fit
    odds: float
    distance: float
    error_ratio: float
    problem: Problem

    @property
    def effect(self) -> Effect:
        """The rival."""
        return self.fit.effects[self.place]

    @property
    def as_good(self) -> bool:
        """Whether the data cannot tell it from what was taken."""
        return self.odds < AGAINST and self.error_ratio <= SAME_ERROR


def rivals_of(found: Search, judged: Sequence[Judged]) -> list[list[Rival]]:
    """Per effect found, the rivals that do as well in its place, the best first; at most two each.

    Args:
        found: what the search took and tried.
        judged: recordings with the found effects in.
    """
    mine = Residuals.of(found.problem, found.fit, [(j.after, j) for j in judged])
    edge = highest_seen(found.problem)  # a mode beyond it, or without a peak, is a payload
    result: list[list[Rival]] = []
    for place in range(len(found.fit.effects)):
        if found.problem.budget.skips("which other names do as well as", found.fit.effects[place].name):
            result.append([])
            continue
        near = [attempt.fit.effects[-1] for attempt in _near(found, place)]
        like = [
            other for other in imitations_of(found.fit.effects[place], found.problem.plant) if _is_free(found, other)
        ]
        values = _other_values(found, place)
        tried = [_in_place(found, judged, place, rival, mine) for rival in (*near, *like, *values)]
        good = [rival for rival in tried if rival is not None and rival.as_good and not at_its_limit(rival.effect)]
        taken = found.fit.effects[place].name
        good = [r for r in good if (r.effect.name, taken) not in WITHIN or r.distance > SURE]
        good = [r for r in good if not isinstance(r.effect, StructuralMode) or resonates_within(r.effect, edge)]
        best: dict[str, Rival] = {}
        for rival in sorted(good, key=lambda rival: rival.odds):
            best.setdefault(rival.effect.name, rival)
        result.append([*best.values()][: LARGEST_SET - 1])
    return result


def ambiguous_sets(found: Search, rivals: Sequence[list[Rival]]) -> tuple[Ambiguity, ...]:
    """The sets of names, the effect taken first, with the reason."""
    sets = []
    for effect, alike in zip(found.fit.effects, rivals, strict=True):
        twins = [
            *twins_of(effect, found.problem.plant, found.problem.evidence),
            *softer_while_seen(effect, found.problem, found.fit.effects),
        ]
        apart = {rival.effect.name: rival.distance for rival in alike}
        others = list((apart | {twin.name: 0.0 for twin in twins}).items())
        others.sort(key=lambda other: other[1])
        if others:
            names, distances = zip(*others[: LARGEST_SET - 1], strict=True)
            reasons = [*(twin.reason for twin in twins), *([_reason(effect, alike)] if alike else [])]
            sets.append(Ambiguity((effect.name, *names), distances, "; ".join(reasons)))
    return tuple(sets)


def other_places(found: Search, judged: Sequence[Judged]) -> tuple[str, ...]:
    """Sentences about effects whose place the data cannot tell: at motor or screw, at table or screw, which channel.

    Args:
        found: what the search took.
        judged: recordings with the found effects in.
    """
    placed = [(i, elsewhere(effect, found.problem.plant)) for i, effect in enumerate(found.fit.effects)]
    if not any(others for _, others in placed):
        return ()
    mine = Residuals.of(found.problem, found.fit, [(j.after, j) for j in judged])
    remarks = []
    for index, others in placed:
        effect = found.fit.effects[index]
        taken = {where(e) for e in found.fit.effects if e.name == effect.name}
        tried = [_in_place(found, judged, index, other, mine) for other in others if where(other) not in taken]
        alike = [where(rival.effect) for rival in tried if rival is not None and rival.as_good]
        if alike:
            said = f"{effect.place_key or 'port'} = {joined(alike)} does as well as {where(effect)}"
            remarks.append(f"{effect.name}: {said}; these recordings cannot tell{_shares(effect, alike, found)}")
    return tuple(remarks)


def _shares(effect: Effect, alike: Sequence[str], found: Search) -> str:
    """How much of the compliance at the table parts that cannot be distinguished have; empty for other effects."""
    plant = found.problem.plant
    if not isinstance(effect, StiffnessDeviation) or effect.place not in PARTS:
        return ""
    parts = [part for part in (effect.place, *alike) if part in PARTS]
    shares = [f"{part} {percent(participation(plant, PARTS[part], plant.middle))}" for part in parts]
    return f". Of the compliance at the table they have in mid-stroke: {', '.join(shares)}"


def _near(found: Search, place: int) -> list[Attempt]:
    """Candidates that came near when the effect was taken, and those that its signature names, the best first."""
    effect = found.fit.effects[place]
    present = {e.name for e in found.fit.effects}
    for turn, attempts in enumerate(found.rounds):
        taken = next((t for t in found.trials if t.round == turn + 1 and t.taken), None)
        if taken is None or effect.name not in taken.name.split(" with "):
            continue
        # a member that it was exchanged for is none of the candidates of that round
        here = {a.name for a in attempts}
        gone = [a for before in found.rounds[:turn][::-1] for a in before if a.name in effect.signature.confused_with]
        attempts = (*attempts, *(a for a in gone if a.name not in here))
        # one that gains more and scatters too much to be taken may yet be what it is
        able = [a for a in attempts if a.comparison.pays or a.comparison.gain > taken.gain]
        others = [a for a in able if a.name != effect.name and " with " not in a.name]
        near = [a for a in others if a.comparison.gain > NEAR * taken.gain or a.name in effect.signature.confused_with]
        free = [a for a in near if a.name not in present or a.fit.effects[-1].repeatable]
        return sorted(free, key=lambda a: -a.comparison.gain)[:MOST_RIVALS]
    return []


def _other_values(found: Search, place: int) -> list[Effect]:
    """Effects that say another declared value to be other, from none on, where the effect at a place says so of one.

    They are no candidates of a round, as every set has them fitted within their tolerances.
    """
    known, named = found.problem.calibration, found.fit.effects[place]
    if known is None or not says_other(named):
        return []
    others = [value for value in known.values if value.name not in ("", named.name)]
    stated = {(value.name, value.place): as_effect(found.problem.plant, value, 0.0) for value in others}
    return [*stated.values()]


def _is_free(found: Search, effect: Effect) -> bool:
    """Whether an effect can be put in: asked of these recordings, and not in yet."""
    asked = {candidate.name for candidate in found.problem.predictor.candidates} - set(found.reasons)
    return effect.name in asked and (effect.repeatable or effect.name not in {e.name for e in found.fit.effects})


def _in_place(found: Search, judged: Sequence[Judged], place: int, rival: Effect, mine: Residuals) -> Rival | None:
    """A rival in the place of an effect, all refitted; None where the plant cannot hold or follow it.

    Where one of them says that a declared value is other, what was named is one of the fitted values again, and what
    the rival is about none: beside each, all others are free within their tolerances. A rival that brings nothing
    beside that value is none. Most bring nothing, and that shows after the first pass.
    """
    effects, problem, named = [*found.fit.effects], found.problem, found.fit.effects[place]
    effects[place] = rival
    try:
        stated, said = said_by_effects(problem, effects)
        freed = given_back(stated, named)
        beside_value = _keys(freed) != _keys(stated)
        if _keys(freed) != _keys(problem):
            problem, effects = fitted_together(freed, said, 1)
            if beside_value and _is_idle(problem, fit(problem, effects, iterations=0), place):
                return None
            problem, effects = fitted_together(problem, effects, PASSES - 1)
        problem = regained(problem, effects)
        swapped = there = fit(problem, effects, iterations=ITERATIONS)
        if beside_value and _is_idle(problem, swapped, place):
            return None
        beyond, common = 0.0, problem
        if not same_samples(problem, found.problem):  # without the free play of what was taken
            common = commonly_predicted(problem, found.problem)
            there = fit(common, swapped.effects, iterations=ITERATIONS)
            level = min(float(mine.fitted @ mine.fitted), there.squared_error) / max(len(mine.fitted), 1)
            beyond = excess_beyond(Standing(problem, swapped), Standing(found.problem, found.fit), level)
        its = Residuals.of(common, there, [(j.with_effects(problem, there.effects), j) for j in judged])
        is_play = isinstance(named, Backlash)
        soft_edges = _odds_for_soft_edges(Standing(common, there), place, judged, its) if is_play else -inf
    except InputError:
        return None
    if not np.all(np.isfinite(its.fitted)):
        return None
    odds, distance = odds_and_distance(found.problem, judged, mine, its, beyond)
    ratio = float(np.linalg.norm(its.judged) / np.linalg.norm(mine.judged))
    return Rival(place, swapped, max(odds, soft_edges), distance, ratio, problem)


def _odds_for_soft_edges(rival: Standing, place: int, judged: Sequence[Judged], its: Residuals) -> float:
    """Odds, as a rival's, for a free play of soft edges against the lost preload that would take its place.

    A play whose edges are soft, or blurred by the steps of an encoder, lies between a play of sharp edges and a lost
    preload at the end of its range. So what is nearer to a lost preload than to sharp edges is none yet: its ratio
    tells. There is no such play in the place of another effect.
    """
    play = hardly_carrying(rival.problem, rival.fit, place)
    if play is None:
        return -inf
    plants = [(j.with_effects(rival.problem, play.effects), j) for j in judged]
    soft = Residuals.of(rival.problem, play, plants)
    soft = replace(soft, coordinates=soft.coordinates - 1)  # its ratio is none
    return -odds_and_distance(rival.problem, judged, its, soft)[0]


def _is_idle(problem: Problem, swapped: Fit, place: int) -> bool:
    """Whether a rival says nothing beside a declared value that is free again: it is the value that does as well."""
    return odds_of_member(problem, swapped, place, len(problem.predictor.candidates)) <= 0


def _keys(problem: Problem) -> tuple[str, ...]:
    """Declared values that are fitted."""
    return tuple(one.key for one in problem.calibration.values) if problem.calibration is not None else ()


def _reason(effect: Effect, alike: Sequence[Rival]) -> str:
    """How alike the members are, and what each follows."""
    apart = joined([f"{rival.effect.name} by {rival.distance:.1f}" for rival in alike])
    members = (effect, *(rival.effect for rival in alike))
    variables = list(dict.fromkeys(one.signature.variable for one in members))
    if len(variables) == 1:
        part = f"All follow {variables[0]}: only a larger motion or less noise shows how their shapes differ."
    else:
        follows = "; ".join(f"{one.name} with {one.signature.variable}" for one in members)
        part = f"They part where these vary differently: {follows}."
    return (
        f"the same signature in these data: when all else is refitted, the prediction with {effect.name} differs from "
        f"that with {apart} standard deviations of the noise, all samples together. {part}"
    )


def joined(words: Sequence[str]) -> str:
    """Words as in a sentence."""
    return words[0] if len(words) == 1 else f"{', '.join(words[:-1])} and {words[-1]}"
