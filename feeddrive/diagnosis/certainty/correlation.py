"""Which fitted parameters are known only together: correlations, and the condition number of what was fitted.

    rho_ij = cov_ij / sqrt(cov_ii cov_jj),     kappa = largest over least singular value of J, its columns of length one

Two numbers whose |rho| is near one can be changed together at hardly any cost: their difference, or sum, is known, and
neither of them. kappa says the same of all numbers at once. Above 30 some are known from rounding alone.
Source: Belsley, Kuh, Welsch, Regression Diagnostics (1980), section 3.2 (kappa, and the bound of 30).
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

import numpy as np

from feeddrive.diagnosis.certainty.certainty_result import Correlation
from feeddrive.diagnosis.certainty.uncertainty import Certainty, slopes
from feeddrive.diagnosis.likelihood.coordinates import value_slopes
from feeddrive.diagnosis.likelihood.fit import Fit
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.effects.base import Effect
from feeddrive.typing import FloatArray

TOGETHER = 0.95
"""|rho| from which two numbers count as known only together."""


def correlation(problem: Problem, fitted: Fit, known: Certainty) -> Correlation | None:
    """Correlations of all fitted numbers; None where fewer than two were fitted."""
    if not fitted.effects:
        return None
    moves = value_slopes(fitted.effects, problem.plant, fitted.coordinates)
    covariance = moves @ known.covariance @ moves.T
    fitted_ones = np.flatnonzero(np.diag(covariance) > 0)
    if len(fitted_ones) < 2:
        return None
    labels = value_labels(fitted.effects)
    names = tuple(labels[i] for i in fitted_ones)
    deviation = np.sqrt(np.diag(covariance)[fitted_ones])
    matrix = np.clip(covariance[np.ix_(fitted_ones, fitted_ones)] / np.outer(deviation, deviation), -1.0, 1.0)
    return Correlation(
        names, tuple(map(tuple, matrix.tolist())), condition(slopes(problem, fitted)), _remarks(names, matrix)
    )


def condition(jacobian: FloatArray) -> float:
    """Condition number of a Jacobian (m, k) whose columns are brought to length one; infinite where one is lost."""
    length = np.linalg.norm(jacobian, axis=0)
    if not len(length) or not np.all(length > 0):
        return float("inf")
    normal = np.linalg.eigvalsh((jacobian / length).T @ (jacobian / length))
    return float(np.sqrt(normal[-1] / normal[0])) if normal[0] > 0 else float("inf")


def value_labels(effects: Sequence[Effect]) -> list[str]:
    """Names of all numbers of the effects in order, `effect.key`; numbered where a name occurs more than once."""
    seen: Counter[str] = Counter()
    labels = []
    for effect in effects:
        seen[effect.name] += 1
        name = effect.name if seen[effect.name] == 1 else f"{effect.name}_{seen[effect.name]}"
        for key, value in effect.values.items():
            many = isinstance(value, tuple)
            labels += [f"{name}.{key}[{i}]" for i in range(len(value))] if many else [f"{name}.{key}"]  # type: ignore[arg-type]
    return labels


def _remarks(names: Sequence[str], matrix: FloatArray) -> tuple[str, ...]:
    """A sentence for every pair that is known only together; neighbours of one tabulated curve are passed."""
    remarks = []
    for i, first in enumerate(names):
        for j in range(i + 1, len(names)):
            second, rho = names[j], float(matrix[i, j])
            if abs(rho) <= TOGETHER or (first.endswith("]") and second.endswith("]")):
                continue
            same = first.split(".")[0] == second.split(".")[0]
            lost = "each is known only with the other" if same else "these two cannot be told apart here"
            way = "rise together" if rho > 0 else "rise and fall against each other"
            remarks.append(f"{first} and {second}: {lost} (correlation {rho:+.3f}); they may {way} at hardly any cost")
    return tuple(remarks)
