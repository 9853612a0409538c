"""Effects that cannot be told apart: a rival in an effect's place, with the same error on data not fitted.

    Lambda = (|r_B|^2 - |r_A|^2) / c + 2 (k_B - k_A),  c = d' Gamma d / d'd,  d = r_B - r_A,  distance = |d| / sqrt(c)

| symbol | meaning | unit |
|---|---|---|
| r_A, r_B | weighted residuals with the effect taken and with its rival, all others refitted; all recordings | 1 |
| k_A, k_B | coordinates fitted; each takes one of Lambda from the fitted data, and adds one on others (Akaike) | 1 |
| Gamma | covariance of the residual, from its spectrum (`noise_colour`) | 1 |
| c | variance of what the noise adds to a sum along d, over that of white noise of variance one | 1 |

Lambda is twice the logarithm of the odds for the effect taken. A rival is in the set where the data give less than 20
to 1 against it; the true effect is left out of a set in less than one of a hundred cases, however near the rival is,
and a rival five standard deviations away comes into a set in one of thirty. The contract's bound holds beside it: the
same validation error within 5 %. Without the odds that bound would fill the set of every small effect, since leaving
it away altogether costs less than 5 %.
Source: Royall, Statistical Evidence (1997), section 1.6 (odds that mislead); Vuong, Econometrica 57 (1989) 307.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import log

import numpy as np

from feeddrive.diagnose.attempt import Attempt
from feeddrive.diagnose.certainty_result import Ambiguity
from feeddrive.diagnose.coordinates import read_coordinates
from feeddrive.diagnose.fit import Fit, Problem, fit
from feeddrive.diagnose.judge import Judged, error_series
from feeddrive.diagnose.noise_colour import score_covariance
from feeddrive.diagnose.predictor import Machine
from feeddrive.diagnose.recordings import is_shift
from feeddrive.diagnose.same_by_law import twins_of
from feeddrive.diagnose.search import Search
from feeddrive.effects.base import Effect
from feeddrive.errors import InputError
from feeddrive.typing import FloatArray

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

PLACED = ("inertia_deviation", "channel_delay")
"""Effects whose place is put to the question."""

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
    """

    place: int
    fit: Fit
    odds: float
    distance: float
    error_ratio: float

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
    mine = _Residuals.of(found.problem, found.fit, [(j.after, j) for j in judged])
    result = []
    for place in range(len(found.fit.effects)):
        tried = [_in_place(found, judged, place, attempt.fit.effects[-1], mine) for attempt in _near(found, place)]
        alike = sorted((rival for rival in tried if rival is not None and rival.as_good), key=lambda rival: rival.odds)
        result.append(alike[: LARGEST_SET - 1])
    return result


def ambiguous_sets(found: Search, rivals: Sequence[list[Rival]]) -> tuple[Ambiguity, ...]:
    """The sets of names, the effect taken first, with the reason."""
    sets = []
    for effect, alike in zip(found.fit.effects, rivals, strict=True):
        twins = twins_of(effect, found.problem.plant, found.problem.evidence)
        apart = {rival.effect.name: rival.distance for rival in alike}
        others = list((apart | {twin.name: 0.0 for twin in twins}).items())
        others.sort(key=lambda other: other[1])
        if others:
            names, distances = zip(*others[: LARGEST_SET - 1], strict=True)
            told = [*(twin.reason for twin in twins), *([_reason(effect, alike)] if alike else [])]
            sets.append(Ambiguity((effect.name, *names), distances, "; ".join(told)))
    return tuple(sets)


def other_places(found: Search, judged: Sequence[Judged]) -> tuple[str, ...]:
    """Sentences about effects whose place the data cannot tell: at motor or screw, which channel.

    Args:
        found: what the search took.
        judged: recordings with the found effects in.
    """
    placed = [(i, effect) for i, effect in enumerate(found.fit.effects) if effect.name in PLACED]
    if not placed:
        return ()
    mine = _Residuals.of(found.problem, found.fit, [(j.after, j) for j in judged])
    told = []
    for index, effect in placed:
        taken = {e.place for e in found.fit.effects if e.name == effect.name}
        tried = [
            _in_place(found, judged, index, type(effect).of(None, place, **effect.values), mine)
            for place in effect.places
            if place not in taken
        ]
        alike = [rival.effect.place for rival in tried if rival is not None and rival.as_good]
        if alike:
            where = f"{effect.place_key} = {joined(alike)} does as well as {effect.place}"
            told.append(f"{effect.name}: {where}; these recordings cannot tell")
    return tuple(told)


def with_the_simplest(found: Search, rivals: Sequence[list[Rival]]) -> tuple[Search, list[list[Rival]]]:
    """The search and its rivals with the first effect replaced that has a rival of fewer parameters; else the same.

    The search takes the simpler of two that tie when they are tried; later effects can make others tie.
    """
    plant = found.problem.plant
    if any(is_shift(effect) for effect in found.fit.effects):
        return found, list(rivals)  # what one recording has otherwise belongs to the effect taken
    for place, alike in enumerate(rivals):
        own = len(read_coordinates([found.fit.effects[place]], plant))
        for simple in alike:
            if len(read_coordinates([simple.effect], plant)) < own:
                ousted = Rival(place, found.fit, -simple.odds, simple.distance, 1 / simple.error_ratio)
                others = [replace(rival, odds=rival.odds - simple.odds) for rival in alike if rival is not simple]
                rest = [rival for rival in (ousted, *others) if rival.as_good]
                refitted = fit(found.problem, simple.fit.effects)
                return replace(found, fit=refitted), [*rivals[:place], rest, *rivals[place + 1 :]]
    return found, list(rivals)


def _near(found: Search, place: int) -> list[Attempt]:
    """Candidates that came near when the effect was taken, and those that its signature names, the best first."""
    effect = found.fit.effects[place]
    present = {e.name for e in found.fit.effects}
    for number, attempts in enumerate(found.rounds):
        taken = next((t for t in found.trials if t.round == number + 1 and t.taken), None)
        if taken is None or effect.name not in taken.name.split(" with "):
            continue
        others = [a for a in attempts if a.name != effect.name and " with " not in a.name and a.comparison.pays]
        near = [a for a in others if a.comparison.gain > NEAR * taken.gain or a.name in effect.signature.confused_with]
        free = [a for a in near if a.name not in present or a.fit.effects[-1].repeatable]
        return sorted(free, key=lambda a: -a.comparison.gain)[:MOST_RIVALS]
    return []


def _in_place(found: Search, judged: Sequence[Judged], place: int, rival: Effect, mine: _Residuals) -> Rival | None:
    """A rival in the place of an effect, all refitted; None where the plant cannot hold or follow it."""
    effects = [*found.fit.effects]
    effects[place] = rival
    try:
        swapped = fit(found.problem, effects, iterations=ITERATIONS)
        its = _Residuals.of(
            found.problem, swapped, [(j.with_effects(found.problem, swapped.effects), j) for j in judged]
        )
    except InputError:
        return None
    if not np.all(np.isfinite(its.fitted)):
        return None
    odds, distance = _odds(found.problem, judged, mine, its)
    return Rival(place, swapped, odds, distance, float(np.linalg.norm(its.judged) / np.linalg.norm(mine.judged)))


@dataclass(frozen=True)
class _Residuals:
    """Weighted residuals of one set of effects: as fitted, and thinned on the judged samples; its coordinates."""

    fitted: FloatArray
    judged: FloatArray
    coordinates: int

    @classmethod
    def of(cls, problem: Problem, fitted: Fit, plants: Sequence[tuple[Machine, Judged]]) -> _Residuals:
        """Of a fit, with the plant that it gives for each judged recording."""
        judged = np.concatenate([_thinned_error(problem, plant, j) for plant, j in plants])
        return cls(fitted.residual, judged, len(fitted.coordinates))


def _thinned_error(problem: Problem, plant: Machine, judged: Judged) -> FloatArray:
    evidence = judged.evidence
    errors = error_series(problem, plant, evidence)
    rows = evidence.thinned(evidence.judged_rows)
    return np.concatenate([errors[name][rows] / evidence.noise[name] for name in evidence.channels])


def _odds(problem: Problem, judged: Sequence[Judged], mine: _Residuals, its: _Residuals) -> tuple[float, float]:
    """Lambda and distance, fitted and judged samples together."""
    parts = (
        (list(problem.evidence), [e.fit_rows for e in problem.evidence], mine.fitted, its.fitted),
        ([j.evidence for j in judged], [j.evidence.judged_rows for j in judged], mine.judged, its.judged),
    )
    excess, square, scatter = 0.0, 0.0, 0.0
    for evidence, rows, left, other in parts:
        difference = other - left
        excess += float(other @ other - left @ left)
        square += float(difference @ difference)
        scatter += float(score_covariance(evidence, rows, left, difference[:, None])[0, 0])
    if not scatter > 0:
        return (0.0, 0.0) if square == 0 else (excess, float("inf"))
    colour = scatter / square
    more = 2.0 * (its.coordinates - mine.coordinates)
    return excess / colour + more, float(np.sqrt(square / colour))


def _reason(effect: Effect, alike: Sequence[Rival]) -> str:
    """How alike the members are, and what each follows."""
    apart = joined([f"{rival.effect.name} by {rival.distance:.1f}" for rival in alike])
    members = (effect, *(rival.effect for rival in alike))
    follows = "; ".join(f"{one.name} with {one.signature.variable}" for one in members)
    return (
        f"the same signature in these data: when all else is refitted, the prediction with {effect.name} differs from "
        f"that with {apart} standard deviations of the noise, all samples together. "
        f"They part where these vary differently: {follows}."
    )


def joined(words: Sequence[str]) -> str:
    """Words as in a sentence."""
    return words[0] if len(words) == 1 else f"{', '.join(words[:-1])} and {words[-1]}"
