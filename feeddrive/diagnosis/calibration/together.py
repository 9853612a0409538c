"""Effects and declared values fitted in turn: each bends what the other is told by."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from feeddrive.diagnosis.calibration.calibrate import PASSES, moved, recalibrated
from feeddrive.diagnosis.calibration.value_slopes import ENOUGH
from feeddrive.diagnosis.likelihood.fit import Fit, fit
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.effects.base import Effect


def stepped_together(problem: Problem, effects: Sequence[Effect], iterations: int = 12) -> tuple[Problem, Fit]:
    """Declared values by slopes of where they are, and the effects beside them.

    Args:
        problem: with the values to begin from.
        effects: beside them.
        iterations: of the fit of the effects, at most.
    """
    there = recalibrated(problem, effects)
    return there, fit(there, effects, iterations=iterations)


def fitted_together(problem: Problem, effects: Sequence[Effect], passes: int = PASSES) -> tuple[Problem, list[Effect]]:
    """Effects and declared values fitted in turn until neither moves.

    Args:
        problem: with the values to begin from.
        effects: beside them.
        passes: at most; values that the recordings hardly tell apart never come to rest.
    """
    if problem.calibration is None:  # all declared values are exact
        return problem, [*fit(problem, effects).effects]
    for _ in range(passes):
        before, fitted = stepped_together(problem, effects)
        effects = fitted.effects
        problem = before.settled(effects)
        if np.max(np.abs(moved(before, problem)), initial=0.0) < ENOUGH:
            break
    return problem, [*effects]


def cost(problem: Problem, effects: Sequence[Effect], variance: float) -> float:
    """What simulation leaves and declared values cost, a row being worth `variance`; slopes only promise it."""
    assert problem.calibration is not None
    left, values = problem.unwhitened(effects), problem.calibration.coordinates
    total = float(left @ left) + variance * float(values @ values)
    return total if np.isfinite(total) else np.inf
