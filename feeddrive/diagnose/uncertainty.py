"""Intervals of fitted parameters where the residual is coloured.

    cov = (J'J)^-1 S (J'J)^-1,   S = sum over blocks of s_b s_b' and half the products of neighbours,  s_b = J_b' r_b

Sums over blocks count correlation of any form inside a block. Intervals use Student's t with the number of blocks that
carry information about the coordinate, so that a parameter seen in a few blocks gets the wide interval it deserves.
What the model itself may miss (thermal plants) is added as the worst it can do to a coordinate: an error of that rms
along the one direction of the residual that moves it, taken as a bound of 95 %.
Source: Liang and Zeger, Biometrika 73 (1986) 13; Newey and West, Econometrica 55 (1987) 703.
"""

from __future__ import annotations

import numpy as np
from scipy.stats import t as student

from feeddrive.diagnose.coordinates import spread_to_values
from feeddrive.diagnose.cross_validation import block_numbers, model_share
from feeddrive.diagnose.fit import Fit, Problem
from feeddrive.typing import FloatArray, IntegerArray


def coordinate_covariance(fitted: Fit, blocks: IntegerArray) -> FloatArray:
    """Covariance of the fit coordinates, shape (k, k)."""
    scores = fitted.jacobian * fitted.residual[:, None]
    sums = np.zeros((int(blocks.max(initial=0)) + 1, scores.shape[1]))
    np.add.at(sums, blocks, scores)
    neighbours = sums[1:].T @ sums[:-1]
    within = sums.T @ sums
    middle = within + 0.5 * (neighbours + neighbours.T)
    # the neighbours may take variance away by chance; blocks alone are then the safer count
    middle = np.where(np.diag(middle)[:, None] < np.diag(within)[:, None], within, middle)
    middle = 0.5 * (middle + middle.T)
    inverse = np.linalg.pinv(fitted.jacobian.T @ fitted.jacobian, rcond=1e-14, hermitian=True)
    covariance: FloatArray = inverse @ middle @ inverse
    return covariance


def informed_blocks(fitted: Fit, blocks: IntegerArray) -> float:
    """Number of blocks that carry the least known coordinate: (sum w)^2 / sum w^2 of their information."""
    count = int(blocks.max(initial=0)) + 1
    least = float(count)
    for column in fitted.jacobian.T:
        information = np.bincount(blocks, weights=column**2, minlength=count)
        total = float(np.sum(information**2))
        least = min(least, float(np.sum(information)) ** 2 / total if total > 0 else 1.0)
    return least


def half_widths(problem: Problem, fitted: Fit) -> list[dict[str, FloatArray]]:
    """Half widths of the 95 % intervals per effect and key, SI; fixed parameters get 0."""
    if not fitted.effects:
        return []
    blocks = block_numbers(problem)
    covariance = coordinate_covariance(fitted, blocks)
    inverse = np.linalg.pinv(fitted.jacobian.T @ fitted.jacobian, rcond=1e-14, hermitian=True)
    covariance = covariance + model_share(problem) / 1.96**2 * inverse
    quantile = float(student.ppf(0.975, max(informed_blocks(fitted, blocks) - 1, 2)))
    deviations = spread_to_values(fitted.effects, problem.plant, fitted.coordinates, covariance)
    return [{key: quantile * value for key, value in effect.items()} for effect in deviations]
