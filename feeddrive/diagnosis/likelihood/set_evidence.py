"""Evidence of a set of effects: what the data say for it, less what its freedom and its luck among many cost.

    log E(S) = -|r_S|² / 2c + Σ log p(θ_i) + k/2 log 2π - 1/2 log |H/c + W⁻²| + log p(S)
    c = d' Γ d / d'd + δ (|r|² + |s|²)
    p(S) = B(1 + |S|, 2K - |S|) / B(1, K)

| symbol | meaning | unit |
|---|---|---|
| r_S | residual over the noise with the set S fitted, what declared values within tolerance may do taken out | 1 |
| θ, W | coordinates, of size one; 1 is the scale of p | 1 |
| p(θ) | Cauchy about the absent effect: a size of n costs 2 log n, an absurd one of any number is still a number | 1 |
| H | J'J of the slopes of the prediction with θ | 1 |
| d | difference of the residuals of two sets that are compared | 1 |
| Γ | covariance of the residual that is less: its spectrum, its level where d is large, sums over blocks | 1 |
| s | what the laws that both sets hold take from the residual; values that have no form aside | 1 |
| δ | `DISCREPANCY` | 1 |
| K | candidates and starts that were tried for one further effect | 1 |

Two sets are compared on the same samples, with one c. Their discrepancy from the law is not known beforehand: Γ is that
of what is left, so that a channel, a frequency or a kind of motion that the model reaches badly counts for little. A
law of another form than ours leaves a share of what it does itself: what is no more than that is no second effect.
Sources: MacKay, Neural Computation 4 (1992) 415 (Laplace); Scott and Berger, Ann. Statist. 38 (2010) 2587 (p(S)).
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

import numpy as np
from scipy.special import betaln

from feeddrive.diagnosis.certainty.uncertainty import score_variances
from feeddrive.diagnosis.likelihood.coordinates import Linear, absent_coordinates, coordinates_of
from feeddrive.diagnosis.likelihood.cross_validation import model_error_rows
from feeddrive.diagnosis.likelihood.fit import Fit, Problem
from feeddrive.effects.base import Effect
from feeddrive.effects.catalogue import EFFECTS
from feeddrive.plant.plant import Plant
from feeddrive.typing import FloatArray

PLACES = frozenset({"centre"})
"""Coordinates that are places on the axis: one some hundred strokes away is no place, and the law there is another."""

FORMLESS = frozenset({
    "constant_force", "payload", "inertia_deviation", "stiffness_deviation", "friction_deviation", "drive_delay",
    "channel_delay",
})  # fmt: skip
"""Effects that are values of the machine and its recorder: there is no other form of them."""

DISCREPANCY = 2e-4
"""Share of the squared residual, and of the square that a law takes, that a law other than ours leaves along any one
direction (variance). The luckiest of
some hundred candidates, at 2.2 deviations, then takes 0.1 % away: as much as it does of recordings with nothing in."""


def log_prior_of_size(size: int, count: int) -> float:
    """Logarithm of p(S) for a set of `size`, `count` candidates having been tried."""
    return float(betaln(1 + size, 2 * count - size) - betaln(1, count))


def log_volume(
    effects: Sequence[Effect], plant: Plant, coordinates: FloatArray, normal: FloatArray, variance: float
) -> float:
    """Logarithm of what the data leave of the prior: Σ log p + k/2 log 2π - 1/2 log |H/c + W⁻²|.

    Args:
        effects: fitted.
        plant: as declared.
        coordinates: of the effects, (k,).
        normal: H, (k, k).
        variance: c.
    """
    middle = prior_middle(effects, plant)
    beyond = np.where(np.isnan(middle), 0.0, coordinates - middle)
    sized = int(np.sum(~np.isnan(middle)))
    _, volume = np.linalg.slogdet(normal / variance + np.eye(len(normal)))
    # a Cauchy density over a normal one of the same scale is sqrt(2 / pi) at the middle
    return float(0.5 * sized * np.log(2 / np.pi) - np.sum(np.log1p(beyond**2)) - 0.5 * volume)


def prior_middle(effects: Sequence[Effect], plant: Plant) -> FloatArray:
    """Middle of the prior of every coordinate, (k,): the absent effect, the zero of a place; NaN where any is as good.

    An order, a velocity, a time constant are known by the start that they are near, which K counts.
    """
    absent, _ = absent_coordinates(effects, plant)
    keys = [c for e in effects for one in coordinates_of(e, plant) for c in [one] * len(one.read(e))]
    placed = [isinstance(one, Linear) and one.key in PLACES for one in keys]
    return np.where(np.isnan(absent) & np.array(placed, dtype=bool), 0.0, absent)


def log_odds(problem: Problem, first: Fit, second: Fit, count: int) -> float:
    """Logarithm of the odds for the second of two sets, all of whose effects are fitted to the same samples.

    Args:
        problem: recordings.
        first: a set.
        second: another.
        count: candidates and starts that were tried.
    """
    excess = first.squared_error - second.squared_error
    if not np.isfinite(excess):
        return float("inf") if excess > 0 else float("-inf")
    variance = variance_along(problem, min((first, second), key=lambda one: one.squared_error), first, second)
    variance += DISCREPANCY * taken_by_laws(problem, _common(first.effects, second.effects))
    sets = [
        log_volume(one.effects, problem.plant, one.coordinates, one.jacobian.T @ one.jacobian, variance)
        + log_prior_of_size(len(one.effects), count)
        for one in (first, second)
    ]
    return 0.5 * excess / variance + sets[1] - sets[0]


def _common(effects: Sequence[Effect], others: Sequence[Effect]) -> list[Effect]:
    """The effects of a set that another set holds too, with their values in the first."""
    there = Counter((one.name, one.port, one.place) for one in others)
    result = []
    for effect in effects:
        if there[effect.name, effect.port, effect.place] > 0:
            there[effect.name, effect.port, effect.place] -= 1
            result.append(effect)
    return result


def taken_by_laws(problem: Problem, effects: Sequence[Effect]) -> float:
    """|s|²: by how much effects that have a form lower the squared error of a set."""
    formless = [one for one in effects if one.name in FORMLESS or one.name not in EFFECTS]
    if not problem.predictor.of_motion or len(formless) == len(effects):
        return 0.0
    without, having = (problem.residual(some) for some in (formless, effects))
    taken = float(without @ without) - float(having @ having)
    return max(taken, 0.0) if np.isfinite(taken) else 0.0


def variance_along(problem: Problem, left: Fit, first: Fit, second: Fit) -> float:
    """c: variance of what is left along the difference of two sets."""
    difference = first.residual - second.residual
    square = float(difference @ difference)
    model = model_error_rows(problem.evidence, [e.thinned(e.fit_rows) for e in problem.evidence])
    model = np.concatenate([model, np.zeros(len(problem.numbers))])
    if square <= 0:
        return 1.0
    noise = float(score_variances(problem, left.residual, difference[:, None])[0])
    missed = float(model @ difference**2) / 1.96**2
    return (noise + missed) / square + DISCREPANCY * left.squared_error
