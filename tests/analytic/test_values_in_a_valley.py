"""Declared values that stand in for each other go back together, along a valley that no straight step stays in."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from feeddrive.diagnosis.calibration.calibrate import _without_unseen
from feeddrive.diagnosis.calibration.calibration import Calibration, Whitener, whitener
from feeddrive.diagnosis.calibration.declared import CalibratedValue
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.effects.base import Effect
from feeddrive.typing import FloatArray

ROWS, SIZE = 400, 200.0
DEVIATIONS = np.array([0.7, 0.05, 0.025, 0.025, 0.1])
"""Motor inertia, free of its tolerance, screw inertia, table mass, torque constant, friction."""

RANDOM = np.random.default_rng(11)
MOTION, SIGN = RANDOM.standard_normal((2, ROWS))
PARTS = np.array([MOTION, MOTION + 0.02 * RANDOM.standard_normal(ROWS), MOTION + 0.02 * SIGN**2, SIGN])


def torque(logarithms: FloatArray) -> FloatArray:
    """Torque over its noise: two inertias and a mass that are nearly alike, a friction, and a torque constant."""
    motor, screw, mass, constant, friction = np.exp(logarithms).tolist()
    result: FloatArray = SIZE * (np.array([motor, screw, mass, friction]) @ PARTS) / constant
    return result


MEASURED = torque(np.log([2.0, 1.0, 1.0, 1.0, 1.0])) + RANDOM.standard_normal(ROWS)


@dataclass(frozen=True)
class Valley(Problem):
    """A problem in closed form."""

    def unwhitened(self, effects: Sequence[Effect]) -> FloatArray:
        """Measured less predicted."""
        assert self.calibration is not None
        return MEASURED - torque(DEVIATIONS * self.calibration.coordinates)

    def possible(self, effects: Sequence[Effect]) -> bool:
        """No friction that pushes."""
        return True

    @property
    def whitener(self) -> Whitener:  # type: ignore[override]
        """Slopes as they are."""
        assert self.calibration is not None
        at, steps = DEVIATIONS * self.calibration.coordinates, 1e-6 * np.diag(DEVIATIONS)
        columns = np.column_stack([(torque(at + step) - torque(at - step)) / 2e-6 for step in steps])
        return whitener(columns, self.calibration.coordinates, self.calibration.variance)


def valley(coordinates: FloatArray) -> Valley:
    """The problem at some coordinates."""
    nothing: Any = SimpleNamespace()
    values = tuple(CalibratedValue(str(i), "", "1", 1.0, float(one)) for i, one in enumerate(DEVIATIONS))
    return Valley(nothing, (), nothing, calibration=Calibration(values, coordinates, {}, 1.0))


def test_values_go_back_within_their_tolerances_once_what_they_stood_in_for_is_free() -> None:
    # the screw has taken what the motor lacks: what they ask for is straight in the inertias, a scale in the logarithms
    start = np.log([1.0, 2.0, 1.0, 1.0, 1.0])
    problem: Problem = valley(start / DEVIATIONS)
    for _ in range(8):
        problem = problem.stepped((), problem.unwhitened(()))
    assert problem.calibration is not None
    found = problem.calibration.coordinates
    assert np.max(np.abs(found[1:])) < 2  # a tolerance
    assert np.exp(DEVIATIONS[0] * found[0]) == pytest.approx(2.0, rel=0.1)


def test_a_value_is_seen_by_what_the_noise_leaves_of_it_whatever_is_missing_still() -> None:
    problem = valley(np.zeros(5))
    assert problem.calibration is not None
    far_off = replace(problem, calibration=replace(problem.calibration, variance=1e9))
    kept = _without_unseen(far_off).calibration
    assert kept is not None and len(kept.values) == 5
