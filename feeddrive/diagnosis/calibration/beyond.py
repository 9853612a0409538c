"""Declared values that are beyond their tolerances: asked of the recordings, and named as effects."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from itertools import chain, repeat

import numpy as np
from scipy.special import chdtrc, chdtri

from feeddrive.diagnosis.calibration.calibrate import (
    PASSES,
    at_declared,
    moved,
    recalibrated,
)
from feeddrive.diagnosis.calibration.calibration import Calibration
from feeddrive.diagnosis.calibration.declared import (
    as_effect,
    is_said_by,
)
from feeddrive.diagnosis.calibration.known import TOLERANCE, Known, known_values
from feeddrive.diagnosis.calibration.stated import coordinate_said, given_back, said_by_effects
from feeddrive.diagnosis.calibration.together import cost, fitted_together
from feeddrive.diagnosis.calibration.value_slopes import ENOUGH, with_new_slopes, with_slopes
from feeddrive.diagnosis.likelihood.fit import Fit, fit
from feeddrive.diagnosis.likelihood.problem import UNEXPLAINED, Problem
from feeddrive.diagnosis.likelihood.standing import Standing, odds_between
from feeddrive.diagnosis.likelihood.tolerances import BEYOND, SURE
from feeddrive.diagnosis.motion.preparing import weighed_by
from feeddrive.effects.base import Effect
from feeddrive.typing import FloatArray

TRIED = 2
"""Values that are freed from the declared machine on, those first that one step serves best: it spares work."""

AGAINST = 2 * math.log(20.0)
"""Twice the logarithm of the odds from which a value is refused that is not the likeliest (as `ambiguity`)."""


def beyond_tolerance(problem: Problem, found: Fit) -> tuple[Problem, Effect] | None:
    """The effect on declared values that is surest to put them beyond their tolerances; None where none is asserted.

    One does where no values within their tolerances explain the recordings, and some do that are all but its own, as
    the search has them and as they are placed by scatter. Of effects that are alike to the recordings the likeliest is
    taken; `other_places` says the others. Where the values contradict each other whichever is free, each is asked from
    the declared machine on (`beyond_from_declared`).

    Returns:
        The problem without its values among those that are fitted, and the effect, from its likeliest values.
    """
    begun = beyond_from_declared(problem, found)
    if begun is not None:
        return begun
    known = known_values(problem, found)
    gained = _gained(known)
    if known is None or not any(gain > _sure(len(places)) for places, gain in gained.items()):
        return None
    placed, most = _gained(placed_by_scatter(problem, found)), max(gained.values())
    alike = [places for places, gain in gained.items() if gain > most - AGAINST]
    alike = [places for places in alike if min(gained[places], placed.get(places, 0.0)) > _sure(len(places))]
    if not alike:
        return None
    costs = {places: known.likeliest({i: BEYOND / known.values[i].deviation for i in places})[1] for places in alike}
    chosen = min(alike, key=costs.__getitem__)
    there = _with_free_values(problem, found.effects, chosen)
    freed, (effect,) = said_by_effects(there, [as_effect(problem.plant, known.values[chosen[0]], 0.0)])
    freed, together = fitted_together(freed, (*found.effects, effect))
    return freed, together[-1]


def _contradict(known: Known, places: Sequence[int]) -> bool:
    """Whether values contradict each other, as seldom by chance as `SURE` deviations, with some of them free."""
    others = len(known.values) - len(places)
    return others > 0 and known.least(*places) > _sure(others)


def beyond_from_declared(problem: Problem, found: Fit) -> tuple[Problem, Effect] | None:
    """The effect beyond its tolerance whose machine, begun as declared, is the likeliest; None where none is asserted.

    Asked where values contradict each other whichever is free: one that is off by far draws all others along, and from
    where they have gone no step leads back. Free from the beginning it needs none of them. Each begins where the
    slopes of the declared machine put it, the others within their tolerances, and those are fitted that leave least.
    It is asserted by what the recordings say at its machine, not where the values had run to.
    """
    known, told = problem.calibration, known_values(problem, found)
    gained = _gained(told)
    if known is None or told is None or not gained or not all(_contradict(told, places) for places in gained):
        return None
    begun = with_new_slopes(at_declared(problem), found.effects)
    effects, variance = found.effects, known.variance
    slopes = known_values(begun, fit(begun, effects, iterations=0))
    assert slopes is not None
    starts = {places: _freed(begun.at_values(slopes.at_least(*places)), places) for places in gained}
    stepped = {places: cost(there, effects, variance) for places, there in starts.items()}
    promising = sorted(stepped, key=stepped.__getitem__)[:TRIED]
    machines = {places: _calibrated_freely(starts[places], effects) for places in promising}
    costs = {places: cost(there, effects, variance) for places, there in machines.items()}
    chosen = min(costs, key=costs.__getitem__)
    if costs[chosen] >= cost(problem, effects, variance):
        return None
    freed, (effect,) = said_by_effects(machines[chosen], [as_effect(problem.plant, known.values[chosen[0]], 0.0)])
    freed, (*rest, effect) = fitted_together(freed, (*found.effects, effect))
    return (freed, effect) if is_beyond(freed, rest, effect) else None


def is_beyond(problem: Problem, rest: Sequence[Effect], effect: Effect) -> bool:
    """Whether the recordings assert, at the machine of a set, that an effect puts its declared values out of tolerance.

    Args:
        problem: without these values among those that are fitted.
        rest: the other effects of the set.
        effect: which says that they are other.
    """
    back = given_back(problem, effect)
    if back.calibration is None:  # declared as exact: every other value is beyond
        without, other = (Standing(problem, fit(problem, some)) for some in (rest, (*rest, effect)))
        return odds_between(without, other, len(problem.predictor.candidates)) > 0
    values = back.calibration.values
    places = tuple(i for i, value in enumerate(values) if value.name and is_said_by(value, effect))
    coordinates = back.calibration.coordinates.copy()
    for i in places:
        coordinates[i] = max(coordinate_said(problem.plant, values[i], effect), -values[i].farthest)
    if not np.all(np.isfinite(coordinates)):
        return False
    there = with_new_slopes(back.at_values(coordinates), rest)
    told = known_values(there, fit(there, rest))
    return told is not None and _gain(told, places) > _sure(len(places))


def log_chance_of_values(problem: Problem, without: Fit, effect: Effect) -> float:
    """Logarithm of the chance of what recordings say of declared values, beside a set without the effect on them.

    Args:
        problem: with these values among those that are fitted, at rest.
        without: the set.
        effect: which says that they are other.

    Returns:
        Zero where it leaves them within their tolerances, or the recordings do not assert that they are beyond, or the
        effect says nothing of any. What T says of values that are at rest within is said by slopes that bend.
    """
    known = problem.calibration
    if known is None:
        return 0.0
    places = tuple(i for i, value in enumerate(known.values) if value.name and is_said_by(value, effect))
    if not np.any(np.abs(known.coordinates[list(places)]) > TOLERANCE):
        return 0.0
    told = known_values(problem, without)
    gain = _gain(told, places) if told is not None else 0.0
    if gain <= _sure(len(places)):
        return 0.0
    return math.log(max(float(chdtrc(len(places), gain)), np.finfo(float).tiny))


def with_torque_scale(problem: Problem, found: Fit) -> Problem | None:
    """The problem with the scale of the torque free of its tolerance; None where a declared value explains as much.

    It is the recorder's and not the machine's: a peak current for an rms one, a wrong constant. It goes first where it
    is the likeliest of all that explain the recordings, and no other value is beyond its tolerance beside it.
    """
    known = known_values(problem, found)
    if known is None or not _is_of_torque(known):
        return None
    placed = placed_by_scatter(problem, found)
    if placed is None or not _is_of_torque(placed):
        return None
    (place,) = _torque_scale(known)
    return _with_free_values(problem, found.effects, (place,))


def _torque_scale(known: Known) -> tuple[int, ...]:
    """Place of the torque constant where it is fitted within a tolerance; none where it is not."""
    return tuple(i for i, value in enumerate(known.values) if value.key == "torque_constant" and value.widened == 1)


def _is_of_torque(known: Known) -> bool:
    """Whether a free scale of the torque is the likeliest of what puts the others within their tolerances."""
    scale = _torque_scale(known)
    if not scale:
        return False
    gained, gain = _gained(known), _gain(known, scale)
    if gain <= _sure(len(scale)):
        return False
    left = known.least(*scale)
    if any(left - known.least(*scale, *places) > _sure(len(places)) for places in gained):
        return False

    def unlikeliness(places: Sequence[int]) -> float:
        return known.likeliest({i: BEYOND / known.values[i].deviation for i in places})[1]

    alike = [places for places, its in gained.items() if its > gain - AGAINST]
    return all(unlikeliness(scale) <= unlikeliness(places) for places in alike)


def _sure(count: int) -> float:
    """What T is lowered by, by chance, by values that are free of their tolerances, as seldom as `SURE` deviations."""
    return float(chdtri(count, math.erfc(SURE / math.sqrt(2))))


def _gained(known: Known | None) -> dict[tuple[int, ...], float]:
    """Places of the values that one effect says to be other, to what they lower T by where they are free (`_gain`)."""
    if known is None:
        return {}
    stated = dict[tuple[str, str], tuple[int, ...]]()
    for i, value in enumerate(known.values):
        if value.name:
            stated[value.name, value.place] = (*stated.get((value.name, value.place), ()), i)
    return {places: _gain(known, places) for places in stated.values()}


def _gain(known: Known, places: Sequence[int]) -> float:
    """What values lower T by where they are free of their tolerances, over the variance that is left then.

    What contradicts itself still, each of the other values within its tolerance, scatters by more than is told: by
    T over their number where that is more than one (Birge, Phys. Rev. 40 (1932) 207).
    """
    left, others = known.least(*places), len(known.values) - len(places)
    return (known.least() - left) / max(left / others if others else 1.0, 1.0)


def placed_by_scatter(problem: Problem, found: Fit) -> Known | None:
    """What the recordings tell beside declared values that are most likely by the scatter of what tells of them.

    One variance for all directions lets values that are alike to the recordings run far along what the noise makes of
    them, to where slopes and the encoder's weights say that it is they who are other. So they begin as declared, with
    the weights of the machine that was declared. Where one is so far off that no step leads there, and much is left,
    they begin where it was found.
    """
    there = at_declared(problem)
    declared = there.machine(found.effects)
    there = replace(there, evidence=tuple(weighed_by(e, declared) for e in there.evidence))
    known, left = _placed_from(there, found.effects)
    likeliest = replace(problem, evidence=there.evidence)
    if left > UNEXPLAINED * fit(likeliest, found.effects, iterations=0).squared_error:
        known, _ = _placed_from(likeliest, found.effects)
    return known


def _placed_from(there: Problem, effects: Sequence[Effect]) -> tuple[Known | None, float]:
    """What the recordings tell beside values placed by scatter, from those of a problem on, and what is left there."""
    share, before, left = 1.0, np.zeros(0), math.inf
    for more in chain(range(PASSES, 0, -1), repeat(0)):
        there = with_slopes(there, effects)
        result = fit(there, effects)
        effects, known = result.effects, known_values(there, result)
        if known is None:
            return None, math.inf
        u, _ = known.likeliest({})
        step = np.array([known.c(i, float(one)) for i, one in enumerate(u)]) - known.at
        # one that still leaves less than half of what it left before is on its way: slopes there are of another machine
        done = not more and (result.squared_error > 0.5 * left or there.budget.is_spent)
        if np.max(np.abs(step), initial=0.0) < ENOUGH or done:
            break
        share, left = _share(share, before, step) if len(before) else 1.0, result.squared_error
        there, before = there.at_values(known.at + share * step), step
    return known, result.squared_error


def _share(share: float, before: FloatArray, step: FloatArray) -> float:
    """Share of a step, (k,), of a search for a fixed point, after a share of the one before it; the whole at most."""
    turn = step - before
    told = -share * float(before @ turn) / float(turn @ turn) if np.any(turn) else 1.0
    return min(told, 1.0) if told > 0 else 1.0


def _with_free_values(problem: Problem, effects: Sequence[Effect], places: Sequence[int]) -> Problem:
    """The problem with some of its values free of their tolerances, all fitted in common steps.

    The others have stood in for them and go back with them: in turn, neither gets far.
    """
    return _calibrated_freely(_freed(problem, places), effects)


def _freed(problem: Problem, places: Sequence[int]) -> Problem:
    """The problem with some of its values free of their tolerances, all where they are."""
    known = problem.calibration
    assert known is not None
    wider = np.ones(len(known.values))
    values = [*known.values]
    for place in places:
        wider[place] = max(BEYOND / values[place].deviation, 1.0)
        by = float(wider[place])
        values[place] = replace(values[place], deviation=values[place].deviation * by, widened=by)
    slopes = {of: {name: rows * wider for name, rows in one.items()} for of, one in known.slopes.items()}
    more = known.number_slopes * wider if known.number_slopes.size else known.number_slopes
    free = Calibration(tuple(values), known.coordinates / wider, slopes, known.variance, more, known.taken)
    return replace(problem, calibration=free)


def _calibrated_freely(problem: Problem, effects: Sequence[Effect]) -> Problem:
    """The problem with its values fitted in common steps until none moves, `PASSES` at most."""
    for _ in range(PASSES):
        before = problem
        problem = recalibrated(problem, effects)
        if np.max(np.abs(moved(before, problem)), initial=0.0) < ENOUGH:
            break
    return problem
