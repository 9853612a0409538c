"""Values of a plant found again from a recording of a controlled run, from starts that may be several times wrong.

    minimise  sum_c n_c ln( mean_i e_c,i^2 + s_c^2 )   over the logarithms of the values

| symbol | meaning | unit |
|---|---|---|
| e_c | simulated less recorded channel c | that of the channel |
| s_c, n_c | rms of its sensor noise, number of its samples | that of the channel, 1 |

The logarithm weighs each channel by the error that is left in it (the likelihood of a noise of unknown size, limited
below by the sensor's): far from the solution no channel drowns the others, near it both count by their noise. Gauss-
Newton by forward sensitivities, damped, with the second-order step along curved valleys (geodesic acceleration).

A stiffness that is far too high hardly shows, and others take its place: such a fit ends in a valley of its own. As the
noise is known, so is the error that a right fit leaves; where more is left the fit begins again, with one value moved
across its range, that first which the recording tells worst, and now and then at a draw from the whole range.
Source: Ljung, System Identification (1999), section 10.2; Transtrum, Sethna, arXiv:1201.5885 (2012), section 5.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.stats import qmc

from feeddrive.errors import InputError
from feeddrive.plant.plant import Plant
from feeddrive.simulate.error_descent import End, RunProblem
from feeddrive.simulate.recorded_run import RecordedRun
from feeddrive.typing import FloatArray

DRAWN = 2
"""Of so many descents one begins at a draw from the whole range; the others one value away from the best end so far."""

BETTER = 0.01
"""Share of the mean squared error by which an end must be better for descents to begin about it."""

SURE = 5.0
"""Standard errors of the mean squared error of white noise by which a right fit may exceed it."""


@dataclass(frozen=True)
class OutputErrorFit:
    """Values found.

    Attributes:
        plant: with them.
        values: parameter to value, SI.
        deviation: parameter to its relative standard deviation where the noise is white.
        mean_square: of the errors over the noise; 1 for a right fit.
        converged: whether that is what the noise leaves.
        starts: descents that were made.
        runs: simulations, those with derivatives counted once.
    """

    plant: Plant
    values: Mapping[str, float]
    deviation: Mapping[str, float]
    mean_square: float
    converged: bool
    starts: int
    runs: int


def fit_recorded_run(
    plant: Plant, recorded: RecordedRun, parameters: Sequence[str], factor: float = 4.0, starts: int = 24
) -> OutputErrorFit:
    """Fit values of a plant to a recorded run.

    Args:
        plant: with the values to start from.
        recorded: below the torque limit, at which the run would jump with its values.
        parameters: names as for `simulate_sensitivity`, of the plant; their values are above zero and stay so.
        factor: by which each may be wrong; later starts are within it, the descents themselves are not held to it.
        starts: descents at most.

    Returns:
        The best fit; whether it converged stands in it.

    Raises:
        InputError: an unknown parameter, a value that is not above zero, a start that cannot be simulated, no compiler.
    """
    problem = RunProblem(plant, recorded, tuple(parameters))
    begin, step = problem.logarithms(), math.log(factor)
    limit = 1 + SURE * math.sqrt(2 / problem.samples)
    draws = iter(qmc.Sobol(len(begin), seed=0).random(2 ** math.ceil(math.log2(max(starts, 2)))))
    best, made = problem.descent(begin), 1
    jumps = iter(_jumps(best, step) if best is not None else [])
    while made < starts and not (best is not None and best.mean_square < limit):
        jump = next(jumps, None) if made % DRAWN else None
        start = begin + step * (2 * next(draws) - 1) if jump is None else jump
        end = problem.descent(start)
        made += 1
        if end is not None and (best is None or end.mean_square < (1 - BETTER) * best.mean_square):
            best, jumps = end, iter(_jumps(end, step))
    if best is None:
        raise InputError("the recorded run cannot be simulated from any start", plant.name, "check the values")
    return _told(problem, best, best.mean_square < limit, made)


def _jumps(end: End, step: float) -> list[FloatArray]:
    """One logarithm moved at a time, down and up, that first which is told worst."""
    order = np.argsort(-end.spread)
    return [end.logs + sign * step * np.eye(len(order))[i] for i in order for sign in (-1, 1)]


def _told(problem: RunProblem, end: End, converged: bool, starts: int) -> OutputErrorFit:
    values = dict(zip(problem.names, map(float, np.exp(end.logs)), strict=True))
    # near a right fit the weights of the descent count the noise twice: what is left, and what limits it below
    deviation = dict(zip(problem.names, map(float, end.spread / math.sqrt(2)), strict=True))
    return OutputErrorFit(problem.at(end.logs), values, deviation, end.mean_square, converged, starts, problem.runs)
