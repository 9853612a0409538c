"""Effects and declared values fitted in turn: each bends what the other is told by."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from feeddrive.diagnosis.calibration.calibrate import PASSES, moved, recalibrated
from feeddrive.diagnosis.calibration.value_slopes import ENOUGH
from feeddrive.diagnosis.likelihood.fit import fitted_effects
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.effects.base import Effect


def stepped_together(
    problem: Problem, effects: Sequence[Effect], iterations: int = 12
) -> tuple[Problem, tuple[Effect, ...]]:
    """Declared values by slopes of where they are, and the effects beside them.

    Args:
        problem: with the values to begin from.
        effects: beside them.
        iterations: of the fit of the effects, at most.
    """
    there = recalibrated(problem, effects)
    return there, fitted_effects(there, effects, iterations)


def fitted_together(problem: Problem, effects: Sequence[Effect], passes: int = PASSES) -> tuple[Problem, list[Effect]]:
    """Effects and declared values fitted in turn until neither moves, or the recordings are no likelier for it.

    A pass counts that makes them likelier by half a nat, as one value off by a deviation: values that the recordings
    hardly tell apart never come to rest, and where slopes turn within a step passes lead to and fro.

    Args:
        problem: with the values to begin from.
        effects: beside them.
        passes: at most.
    """
    if problem.calibration is None:  # all declared values are exact
        return problem, [*fitted_effects(problem, effects)]
    for turn in range(passes):
        before, fitted = stepped_together(problem, effects)
        there = before.settled(fitted)
        assert there.calibration is not None
        variance = there.calibration.variance
        if turn and cost(problem, effects, variance) - cost(there, fitted, variance) <= variance:
            break
        problem, effects = there, fitted
        if np.max(np.abs(moved(before, there)), initial=0.0) < ENOUGH:
            break
    return problem, [*effects]


def cost(problem: Problem, effects: Sequence[Effect], variance: float) -> float:
    """What simulation leaves and declared values cost, a row being worth `variance`; slopes only promise it."""
    assert problem.calibration is not None
    left, values = problem.unwhitened(effects), problem.calibration.coordinates
    total = float(left @ left) + variance * float(values @ values)
    return total if np.isfinite(total) else np.inf
