"""Error on blocks of time that were not fitted, without refitting for every block.

Leaving fold k out (see `folds`) moves the coordinates by

    d = -(H - H_k + P)^-1 (J_k' r_k + P b)        H = J'J,  H_k = J_k'J_k,  P = s^2 / w^2

from the fit to what the other folds and the prior say; the error on the fold is that of r_k - J_k d. The prior is that
the effect is absent: b is how far its coordinates stand from that, w its width. Taken as wide as the effect is large,
w = |b|, it decides only where the other folds do not tell the effect from none, (H - H_k) b^2 < s^2 with s^2 the mean
square of the residual: there the error on the fold is that without the effect, and the effect gains nothing. Where they
tell it by n standard deviations, the value is drawn towards none by a share of 1 / (1 + n^2), 1 % at ten. Exact for
linear coordinates, and to second order otherwise.
Source: Stone, J. Roy. Statist. Soc. B 36 (1974) 111; Hoerl and Kennard, Technometrics 12 (1970) 55, for P.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from feeddrive.diagnosis.likelihood.coordinates import absent_coordinates
from feeddrive.diagnosis.likelihood.evidence import Evidence
from feeddrive.diagnosis.likelihood.fit import Fit, unit_columns
from feeddrive.diagnosis.likelihood.folds import FOLDS
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.likelihood.slopes import DIFFERENCE
from feeddrive.effects.base import Effect
from feeddrive.plant.plant import Plant
from feeddrive.typing import BoolArray, FloatArray, IntegerArray


@dataclass(frozen=True)
class Comparison:
    """Two models on the same blocks.

    Attributes:
        gain: share by which the second lowers the squared error of the first on data not fitted.
        standard_error: of the gain, from the blocks.
        least: gain that is asked for.
    """

    gain: float
    standard_error: float
    least: float

    @property
    def pays(self) -> bool:
        """Whether the gain is large enough to add an effect: more than the least, and more than its noise."""
        return self.gain > self.least and self.gain > SIGNIFICANCE * self.standard_error


SCATTER = 2.0
"""Standard deviations by which a channel must be worse: one of forty by chance."""

LEAST_GAIN = 0.005
"""Least share of the squared error that an effect must take away; the largest seen on null recordings is 0.001."""

SIGNIFICANCE = 1.5
"""Gain over its standard error that is asked for; the one-standard-error rule (Breiman et al., 1984, section
3.4.3) and a half more, because a dozen candidates are tried a round."""


@dataclass(frozen=True)
class Prior:
    """What is known of fitted coordinates without the recording: the effect is absent, give or take its own size.

    Attributes:
        beyond: distance of each coordinate from where the effect is absent; 0 where it chooses the form of a law,
            which is then kept, shape (k,).
        width: standard deviation about that, shape (k,).
    """

    beyond: FloatArray
    width: FloatArray


def prior_of(effects: Sequence[Effect], plant: Plant, coordinates: FloatArray) -> Prior:
    """The prior of effects whose coordinates are as given, shape (k,).

    Components and nodes that belong together share one width, the root of their mean square. A form is known to its
    unit: a factor of e where it is logarithmic, its size of interest elsewhere.
    """
    absent, groups = absent_coordinates(effects, plant)
    beyond = np.where(np.isnan(absent), 0.0, coordinates - absent)
    count = np.bincount(groups)
    width = np.sqrt(np.bincount(groups, weights=beyond**2) / np.maximum(count, 1))[groups]
    # a coordinate is not resolved below the step of the slopes
    return Prior(beyond, np.where(np.isnan(absent), 1.0, np.maximum(width, DIFFERENCE)))


def left_out_residual(problem: Problem, fitted: Fit, blocks: IntegerArray) -> FloatArray:
    """Weighted residual of each block when its fold is not fitted, shape (m,); see `left_out`."""
    prior = prior_of(fitted.free, problem.plant, fitted.coordinates)
    return left_out(fitted.residual, fitted.jacobian, blocks, prior)


def left_out(residual: FloatArray, jacobian: FloatArray, blocks: IntegerArray, prior: Prior) -> FloatArray:
    """Residual of each block when its fold is not fitted.

    Args:
        residual: weighted, shape (m,).
        jacobian: of the fitted coordinates, shape (m, k); k may be 0.
        blocks: block of every row, shape (m,); its remainder by `FOLDS` is its fold.
        prior: of the coordinates.

    Returns:
        Weighted residual, shape (m,).
    """
    result = residual.copy()
    square = float(np.mean(residual**2)) if len(residual) else 0.0
    if not jacobian.shape[1] or not 0 < square < np.inf:
        return result
    scaled, length = unit_columns(jacobian)
    scale = np.where(length > 0, length, 1.0)
    normal = scaled.T @ scaled
    known = prior_information(prior.width * scale, square)
    pull = known * prior.beyond * scale
    for fold in range(FOLDS):
        rows = blocks % FOLDS == fold
        part = scaled[rows]
        rest = normal - part.T @ part + np.diag(known)
        # at the fit J'r = 0; a fit that stopped early is taken as it is, not as it might have become
        result[rows] = residual[rows] + part @ np.linalg.solve(rest, part.T @ residual[rows] + pull)
    return result


def prior_information(width: FloatArray, square: float) -> FloatArray:
    """Information of the prior on columns of length one, shape (k,): what one residual square leaves of its width.

    Never less than rounding makes of the information of a column: that much is none.

    Args:
        width: standard deviation of each coefficient, shape (k,).
        square: mean square of the residual.
    """
    least = 4 * max(len(width), 1) * float(np.finfo(float).eps)
    with np.errstate(over="ignore"):
        known: FloatArray = np.clip(square / np.square(width), least, 1 / least)
    return known


def compare_left_out(
    before: FloatArray, after: FloatArray, blocks: IntegerArray, least: float = LEAST_GAIN
) -> Comparison:
    """Gain of one model over another from their residuals on data that neither was fitted to, all of shape (m,).

    With d = before - after the gain is sum d^2 + 2 sum after d. The first part is what the models differ by, known
    without error; only the second is chance, and its sums over blocks give the standard error, whatever the colour of
    the residual inside a block. The scatter of the blocks' gains would not do: it takes for chance that an effect shows
    in some blocks and not in others, as a delay does in a chirp, and so overlooks just the effects that show rarely.
    This one definition serves the search, the judging and the re-homing.
    """
    total = float(before @ before)
    chance = np.bincount(blocks, weights=2 * after * (before - after))
    error = float(np.sqrt(chance @ chance))
    return Comparison((total - float(after @ after)) / total, error / total, least)


def worse_beyond_scatter(before: FloatArray, after: FloatArray, blocks: IntegerArray, values: float) -> float:
    """Share by which the first squared error is smaller than the second, beyond its scatter; negative where it is not.

    It is the gain of the first model over the second: of what they differ by, only the product with the first one's own
    error is chance, however few blocks hold it. Both scatters count: that of the gain between blocks, and that of a
    mean square of so many independent values.

    Args:
        before, after: errors of one channel, (m,).
        blocks: block of every row, (m,).
        values: independent values that the rows hold, 2 B T of T seconds in a band B.
    """
    gain = compare_left_out(after, before, blocks, 0.0)
    return gain.gain - SCATTER * max(gain.standard_error, math.sqrt(2 / max(values, 1.0)))


def compare_levelled(
    before: FloatArray, after: FloatArray, blocks: IntegerArray, least: float = LEAST_GAIN
) -> Comparison:
    """As `compare_left_out`, every block over the level of what both models leave of it, all of shape (m,).

    The variance of a block is not known where no model reaches it. As likely as any, it makes of the block's part
    n/2 log of its square, and of two that are near each other their difference over their mean: no block counts for
    more than its rows.
    """
    rows = np.bincount(blocks)
    level = np.sqrt(np.bincount(blocks, weights=0.5 * (before**2 + after**2)) / np.maximum(rows, 1))
    level = np.where(level > 0, level, 1.0)[blocks]
    return compare_left_out(before / level, after / level, blocks, least)


def least_gain(problem: Problem, before: FloatArray, after: FloatArray) -> float:
    """Gain that is asked for: half a percent, or more where chance or the model's own error does as much.

    A band of width B over T seconds holds 2 B T independent values a channel, whatever the sample rate.

    Args:
        problem: recordings, with what the model itself may miss.
        before: weighted residual without the new effect, (m,).
        after: with it, (m,).
    """
    values = 0.0
    for evidence in problem.evidence:
        seconds = float(np.sum(evidence.fit_rows)) * evidence.recording.sample_time
        values += 2 * evidence.edge * seconds * len(evidence.channels)
    rows = model_error_rows(problem.evidence, [e.thinned(e.fit_rows) for e in problem.evidence])
    rows = np.concatenate([rows, np.zeros(len(problem.numbers))])
    return max(LEAST_GAIN, problem.predictor.chance / values, gain_of_model_error(rows, before, after))


def model_error_rows(evidence: Sequence[Evidence], rows: Sequence[BoolArray]) -> FloatArray:
    """What the model itself may miss, as the weighted squared error E_c of a whole channel, at every row of a residual.

    The errors of two channels are taken as independent, those of one channel, in all recordings, as one error.

    Args:
        evidence: recordings.
        rows: of each, the samples that the residual holds.

    Returns:
        E_c of the channel of every row, (m,) [1]; 0 where the model is exact.
    """
    whole: dict[str, float] = {}
    for one, chosen in zip(evidence, rows, strict=True):
        for name, error in one.model_error.items():
            whole[name] = whole.get(name, 0.0) + float(np.sum(chosen)) * (error / one.unit(name)) ** 2
    parts = [
        np.full(int(np.sum(chosen)), whole.get(name, 0.0))
        for one, chosen in zip(evidence, rows, strict=True)
        for name in one.channels
    ]
    return np.concatenate(parts)


def gain_of_model_error(rows: FloatArray, before: FloatArray, after: FloatArray) -> float:
    """Share of the squared error that the model's own error could take away where a new effect does, all (m,).

    Along the direction of d = before - after it is at most the sum of E_c |d_c|^2 / |d|^2 over the channels.
    """
    square, total = (before - after) ** 2, float(before @ before)
    moved = float(np.sum(square))
    return float(rows @ square) / (moved * total) if moved > 0 and total > 0 else 0.0
