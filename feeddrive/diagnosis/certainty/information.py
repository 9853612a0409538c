"""What recordings can tell of parameters at best: Fisher's information and the bound of Cramér and Rao.

    I = sum over recordings of kappa J' J,     cov(any unbiased estimate) >= I^-1

J: slopes of the prediction over the sensor noise in the band, at thinned samples; kappa: independent values per thinned
sample (`noise_colour.independent_share`), so that what the filter takes of white noise does not count as knowledge.
Valid where the noise of the compared channels is white, and the prediction misses nothing.
Source: Kay, Fundamentals of Statistical Signal Processing I (1993), section 3.9 (coloured noise).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from feeddrive.diagnosis.certainty.noise_colour import independent_share
from feeddrive.diagnosis.likelihood.coordinates import read_coordinates, spread_to_values
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.likelihood.slopes import jacobian_of
from feeddrive.effects.base import Effect
from feeddrive.typing import FloatArray

ROUNDED = 1e-11
"""Eigenvalue of a normal matrix of columns of length one, below which it is their rounding: slopes are differences of
simulations, true to some parts in ten millions, and the level of a curve that counts about its mean is in no row."""


def inverse_information(normal: FloatArray) -> FloatArray:
    """Inverse of a normal matrix (k, k), its columns brought to one length first; 0 in directions that are not seen."""
    scale = np.sqrt(np.maximum(np.diag(normal), 0.0))
    scale = np.where(scale > 0, scale, 1.0)
    inverse: FloatArray = np.linalg.pinv(normal / np.outer(scale, scale), rcond=ROUNDED, hermitian=True)
    unscaled: FloatArray = inverse / np.outer(scale, scale)
    return unscaled


def row_shares(problem: Problem) -> FloatArray:
    """Independent values per row of the residual, shape (m,)."""
    parts = [
        np.full(int(e.thinned(e.fit_rows).sum()) * len(e.channels), independent_share(e)) for e in problem.evidence
    ]
    parts.append(np.full(len(problem.numbers), 1 / problem.numbers.weight**2))
    return np.concatenate(parts)


def fisher_information(problem: Problem, jacobian: FloatArray) -> FloatArray:
    """Information about the coordinates of a weighted Jacobian (m, k), shape (k, k)."""
    information: FloatArray = jacobian.T @ (row_shares(problem)[:, None] * jacobian)
    return information


def cramer_rao(problem: Problem, effects: Sequence[Effect]) -> list[dict[str, FloatArray]]:
    """Least standard deviation of every value of the effects, all fitted together; SI.

    Args:
        problem: recordings, their declared plant, and their noise.
        effects: with the values at which the bound is taken.

    Returns:
        Per effect, key to standard deviations, one per number of the value; 0 for parameters that are not fitted.
    """
    if not effects:
        return []
    base = problem.predicted(effects)
    jacobian = jacobian_of(problem, effects, [True] * len(effects), base)
    covariance = inverse_information(fisher_information(problem, jacobian))
    return spread_to_values(effects, problem.plant, read_coordinates(effects, problem.plant), covariance)
