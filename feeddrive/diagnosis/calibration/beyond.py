"""Declared values that an effect says to be other: named where they are beyond their tolerances, and said once."""

from __future__ import annotations

import math
from collections.abc import Sequence

from feeddrive.diagnosis.calibration.calibrate import TOLERANCE, calibrated_list, with_kept
from feeddrive.diagnosis.calibration.declared import CalibratedValue, as_effect, calibrated_values
from feeddrive.diagnosis.likelihood.fit import Fit, Problem
from feeddrive.effects.base import Effect, Value, number
from feeddrive.effects.chain.inertia_deviation import declared_inertia
from feeddrive.effects.friction.friction_deviation import FrictionDeviation
from feeddrive.plant.plant import Plant

SURE = 3.0
"""Deviations of what the recordings alone say by which a value must lie beyond its tolerance: one of 700 by chance, as
a dozen values are asked, once or twice a search."""


def beyond_tolerance(problem: Problem, found: Fit) -> tuple[Problem, Effect] | None:
    """The declared value that is surest to be beyond its tolerance, as an effect; None where none is asserted.

    Returns:
        The problem without it among the values that are fitted, and the effect.
    """
    able = [one for one in calibrated_list(problem, found) if one.value.name and one.beyond > SURE]
    if not able or problem.calibration is None:
        return None
    best = max(able, key=lambda one: one.beyond).value
    problem, (effect,) = said_by_effects(problem, [as_effect(problem.plant, best, 0.0)])
    return problem, effect


def said_by_effects(problem: Problem, effects: Sequence[Effect]) -> tuple[Problem, tuple[Effect, ...]]:
    """Every declared value that an effect of a set says to be other is said by it alone.

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
        at = [n for n, e in enumerate(result) if value.name and _is_said_by(value, e)]
        if at:
            result[at[-1]] = _joined(result[at[-1]], as_effect(plant, value, float(coordinate)))
            kept[i] = False
    return (problem if all(kept) else with_kept(problem, kept)), tuple(result)


def _is_said_by(value: CalibratedValue, effect: Effect) -> bool:
    place = str(effect.port) if isinstance(effect, FrictionDeviation) else effect.place
    return (effect.name, place) == (value.name, value.place)


def _joined(one: Effect, other: Effect) -> Effect:
    """Two deviations of a declared value as one: factors multiply, masses and inertias add."""
    joined: dict[str, Value] = {}
    for key in other.values:
        first, second = number(one.values[key]), number(other.values[key])
        joined[key] = first * second if key.endswith("factor") else first + second
    return one.with_values(**joined)


def is_within_tolerance(effect: Effect, plant: Plant) -> bool | None:
    """Whether an effect puts a declared value no further than its tolerance; None where it is about none."""
    about = [value for value in calibrated_values(plant) if value.name and _is_said_by(value, effect)]
    if not about:
        return None
    return all(abs(_coordinate(plant, value, effect)) <= TOLERANCE for value in about)


def _coordinate(plant: Plant, value: CalibratedValue, effect: Effect) -> float:
    """Logarithm of a value over the declared one, over its deviation, with an effect in; minus infinity below zero."""
    if isinstance(effect, FrictionDeviation):
        factor = number(effect.values["viscous_factor" if value.key.endswith("viscous") else "coulomb_factor"])
    elif "factor" in effect.values:
        factor = number(effect.values["factor"])
    else:
        declared = declared_inertia(plant.chain.values, value.place) if "inertia" in effect.values else value.declared
        factor = 1 + number(next(iter(effect.values.values()))) / declared
    return math.log(factor) / value.deviation if factor > 0 else -math.inf
