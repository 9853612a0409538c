"""How much the data speak for an effect against a rival in its place, and how far apart the two are.

    Lambda = (|r_B|^2 - |r_A|^2) / c + z_B'z_B - z_A'z_A + 2 (k_B - k_A),    distance = |d| / sqrt(c)
    d = r_B - r_A,    c = d' (Gamma + M) d / d'd

| symbol | meaning | unit |
|---|---|---|
| r_A, r_B | weighted residuals with the effect taken and with its rival, all others refitted; all recordings | 1 |
| z_A, z_B | declared values over their tolerances, whose cost no noise lowers (`set_evidence.declared_cost`) | 1 |
| k_A, k_B | coordinates fitted; each takes one of Lambda from the fitted data, and adds one on others (Akaike) | 1 |
| Gamma | covariance of the residual, from its spectrum (`noise_colour`) | 1 |
| M | what the model itself may miss, a bound of 95 % in every channel (`model_error_rows`) | 1 |
| c | variance of what the noise adds to a sum along d, over that of white noise of variance one | 1 |

Lambda is twice the logarithm of the odds for the effect taken. Valid where both fits are at their optimum.
Source: Royall, Statistical Evidence (1997), section 1.6 (odds that mislead); Vuong, Econometrica 57 (1989) 307.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from feeddrive.diagnosis.certainty.noise_colour import score_covariance
from feeddrive.diagnosis.judging.judge import Judged, error_series
from feeddrive.diagnosis.likelihood.cross_validation import model_error_rows
from feeddrive.diagnosis.likelihood.fit import Fit
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.likelihood.set_evidence import DeclaredCost, declared_cost
from feeddrive.plant.plant import Plant
from feeddrive.typing import FloatArray


@dataclass(frozen=True)
class Residuals:
    """Weighted residuals of one set of effects: as fitted, and thinned on the judged samples.

    Attributes:
        fitted: of the fitted samples, what declared values may do within their tolerances taken out, (m,).
        judged: of the judged ones, (n,).
        coordinates: that are fitted.
        declared: what its declared values cost, which is part of the square of `fitted`.
    """

    fitted: FloatArray
    judged: FloatArray
    coordinates: int
    declared: DeclaredCost

    @classmethod
    def of(cls, problem: Problem, fitted: Fit, plants: Sequence[tuple[Plant, Judged]]) -> Residuals:
        """Residuals of a fit, with the plant that it gives for each judged recording."""
        judged = np.concatenate([_thinned_error(problem, plant, j) for plant, j in plants])
        return cls(fitted.residual, judged, len(fitted.coordinates), declared_cost(problem, fitted.residual))


def _thinned_error(problem: Problem, plant: Plant, judged: Judged) -> FloatArray:
    evidence = judged.evidence
    errors = error_series(problem, plant, evidence)
    return evidence.weighted(errors, evidence.thinned(evidence.judged_rows))


def odds_and_distance(
    problem: Problem, judged: Sequence[Judged], mine: Residuals, its: Residuals, beyond: float = 0.0
) -> tuple[float, float]:
    """Lambda and distance of a rival from what was taken, fitted and judged samples together.

    Args:
        problem: fitted recordings.
        judged: judged recordings.
        mine: of what was taken.
        its: of the rival, on the same samples.
        beyond: squared error of the rival less that of what was taken on fitted samples that one of them alone
            predicts (`standing.excess_beyond`).
    """
    parts = (
        (list(problem.evidence), [e.fit_rows for e in problem.evidence], mine.fitted, its.fitted),
        ([j.evidence for j in judged], [j.evidence.judged_rows for j in judged], mine.judged, its.judged),
    )
    excess, square, scatter = beyond, 0.0, 0.0
    for evidence, rows, left, other in parts:
        difference = other - left
        excess += float(other @ other - left @ left)
        square += float(difference @ difference)
        scatter += float(score_covariance(evidence, rows, left, difference[:, None])[0, 0])
        model = model_error_rows(evidence, [e.thinned(r) for e, r in zip(evidence, rows, strict=True)])
        model = np.concatenate([model, np.zeros(len(difference) - len(model))])  # measured numbers
        scatter += float(model @ difference**2) / 1.96**2
    if not scatter > 0:
        return (0.0, 0.0) if square == 0 else (excess, float("inf"))
    colour = scatter / square
    excess -= its.declared.square - mine.declared.square
    more = 2.0 * (its.declared.nats - mine.declared.nats + its.coordinates - mine.coordinates)
    return excess / colour + more, float(np.sqrt(square / colour))
