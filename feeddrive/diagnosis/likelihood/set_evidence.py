"""Evidence of a set of effects: what the data say for it, less what its freedom and its luck among many cost.

    log E(S) = -|r_S|² / 2c + Σ log p(θ_i) + k/2 log 2π - 1/2 log |H/c + W⁻²| + log p(S)
    c = d' Γ d / d'd + δ max(|r|² - n, n / 10) + v
    p(S) = B(1 + |S|, 2K - |S|) / B(1, K)

| symbol | meaning | unit |
|---|---|---|
| r_S | residual over the noise with the set S fitted, what declared values within tolerance may do taken out | 1 |
| θ, W | coordinates, of size one; 1 is the scale of p | 1 |
| p(θ) | Cauchy about the absent effect: a size of n costs 2 log n, an absurd one of any number is still a number | 1 |
| p(θ) of a value that is other than declared | lognormal about the declared one, of deviation `BEYOND` | 1 |
| H | J'J of the slopes of the prediction with θ | 1 |
| d | difference of the residuals of two sets that are compared | 1 |
| Γ | covariance of the residual that is less: its spectrum, its level where d is large, sums over blocks | 1 |
| δ, n | `DISCREPANCY`, of what is left above n, which the noise leaves, known to a tenth (`LEVEL_KNOWN`) | 1 |
| v | what an encoder's steps alone give along d (`encoder_along`) | 1 |
| K | candidates and starts that were tried for one further effect | 1 |

Two sets are compared on the same samples, with one c; where they do not predict the same, as `standing` says. Their
discrepancy from the law is not known beforehand: Γ is that of what is left, so that a channel, a frequency or a kind of
motion that the model reaches badly counts for little.
Sources: MacKay, Neural Computation 4 (1992) 415 (Laplace); Scott and Berger, Ann. Statist. 38 (2010) 2587 (p(S)).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.special import betaln

from feeddrive.diagnosis.calibration.declared import calibrated_values, is_said_by, said_share, says_other
from feeddrive.diagnosis.certainty.imitations import lost_motion
from feeddrive.diagnosis.certainty.uncertainty import score_variances
from feeddrive.diagnosis.likelihood.coordinate_kinds import Linear
from feeddrive.diagnosis.likelihood.coordinates import (
    absent_coordinates,
    coordinates_of,
    read_coordinates,
    write_coordinates,
)
from feeddrive.diagnosis.likelihood.cross_validation import (
    model_error_rows,
)
from feeddrive.diagnosis.likelihood.fit import Fit
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.likelihood.tolerances import BEYOND
from feeddrive.effects.base import Effect, number
from feeddrive.effects.transmission.backlash import Backlash
from feeddrive.effects.transmission.preload_loss import PreloadLoss
from feeddrive.plant.plant import Plant
from feeddrive.typing import FloatArray

PLACES = frozenset({"centre"})
"""Coordinates that are places on the axis: one some hundred strokes away is no place, and the law there is another."""

TINY = 1e-9
"""In place of a width of nothing over its size [1]: no data tell a femtometre from none."""

DISCREPANCY = 2e-4
"""Share of the squared residual above the noise that a law other than ours leaves along any one direction (variance).
The luckiest of some hundred candidates, at 2.2 deviations, then takes 0.1 % of it away."""

LEVEL_KNOWN = 0.1
"""Share to which the square of the noise is known, from the quietest tenth of the blocks: a law that leaves less is not
seen to leave anything, and is granted as much."""


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
    declared, steepness = _declared_shares(effects, plant, coordinates)
    sized = ~np.isnan(middle) & np.isnan(declared)
    beyond = np.where(sized, coordinates - middle, 0.0)
    lost = _log_prior_of_lost_motion(effects, plant, coordinates)
    known = ~np.isnan(declared)
    narrow = np.where(known, steepness / BEYOND, 1.0)
    _, volume = np.linalg.slogdet(normal / variance + np.diag(narrow**2))
    # a Cauchy density over a normal one of the same scale is sqrt(2 / pi) at the middle
    size = 0.5 * np.sum(sized) * np.log(2 / np.pi) - np.sum(np.log1p(beyond**2))
    other = np.sum(np.log(narrow[known]) - 0.5 * (declared[known] / BEYOND) ** 2)
    return float(size + other - 0.5 * volume + lost)


def _declared_shares(effects: Sequence[Effect], plant: Plant, coordinates: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Logarithm of the declared value over itself as declared that a coordinate stands for, and its slope with it.

    NaN for the coordinates of other effects, and of values declared as exact; (k,) each.
    """
    shares, slopes = np.full(len(coordinates), np.nan), np.full(len(coordinates), np.nan)
    values, at = None, 0
    for effect in effects:
        own = coordinates_of(effect, plant)
        size = sum(len(one.read(effect)) for one in own)
        if len(own) == size and says_other(effect):
            values = calibrated_values(plant) if values is None else values
            (there,) = write_coordinates([effect], plant, coordinates[at : at + size])
            said = {value.key: said_share(plant, value, there) for value in values if is_said_by(value, effect)}
            for key, share, slope in said.values():
                for i, one in enumerate(own):
                    if isinstance(one, Linear) and one.key == key and share > 0:
                        shares[at + i], slopes[at + i] = math.log(share), slope * one.size / share
        at += size
    return shares, slopes


def _log_prior_of_lost_motion(effects: Sequence[Effect], plant: Plant, coordinates: FloatArray) -> float:
    """What the prior says of the force F1 up to which preload is lost, for every effect that has one.

    Where little is carried around zero force that law is a free play of width w = 2 F1 (1 - a) / (a k), so that a width
    is as likely in one as in the other: p(log F1) = w p(w) at a given ratio a. A flat prior would call every small play
    a softness.
    """
    total, at, width = 0.0, 0, Backlash.parameter("width").size
    for effect in effects:
        size = len(read_coordinates([effect], plant))
        if isinstance(effect, PreloadLoss) and plant.chain.elastic:
            (there,) = write_coordinates([effect], plant, coordinates[at : at + size])
            lost = lost_motion(number(there.values["ratio"]), number(there.values["force"]), plant)
            over = max(lost / width, TINY)
            total += 0.5 * math.log(2 / math.pi) + math.log(over) - math.log1p(over**2)
        at += size
    return total


def prior_middle(effects: Sequence[Effect], plant: Plant) -> FloatArray:
    """Middle of the prior of every coordinate, (k,): the absent effect, the zero of a place; NaN where any is as good.

    An order, a velocity, a time constant are known by the start that they are near, which K counts.
    """
    absent, _ = absent_coordinates(effects, plant)
    keys = [c for e in effects for one in coordinates_of(e, plant) for c in [one] * len(one.read(e))]
    placed = [isinstance(one, Linear) and one.key in PLACES for one in keys]
    return np.where(np.isnan(absent) & np.array(placed, dtype=bool), 0.0, absent)


def log_odds(
    problem: Problem, first: Fit, second: Fit, count: int, beyond: float = 0.0, of_first: Problem | None = None,
    encoder: float = 0.0, variance: float | None = None,
) -> float:  # fmt: skip
    """Logarithm of the odds for the second of two sets, all of whose effects are fitted to the same samples.

    Args:
        problem: recordings.
        first: a set.
        second: another.
        count: candidates and starts that were tried.
        beyond: squared error of the first less that of the second on samples that one of them alone predicts.
        of_first: with the declared values that the first stands beside, where those are others.
        encoder: v, where it was simulated.
        variance: c but for v, where the pair is held against what is over that; else that of the pair.
    """
    excess = first.squared_error - second.squared_error + beyond
    if not np.isfinite(excess):
        return float("inf") if excess > 0 else float("-inf")
    if variance is None:
        variance = variance_along(problem, min((first, second), key=lambda one: one.squared_error), first, second)
    variance += encoder
    sets = [
        log_volume(one.effects, problem.plant, one.coordinates, one.jacobian.T @ one.jacobian, variance)
        + log_prior_of_size(len(one.effects), count)
        for one in (first, second)
    ]
    costs = declared_cost(of_first or problem, first.residual), declared_cost(problem, second.residual)
    excess -= costs[0].square - costs[1].square
    return 0.5 * excess / variance + costs[0].nats - costs[1].nats + sets[1] - sets[0]


class DeclaredCost(NamedTuple):
    """What declared values cost that stand off what is declared: in the whitened square, and in nats."""

    square: float
    nats: float


def declared_cost(problem: Problem, residual: FloatArray) -> DeclaredCost:
    """Cost of the declared values as they are most likely with a residual, whitened, (m,): λ c'c of its square.

    Their tolerances are known. No noise of the recordings, and no error that a law may have, makes a value that is off
    by many of its deviations any likelier: c'c / 2 is what it costs.
    """
    whitened = problem.whitener
    if whitened is None:
        return DeclaredCost(0.0, 0.0)
    square = float(np.sum((1 - whitened.kept**2) * (whitened.basis.T @ residual) ** 2))
    return DeclaredCost(square, 0.5 * square / whitened.variance)


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
    return (noise + missed) / square + discrepancy(problem, left.squared_error)


def discrepancy(problem: Problem, square: float) -> float:
    """Variance along any one direction of what a law other than ours leaves of a squared residual."""
    noise = problem.noise_square
    return DISCREPANCY * max(square - noise, LEVEL_KNOWN * noise)
