"""Free play or lost preload: which of the two laws of the nut's spring a set has.

The two say nearly the same of most recordings, and neither is straight in the declared values: values that were fitted
while the law was missing have gone to stand in for it, some of them several deviations away, and a play of the right
width is then worse than a softness fitted there. A play is chaotic besides, and predicts fewer samples. So each law
begins at the declared values, with the samples that it predicts and slopes of its own, and the likelier is taken
(`standing.odds_between`).
"""

from __future__ import annotations

import math
from collections.abc import Container, Sequence

import numpy as np

from feeddrive.diagnosis.calibration.calibrate import at_declared, moved, recalibrated
from feeddrive.diagnosis.calibration.value_slopes import ENOUGH
from feeddrive.diagnosis.certainty.imitations import imitations_of, lost_motion, softened
from feeddrive.diagnosis.finding.attempt import JOINT_ITERATIONS, with_predictable
from feeddrive.diagnosis.finding.scene import scene_of
from feeddrive.diagnosis.likelihood.coordinates import LEAST, at_its_limit, read_coordinates
from feeddrive.diagnosis.likelihood.fit import Fit, error_of, fit
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.likelihood.set_evidence import variance_along
from feeddrive.diagnosis.likelihood.standing import Standing, odds_between, regained, same_samples
from feeddrive.effects.base import Effect, number
from feeddrive.effects.transmission.backlash import Backlash
from feeddrive.effects.transmission.preload_loss import PreloadLoss
from feeddrive.errors import InputError

LAWS = (Backlash.name, PreloadLoss.name)

TOLD = math.log(20.0)
"""Logarithm of the odds from which the force of a lost preload, by the samples alone, or the frequency of a mode is
told: as names are."""

BEYOND = 10.0
"""Force over the greatest that is transmitted, beyond which no preload is regained in a recording."""

PASSES = 4
"""Times that samples, slopes and fit follow each other; from declared values each is near after two."""


def with_likelier_law(problem: Problem, fitted: Fit, count: int, denied: Container[str] = ()) -> Standing | None:
    """The likelier of the sets with either law in the place of the one that a set has; None where it has none.

    Lost preload at the end of its range is free play, and stands for itself only where there is no fit of that; so does
    one that is not told from that end.

    Args:
        problem: recordings.
        fitted: the set.
        count: candidates and starts that were tried.
        denied: names that are not asked for.
    """
    places = [i for i, effect in enumerate(fitted.effects) if effect.name in LAWS]
    if len(places) != 1:
        return None
    place, law = places[0], fitted.effects[places[0]]
    others = [
        from_declared(problem, fitted.effects, place, start)
        for start in (law, *imitations_of(law, problem.plant))
        if start.name not in denied
    ]
    able = [one for one in (_settled(problem, fitted.effects), *others) if one is not None]
    inside = [one for one in able if not at_its_limit(one.fit.effects[place])]
    best = _likeliest(inside or able, count)
    play = _likeliest([one for one in able if isinstance(one.fit.effects[place], Backlash)], count)
    return best if best is None or play is None or _carries(best, place, count) else play


def _likeliest(sets: Sequence[Standing], count: int) -> Standing | None:
    best: Standing | None = None
    for one in sets:
        if best is None or odds_between(best, one, count) > 0:
            best = one
    return best


def _carries(there: Standing, place: int, count: int) -> bool:
    """Whether a lost preload is told, 20 to 1, from itself at the ratio at which it is a free play; so is none other.

    A play whose edges are soft lies between a play of sharp edges and such a one: what is nearer to a lost preload than
    to sharp edges is none yet, its ratio tells.
    """
    play = hardly_carrying(there.problem, there.fit, place)
    return play is None or odds_between(Standing(there.problem, play), there, count) > TOLD


def hardly_carrying(problem: Problem, found: Fit, place: int) -> Fit | None:
    """A set fitted with its lost preload at the ratio at which it is a free play; None where none is lost."""
    law, plant = found.effects[place], problem.plant
    if not isinstance(law, PreloadLoss):
        return None
    lost = lost_motion(number(law.values["ratio"]), number(law.values["force"]), plant)
    if not lost > 0:  # fitted to as stiff as declared
        return None
    play = softened(lost, LEAST[law.name, "ratio"], plant)
    ratio = len(read_coordinates(found.effects[:place], plant)) + [*play.values].index("ratio")
    effects = [*found.effects[:place], play, *found.effects[place + 1 :]]
    return fit(problem, effects, iterations=JOINT_ITERATIONS, still=[ratio])


def from_declared(problem: Problem, effects: Sequence[Effect], place: int, law: Effect) -> Standing | None:
    """A set with a law of the spring at one place, fitted from the declared values on; None where it has no fit."""
    there = at_declared(regained(problem, ()))
    rest = [effect for i, effect in enumerate(effects) if i != place]
    forms = [one.forms for one in problem.predictor.candidates if one.name == law.name]
    try:
        scene = scene_of(there, rest)
        starts = [law, *(start for of in forms for form in of(scene) for start in form)]
        sets = [[*effects[:place], start, *effects[place + 1 :]] for start in starts]
        return _settled(there, min(sets, key=lambda one: error_of(there, one)))
    except InputError:
        return None


def play_from_declared(problem: Problem, found: Fit) -> Standing | None:
    """A set with free play beside it, begun at the declared values; None where it leaves more there than the set does.

    Values fitted without the play stand in for it, be it within their tolerances: a table that hangs leaves its flank
    for some hundredths of a second, and beside such values no width lowers the error.
    """
    play = next((one for one in problem.predictor.candidates if one.name == Backlash.name), None)
    there = at_declared(problem)
    try:
        scene = scene_of(there, found.effects)
        if play is None or play.needs(scene) or any(effect.name in LAWS for effect in found.effects):
            return None
        sets = [[*found.effects, start] for form in play.forms(scene) for start in form]
        best = min(sets, key=lambda one: error_of(there, one))
        own = with_predictable(problem, best)
        if not error_of(at_declared(own), best) < error_of(own, found.effects):
            return None
    except InputError:
        return None
    return _settled(there, best)


def _settled(problem: Problem, effects: Sequence[Effect]) -> Standing | None:
    """A set fitted with the samples that it predicts, and declared values with slopes beside it."""
    result = None
    try:
        for _ in range(PASSES):
            before = problem
            problem = recalibrated(with_predictable(regained(problem, ()), effects), effects)
            result = Standing(problem, fit(problem, effects, iterations=JOINT_ITERATIONS))
            effects = result.fit.effects
            if same_samples(before, problem) and (
                problem.calibration is None or np.max(np.abs(moved(before, problem)), initial=0.0) < ENOUGH
            ):
                break
    except InputError:
        return None
    return result if result is not None and math.isfinite(result.fit.squared_error) else None


def soft_everywhere(problem: Problem, found: Fit) -> list[Effect]:
    """Lost preload of a set, where a spring as soft under every force would do: that is `stiffness_deviation`.

    Its force then is a start that no data have moved, for those beyond it were hardly met.
    """
    result: list[Effect] = []
    for place, effect in enumerate(found.effects):
        if not isinstance(effect, PreloadLoss) or at_its_limit(effect):
            continue
        greatest = max(float(np.max(np.abs(run.force))) for run in scene_of(problem, found.effects).runs)
        beyond = effect.with_values(force=BEYOND * max(greatest, number(effect.values["force"])))
        soft = fit(problem, [*found.effects[:place], beyond, *found.effects[place + 1 :]], iterations=JOINT_ITERATIONS)
        excess = soft.squared_error - found.squared_error
        if excess < 2 * TOLD * variance_along(problem, min(found, soft, key=_square), found, soft):
            result.append(effect)
    return result


def _square(one: Fit) -> float:
    return one.squared_error
