"""Values of a parameter recording by recording, with intervals, and their difference."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from feeddrive.diagnosis.certainty.uncertainty import certainty
from feeddrive.diagnosis.finding.materiality import is_material
from feeddrive.diagnosis.likelihood.coordinates import Sine, TwoHeats, coordinates_of, write_coordinates
from feeddrive.diagnosis.likelihood.fit import Fit, Problem
from feeddrive.diagnosis.recordings.recordings import Target, in_recording
from feeddrive.effects.base import Effect
from feeddrive.typing import FloatArray

LEAST_CHANGE = 0.05
"""Change over the larger value from which a parameter without a physical minimum of its own has changed."""

STEP = 1e-6
"""Step of the differences in coordinates of size one."""


@dataclass(frozen=True)
class Value:
    """A number and the half width of its 95 % interval, SI."""

    value: float
    half: float

    @property
    def ci95(self) -> tuple[float, float]:
        """The interval."""
        return self.value - self.half, self.value + self.half


@dataclass(frozen=True)
class Compared:
    """One parameter in one recording, in another, and the difference of the first from the second."""

    key: str
    unit: str
    here: Value
    there: Value
    difference: Value


def compared_values(problem: Problem, fitted: Fit, target: Target, here: int, there: int | None) -> list[Compared]:
    """The parameters of a target in one recording and in another, with intervals.

    Args:
        problem: that was fitted.
        fitted: effects with shifts.
        target: what differs.
        here: number of the recording.
        there: number of the other one; None for those without shifts.
    """
    covariance = certainty(problem, fitted).half_covariance
    found = []
    for key in keys_of(fitted.effects, problem, target):
        first = _values(problem, fitted, target, key, here)
        second = _values(problem, fitted, target, key, there)
        slope = _slopes(problem, fitted, lambda vector, k=key: np.array(  # type: ignore[misc]
            [_value_at(problem, fitted, target, k, here, vector), _value_at(problem, fitted, target, k, there, vector)]
        ))  # fmt: skip
        rows = np.vstack([slope, slope[:1] - slope[1:]])
        widths = np.sqrt(np.maximum(np.einsum("ij,jk,ik->i", rows, covariance, rows), 0.0))
        effect = _targeted(fitted.effects, problem, target, here)
        unit = effect.parameter(key).unit
        numbers = (first, second, first - second)
        found.append(Compared(key, unit, *(Value(v, float(w)) for v, w in zip(numbers, widths, strict=True))))
    return found


def keys_of(effects: Sequence[Effect], problem: Problem, target: Target) -> tuple[str, ...]:
    """Parameters that the coordinate of a target stands for; none of a curve."""
    effect = _targeted(effects, problem, target, None)
    coordinate = coordinates_of(effect, problem.plant)[target.coordinate]
    if isinstance(coordinate, Sine):
        return ("amplitude", "phase")
    if isinstance(coordinate, TwoHeats):
        return (coordinate.key, coordinate.share)
    return () if isinstance(effect.values[coordinate.key], tuple) else (coordinate.key,)


def material_difference(
    problem: Problem, effects: Sequence[Effect], target: Target, number: int, other: int | None = None
) -> bool:
    """Whether a parameter differs between two recordings by as much as matters; None for one without shifts."""
    here = _targeted(effects, problem, target, number)
    there = _targeted(effects, problem, target, other)
    coordinate = coordinates_of(there, problem.plant)[target.coordinate]
    a, b = np.array(coordinate.read(here)), np.array(coordinate.read(there))
    if not np.linalg.norm(a - b) >= LEAST_CHANGE * max(np.linalg.norm(a), np.linalg.norm(b)) * _certain(here):
        return False
    key = getattr(coordinate, "key", "")
    values = here.values.get(key), there.values.get(key)
    if not all(isinstance(value, float) for value in values):
        return True
    # the difference as an effect of its own meets the physical minimum, the other parameters being neutral
    neutral = {p.key: p.default for p in here.parameters if p.default is not None and p.key in here.values}
    change = float(values[0]) - float(values[1])  # type: ignore[arg-type]
    alone = here.with_values(**{**neutral, key: change + neutral.get(key, _zero(here))})
    return is_material(alone, problem.plant)


def _certain(effect: Effect) -> float:
    """Levels have a physical minimum of their own, smaller than that of other parameters."""
    return 0.0 if effect.name in ("friction_deviation", "constant_force", "payload", "stiffness_deviation") else 1.0


def _zero(effect: Effect) -> float:
    return 1.0 if effect.name == "stiffness_deviation" else 0.0


def _targeted(effects: Sequence[Effect], problem: Problem, target: Target, number: int | None) -> Effect:
    """The effect of a target as it is in a recording."""
    return [e for e in in_recording(effects, problem.plant, number) if target.meets(e)][-1]


def _values(problem: Problem, fitted: Fit, target: Target, key: str, number: int | None) -> float:
    return float(_targeted(fitted.effects, problem, target, number).values[key])  # type: ignore[arg-type]


def _value_at(
    problem: Problem, fitted: Fit, target: Target, key: str, number: int | None, vector: FloatArray
) -> float:  # fmt: skip
    effects = write_coordinates(fitted.effects, problem.plant, vector)
    return float(_targeted(effects, problem, target, number).values[key])  # type: ignore[arg-type]


def _slopes(problem: Problem, fitted: Fit, values: Callable[[FloatArray], FloatArray]) -> FloatArray:
    """Slope of values with the coordinates of the fit, (values, k)."""
    base = values(fitted.coordinates)
    columns = [(values(fitted.coordinates + STEP * unit) - base) / STEP for unit in np.eye(len(fitted.coordinates))]
    return np.column_stack(columns)
