"""Free play or lost preload: which of the two laws of the nut's spring a set has.

The two say nearly the same of most recordings, and neither is straight in the declared values: values that were fitted
while the law was missing have gone to stand in for it, some of them several deviations away, and a play of the right
width is then worse than a softness fitted there. A play is chaotic besides, and predicts fewer samples. So each law
begins at the declared values, with the samples that it predicts and slopes of its own, and the two are compared by

    log E(B) - log E(A)   on the samples of both, each beside its own declared values
    + (m (1 + log max(q / c, 1)) c - |r_B|^2) / 2 v   on the m samples that B alone predicts; and the other way round

| symbol | meaning | unit |
|---|---|---|
| c, v | mean square of the better one on the samples of both, and its variance along their difference | 1 |
| q | mean square of A on the m samples, were it asked there: it says how wide its error is, and pays for that | 1 |
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from feeddrive.diagnosis.calibration.calibrate import ENOUGH, at_declared, moved, recalibrated
from feeddrive.diagnosis.certainty.imitations import imitations_of
from feeddrive.diagnosis.finding.attempt import JOINT_ITERATIONS, with_predictable
from feeddrive.diagnosis.finding.scene import scene_of
from feeddrive.diagnosis.likelihood.coordinates import at_its_limit
from feeddrive.diagnosis.likelihood.evidence import Evidence
from feeddrive.diagnosis.likelihood.fit import Fit, Problem, fit
from feeddrive.diagnosis.likelihood.set_evidence import log_odds, variance_along
from feeddrive.effects.base import Effect
from feeddrive.effects.transmission.backlash import Backlash
from feeddrive.effects.transmission.preload_loss import PreloadLoss
from feeddrive.errors import InputError
from feeddrive.typing import BoolArray

LAWS = (Backlash.name, PreloadLoss.name)

PASSES = 4
"""Times that samples, slopes and fit follow each other; from declared values each is near after two."""


@dataclass(frozen=True)
class Standing:
    """A set of effects with the samples that it predicts and its own declared values, to which it is fitted."""

    problem: Problem
    fit: Fit


def with_likelier_law(problem: Problem, fitted: Fit, whole: Sequence[Evidence], count: int) -> Standing | None:
    """The likelier of the sets with either law in the place of the one that a set has; None where it has none.

    Lost preload at the end of its range is free play, and stands for itself only where there is no fit of that.

    Args:
        problem: recordings.
        fitted: the set.
        whole: the recordings with all samples.
        count: candidates and starts that were tried.
    """
    places = [i for i, effect in enumerate(fitted.effects) if effect.name in LAWS]
    if len(places) != 1:
        return None
    place, law = places[0], fitted.effects[places[0]]
    others = [
        from_declared(problem, fitted.effects, place, start, whole)
        for start in (law, *imitations_of(law, problem.plant))
    ]
    able = [one for one in (_settled(problem, fitted.effects, whole), *others) if one is not None]
    inside = [one for one in able if not at_its_limit(one.fit.effects[place])]
    best: Standing | None = None
    for one in inside or able:
        if best is None or odds_between(best, one, count) > 0:
            best = one
    return best


def from_declared(
    problem: Problem, effects: Sequence[Effect], place: int, law: Effect, whole: Sequence[Evidence]
) -> Standing | None:
    """A set with a law of the spring at one place, fitted from the declared values on; None where it has no fit."""
    there = replace(at_declared(problem), evidence=tuple(whole))
    rest = [effect for i, effect in enumerate(effects) if i != place]
    (candidate,) = [one for one in problem.predictor.candidates if one.name == law.name]
    try:
        starts = [law, *(start for form in candidate.forms(scene_of(there, rest)) for start in form)]
        sets = [[*effects[:place], start, *effects[place + 1 :]] for start in starts]
        return _settled(there, min(sets, key=lambda one: _error(there, one)), whole)
    except InputError:
        return None


def _error(problem: Problem, effects: Sequence[Effect]) -> float:
    return fit(problem, effects, error_only=True).squared_error


def _settled(problem: Problem, effects: Sequence[Effect], whole: Sequence[Evidence]) -> Standing | None:
    """A set fitted with the samples that it predicts, and declared values with slopes beside it."""
    result = None
    try:
        for _ in range(PASSES):
            before = problem
            problem = recalibrated(with_predictable(replace(problem, evidence=tuple(whole)), effects), effects)
            result = Standing(problem, fit(problem, effects, iterations=JOINT_ITERATIONS))
            effects = result.fit.effects
            if _same_samples(before, problem) and (
                problem.calibration is None or np.max(np.abs(moved(before, problem)), initial=0.0) < ENOUGH
            ):
                break
    except InputError:
        return None
    return result if result is not None and math.isfinite(result.fit.squared_error) else None


def odds_between(first: Standing, second: Standing, count: int) -> float:
    """Logarithm of the odds for the second of two sets, each on the samples that it predicts.

    Args:
        first: a set.
        second: another.
        count: candidates and starts that were tried.
    """
    one, other = _within(first, second), _within(second, first)
    odds = log_odds(other.problem, one.fit, other.fit, count)
    if not math.isfinite(odds) or _same_samples(first.problem, second.problem):
        return odds
    left = min((one.fit, other.fit), key=lambda fitted: fitted.squared_error)
    level = left.squared_error / len(left.residual)
    excess = _beyond(second, first, level) - _beyond(first, second, level)
    return odds + 0.5 * excess / variance_along(other.problem, left, one.fit, other.fit)


def _within(one: Standing, other: Standing) -> Standing:
    """A set on the samples that another predicts as well."""
    pairs = zip(one.problem.evidence, other.problem.evidence, strict=True)
    problem = replace(one.problem, evidence=tuple(a.where_predictable(b.counted) for a, b in pairs))
    if _same_samples(one.problem, problem):
        return one
    return Standing(problem, fit(problem, one.fit.effects, iterations=JOINT_ITERATIONS))


def _beyond(one: Standing, other: Standing, level: float) -> float:
    """Squared error that a set spares on the samples that it alone predicts, the other saying how wide its error is."""
    alone = [a.counted & ~b.counted for a, b in zip(one.problem.evidence, other.problem.evidence, strict=True)]
    errors = [_errors_at(standing, alone) for standing in (one, other)]
    if not len(errors[0]) or level <= 0:
        return 0.0
    squares = [float(error @ error) for error in errors]
    wide = max(squares[1] / len(errors[1]) / level, 1.0)
    return len(errors[0]) * (1 + math.log(wide)) * level - squares[0] if math.isfinite(wide) else 0.0


def _errors_at(one: Standing, samples: Sequence[BoolArray]) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    """Error of a set over the noise at samples that it may not predict, (m,)."""
    pairs = zip(one.problem.evidence, samples, strict=True)
    there = replace(one.problem, evidence=tuple(replace(e, counted=rows) for e, rows in pairs))
    if not any(e.fit_rows.any() for e in there.evidence):
        return np.zeros(0)
    error = there.unwhitened(one.fit.effects)
    return error[: len(error) - len(there.numbers)]


def _same_samples(one: Problem, other: Problem) -> bool:
    return all(np.array_equal(a.counted, b.counted) for a, b in zip(one.evidence, other.evidence, strict=True))
