"""Declared values that effects say to be other: each stated once, by the effect alone or as a fitted value."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from feeddrive.diagnosis.calibration.calibrate import recalibrated, with_kept
from feeddrive.diagnosis.calibration.calibration import Calibration
from feeddrive.diagnosis.calibration.declared import (
    CalibratedValue,
    as_effect,
    calibrated_values,
    is_said_by,
    said_share,
)
from feeddrive.diagnosis.calibration.known import TOLERANCE
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.likelihood.standing import regained
from feeddrive.effects.base import Effect, Value, number
from feeddrive.plant.plant import Plant
from feeddrive.typing import FloatArray


def given_back(problem: Problem, effect: Effect) -> Problem:
    """The problem with the declared value that an effect said to be other fitted within its tolerance again.

    It begins as declared, with slopes of zero: they are to be taken anew (`calibrate.recalibrated`).
    """
    known = problem.calibration
    if known is None:
        return problem
    old = {value.key: i for i, value in enumerate(known.values)}
    values = [v for v in calibrated_values(problem.plant) if v.key in old or (v.name and is_said_by(v, effect))]
    values = [known.values[old[v.key]] if v.key in old else v for v in values]
    from_old = [old.get(value.key, len(old)) for value in values]  # the last column is one of zeros

    def placed(rows: FloatArray) -> FloatArray:
        return np.pad(rows, [(0, 0)] * (rows.ndim - 1) + [(0, 1)])[..., from_old]

    slopes = {of: {name: placed(rows) for name, rows in one.items()} for of, one in known.slopes.items()}
    numbers = placed(known.number_slopes) if len(known.number_slopes) else np.zeros((0, len(values)))
    taken = known.taken if len(values) == len(old) else None
    given = Calibration(tuple(values), placed(known.coordinates), slopes, known.variance, numbers, taken)
    return replace(problem, calibration=given)


def without_effects(problem: Problem, gone: Sequence[Effect], rest: Sequence[Effect]) -> Problem:
    """The problem once some effects are out of a set: declared values that they stated are fitted within tolerance.

    Left as declared they would be exact, and what they are off by would go into whatever is in their place. Samples
    that a free play among them left unpredictable are to be predicted again.

    Args:
        problem: with the values that were fitted beside all effects.
        gone: effects that are out.
        rest: those that remain.
    """
    problem = regained(problem, rest)
    known = problem.calibration
    for effect in gone:
        if not any(_is_same(effect, other) for other in rest):
            problem = given_back(problem, effect)
    if known is None or problem.calibration is None or len(problem.calibration.values) == len(known.values):
        return problem
    return recalibrated(problem, rest)


def _is_same(one: Effect, other: Effect) -> bool:
    return (one.name, one.port, one.place) == (other.name, other.port, other.place)


def said_by_effects(problem: Problem, effects: Sequence[Effect]) -> tuple[Problem, tuple[Effect, ...]]:
    """Every declared value that an effect of a set says to be other is stated by it alone.

    Value and effect would be one unknown twice, each free to take back what the other says.

    Returns:
        The problem without these values among those that are fitted, and the effects with what they were fitted to:
        together the machine that it was.
    """
    known, plant = problem.calibration, problem.plant
    if known is None or not known.values:
        return problem, tuple(effects)
    result, kept = list(effects), [True] * len(known.values)
    for i, (value, coordinate) in enumerate(zip(known.values, known.coordinates, strict=True)):
        at = [n for n, e in enumerate(result) if value.name and is_said_by(value, e)]
        if at:
            result[at[-1]] = _joined(result[at[-1]], as_effect(plant, value, float(coordinate)))
            kept[i] = False
    return (problem if all(kept) else with_kept(problem, kept)), tuple(result)


def _joined(one: Effect, other: Effect) -> Effect:
    """Two deviations of a declared value as one, in its range: factors multiply, masses and inertias add."""
    joined: dict[str, Value] = {}
    for key in other.values:
        first, second = number(one.values[key]), number(other.values[key])
        ends, value = one.parameter(key), first * second if key.endswith("factor") else first + second
        joined[key] = min(max(value, ends.minimum), ends.maximum)
    return one.with_values(**joined)


def is_within_tolerance(effect: Effect, plant: Plant) -> bool | None:
    """Whether an effect puts a declared value no further than its tolerance; None where it is about none."""
    values = calibrated_values(plant) if plant.has_motion else ()
    about = [value for value in values if value.name and is_said_by(value, effect)]
    if not about:
        return None
    return all(abs(coordinate_said(plant, value, effect)) <= TOLERANCE for value in about)


def coordinate_said(plant: Plant, value: CalibratedValue, effect: Effect) -> float:
    """Logarithm of a value over the declared one, over its deviation, with an effect in; minus infinity below zero."""
    _, share, _ = said_share(plant, value, effect)
    return math.log(share) / value.deviation if share > 0 else -math.inf
