"""A fault of the recorder that alone explains what the declared machine does not: asked before any effect.

A torque in another unit, or times of another clock, is further from the declared machine than any effect. A search
that begins beside it takes effect after effect, each for a part of the fault. So where the machine as declared leaves
much, the size c of each fault (`suspects`) is fitted beside it, every declared value as it is declared:

    channel_gain    exp(c) = p'm / p'p of predicted p and measured torque m, as the torque is linear in its gain
    clock_rate      Gauss-Newton steps of c, each halved until it leaves less

A fault is tried that takes the larger part of the squared error, and counts where the declared values then leave noise.
"""

from __future__ import annotations

import math
from dataclasses import replace

from feeddrive.diagnosis.likelihood.cross_validation import Comparison
from feeddrive.diagnosis.likelihood.fit import fit
from feeddrive.diagnosis.likelihood.problem import LEVEL, UNEXPLAINED, Problem
from feeddrive.diagnosis.likelihood.tolerances import SURE
from feeddrive.diagnosis.suspicion.as_recorded import contradiction, error_over_noise
from feeddrive.diagnosis.suspicion.suspects import (
    CLOCK,
    GAIN,
    LEAST,
    MOST,
    STEP,
    Suspect,
    at_other_clock,
    can_be_asked,
    predicted_torque,
)
from feeddrive.typing import FloatArray

SHARE = 0.5
"""Share of the squared error that a fault leaves at most: beside one that takes less, something else is larger."""

STEPS = 8
"""Steps of a clock, and halvings of one, at most: times that are four times as long take six."""


def faults_alone(problem: Problem) -> list[Suspect]:
    """Faults of the recorder that take most of what the declared machine leaves, the best first.

    Args:
        problem: recordings, the declared values calibrated and nothing found. Where these explain them, no fault is.
    """
    if not can_be_asked(problem, ()) or _is_explained(problem):
        return []
    declared = replace(problem.plain, calibration=None)
    residual = declared.unwhitened(())
    before = float(residual @ residual)
    least = {**LEAST, GAIN: max(LEAST[GAIN], _torque_tolerance(problem))}
    asked = filter(None, (_gain(declared, residual), _clock(declared, residual)))
    return [
        Suspect(kind, size, comparison=Comparison(1 - left / before, 0.0, 0.0))
        for left, size, kind in sorted(asked)
        if left < SHARE * before and least[kind] < abs(size) <= MOST[kind]
    ]


def _is_explained(problem: Problem) -> bool:
    """Whether declared values within their tolerances, and no effect, leave no more than noise.

    Args:
        problem: the declared values calibrated and nothing found.
    """
    return problem.plain_error(()) < UNEXPLAINED and contradiction(problem, fit(problem, ())) <= SURE**2


def alone_explains(mended: Problem, problem: Problem) -> bool:
    """Whether mended recordings leave no more than noise, and contradict the declared values far less than before.

    One that leaves more is asked beside what is found (`suspects`): without the effects that are there, a clock takes
    some of what they do.

    Args:
        mended: the declared values calibrated and nothing found; a value may be beyond its tolerance beside a fault.
        problem: the recordings as they are, so too.
    """
    if error_over_noise(mended, problem) >= 1 / LEVEL**2:
        return False
    return contradiction(mended, fit(mended, ())) <= max(SURE**2, SHARE * contradiction(problem, fit(problem, ())))


def _torque_tolerance(problem: Problem) -> float:
    """Logarithm of a factor that the torque may have as declared; 0 where it is exact."""
    values = () if problem.calibration is None else problem.calibration.values
    return max((math.log1p(one.tolerance) for one in values if one.key == "torque_constant"), default=0.0)


def _gain(declared: Problem, residual: FloatArray) -> tuple[float, float, str] | None:
    """Squared error that is left, and c, of a torque that is recorded exp(c) times as large."""
    predicted = predicted_torque(declared, ())
    square = float(predicted @ predicted)
    share = float(predicted @ residual) / square if square > 0 else -1.0
    if not share > -1:  # of the other sign: nothing that is mended by a factor above none
        return None
    left = residual - share * predicted
    return float(left @ left), math.log1p(share), GAIN


def _clock(declared: Problem, residual: FloatArray) -> tuple[float, float, str] | None:
    """Squared error that is left, and c, of times that are recorded exp(c) times as long."""
    size, left = 0.0, float(residual @ residual)
    for _ in range(STEPS):
        there = at_other_clock(declared, size + STEP)
        slope = (residual - there.unwhitened(())) / STEP
        square = float(slope @ slope)
        step = float(slope @ residual) / square if square > 0 else 0.0
        step = min(max(step, -MOST[CLOCK] - size), MOST[CLOCK] - size)
        for _ in range(STEPS):
            other = at_other_clock(declared, size + step).unwhitened(())
            if float(other @ other) < left:
                break
            step /= 2
        else:
            break
        gained = 1 - float(other @ other) / left
        size, residual, left = size + step, other, float(other @ other)
        if abs(step) < LEAST[CLOCK] or gained < 1 / STEPS:
            break
    return left, size, CLOCK
