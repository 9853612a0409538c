"""What a fitted set says against its own names: ends of what is physical, intervals around none, pushing friction.

Each question is asked of all effects of a set at once, and answered per effect: a sentence where it speaks against the
name, empty where it does not.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from scipy.special import chdtri

from feeddrive.diagnosis.calibration.stated import is_within_tolerance
from feeddrive.diagnosis.certainty.one_sided import one_sided
from feeddrive.diagnosis.certainty.profile import size_beside_shape
from feeddrive.diagnosis.certainty.uncertainty import Certainty, certainty, certainty_along
from feeddrive.diagnosis.likelihood.coordinates import (
    LEFT,
    absent_coordinates,
    at_an_end,
    at_its_limit,
    read_coordinates,
    write_coordinates,
)
from feeddrive.diagnosis.likelihood.fit import Fit
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.recordings.recordings import is_shift, without_shifts
from feeddrive.effects.base import ChainEffect, Effect, FrictionEffect
from feeddrive.typing import FloatArray, IntegerArray
from feeddrive.units.quantity import format_quantity

AROUND_NONE = "its interval holds no effect at all"
"""Why an effect is denied that the fitted data do not tell from none."""


def ends_reached(problem: Problem, fitted: Fit) -> list[str]:
    """Per effect, a sentence on the first value at an end of what is physical; empty where there is none.

    A value that is known to a factor has no such end: there the law is another one (`at_its_limit`).
    """
    result = []
    too_little = _leaves_too_little(problem, fitted.effects)
    for effect in fitted.effects:
        # a sine has no end in either component, and one in both
        tops = [p for p in effect.parameters if p.key == "amplitude" and np.isfinite(p.maximum)]
        topped = any(float(effect.values[p.key]) >= p.maximum for p in tops if "phase" in effect.values)  # type: ignore[arg-type]
        ended = topped or at_an_end(effect, problem.plant) or (too_little and isinstance(effect, ChainEffect))
        ended = ended or at_its_limit(effect)
        result.append(_end_sentence(effect) if ended and not is_shift(effect) else "")
    return result


def _leaves_too_little(problem: Problem, effects: Sequence[Effect]) -> bool:
    """Whether several effects together leave less of a mass, an inertia or a stiffness than one may."""
    if not problem.plant.has_motion:
        return False
    declared = problem.plant.chain_values()
    after = problem.plant.with_effects(*without_shifts(effects)).chain_values()
    kinds = ("mass", "inertia", "stiffness")
    # rounding of the sum aside
    return any(after[key] < LEFT * declared[key] * (1 - 1e-9) for key in declared if key.endswith(kinds))


def _end_sentence(effect: Effect) -> str:
    values = ", ".join(
        f"{key.replace('_', ' ')} {format_quantity(value, effect.parameter(key).unit)}"
        for key, value in effect.values.items()
        if isinstance(value, float)
    )
    return f"a value of it ran to the end of what is physical ({values}), which is no estimate"


def sizes_around_none(problem: Problem, fitted: Fit) -> list[str]:
    """Per effect, a sentence where the 95 % intervals of all its sizes hold the absent effect; else empty.

    Of components and nodes that belong together the whole is asked: their squares over their variances, against the
    same quantile. Beside none of it the place of a tight place means nothing, and whether it is there is asked with
    its shape as it is; which shape the likelihood of the set has paid for: Davies, Biometrika 64 (1977) 247. Its
    interval is then that of the likelihood (`profile`). Of a size whose slope tells nothing that is asked at once
    (`one_sided`).
    """
    if not fitted.effects:
        return []
    known = certainty(problem, fitted)
    absent, groups = absent_coordinates(fitted.effects, problem.plant)
    beyond = fitted.coordinates - absent
    result, at = [], 0
    for place, effect in enumerate(fitted.effects):
        count = len(read_coordinates([effect], problem.plant))
        places = np.arange(at, at + count)
        sizes = sorted({int(groups[i]) for i in places if not math.isnan(absent[i])})
        nodes = [np.flatnonzero(groups == group) for group in sizes]
        shapes = [int(i) for i in places if math.isnan(absent[i])]
        sure = any(_is_not_none(known, beyond, group) for group in nodes) or not sizes or is_shift(effect)
        if not sure and size_beside_shape(problem, fitted, place) is not None:
            there = certainty(problem, fitted, shapes)
            sure = any(_is_not_none(there, beyond, group) for group in nodes)
        sure = sure or any(_is_apart(problem, fitted, beyond, group) for group in nodes if len(group) > 1)
        denied = not sure and one_sided(problem, fitted, place) is None
        result.append(AROUND_NONE if denied else "")
        at += count
    return result


def values_within_tolerance(problem: Problem, fitted: Fit) -> list[str]:
    """Per effect, a sentence where its 95 % intervals hold declared values within their tolerances; else empty.

    A declared value is called other only beyond its tolerance, and so is its interval.
    """
    if all(is_within_tolerance(effect, problem.plant) is None for effect in fitted.effects):
        return [""] * len(fitted.effects)
    absent, _ = absent_coordinates(fitted.effects, problem.plant)
    half = np.sqrt(np.diag(certainty(problem, fitted).half_covariance))
    nearest = fitted.coordinates - np.clip(fitted.coordinates - absent, -half, half)
    known = np.where(np.isfinite(nearest), nearest, fitted.coordinates)
    ends = write_coordinates(fitted.effects, problem.plant, known)
    return [
        "its interval holds the declared value within its tolerance" if is_within_tolerance(end, problem.plant) else ""
        for end in ends
    ]


def _is_not_none(known: Certainty, beyond: FloatArray, group: IntegerArray) -> bool:
    """Whether a group of coordinates is distinguished from none."""
    part = known.half_covariance[np.ix_(group, group)]
    if len(group) == 1:
        return bool(abs(beyond[group[0]]) > math.sqrt(part[0, 0]))
    return _is_far(beyond[group], part)


def _is_apart(problem: Problem, fitted: Fit, beyond: FloatArray, group: IntegerArray) -> bool:
    """Whether a group of coordinates is distinguished from none along the directions that the recordings tell apart."""
    directions, known = certainty_along(problem, fitted, group)
    return _is_far(directions.T @ beyond[group], known.half_covariance)


def _is_far(beyond: FloatArray, half_covariance: FloatArray) -> bool:
    """Whether coordinates, (n,), are further from none than chance takes them, all together."""
    half = np.sqrt(np.diag(half_covariance))
    known = half > 0
    alike = half_covariance[np.ix_(known, known)] / np.outer(half[known], half[known])
    over = beyond[known] / half[known]
    # half widths are 1.96 standard deviations
    square = float(over @ np.linalg.pinv(alike, hermitian=True) @ over) * 1.96**2
    return square > float(chdtri(np.count_nonzero(known), 0.05))


def friction_that_pushes(problem: Problem, effects: Sequence[Effect]) -> list[str]:
    """Per effect, a sentence where friction pushes the axis with it and not without; where none is alone, for all."""
    there = problem.settled(effects)
    if there.possible(effects):
        return [""] * len(effects)
    rubs = [isinstance(effect, FrictionEffect) for effect in effects]
    alone = [rub and there.possible([*effects[:i], *effects[i + 1 :]]) for i, rub in enumerate(rubs)]
    told = alone if any(alone) else rubs
    return ["with it friction would push the axis somewhere within its reach" if one else "" for one in told]
