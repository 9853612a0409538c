"""Error on blocks of time that were not fitted, without refitting for every block.

The blocks are dealt to folds in turn, so that every fold sees strokes, reversals and chirps. Leaving fold k out moves
the coordinates by d = -(H - H_k)^-1 g_k, with H = J'J, H_k and g_k = J_k' r_k from the fold alone; the error on the
fold is that of r_k - J_k d. Exact for linear coordinates, and to second order otherwise.
Source: Stone, J. Roy. Statist. Soc. B 36 (1974) 111; Roberts et al., Ecography 40 (2017) 913 (blocks).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from feeddrive.diagnose.evidence import Evidence
from feeddrive.diagnose.fit import Problem
from feeddrive.typing import BoolArray, FloatArray, IntegerArray

FOLDS = 6
"""Folds to which the blocks are dealt."""


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


LEAST_GAIN = 0.005
"""Least share of the squared error that an effect must take away; the largest seen on null recordings is 0.001."""

SIGNIFICANCE = 1.5
"""Gain over its standard error that is asked for; the one-standard-error rule (Breiman et al., 1984, section
3.4.3) and a half more, because a dozen candidates are tried a round."""


def block_numbers(problem: Problem) -> IntegerArray:
    """Block of every row of the residual, counted over all recordings; channels share their blocks. Shape (m,)."""
    numbers, first = [], 0
    for evidence in problem.evidence:
        rows = np.flatnonzero(evidence.thinned(evidence.fit_rows))
        blocks = (rows * evidence.recording.sample_time / evidence.block).astype(int)
        numbers += [first + blocks] * len(evidence.channels)
        first += int(blocks.max(initial=0)) + 1
    return np.concatenate(numbers).astype(np.int64)


def left_out_residual(residual: FloatArray, jacobian: FloatArray, blocks: IntegerArray) -> FloatArray:
    """Residual of each block when its fold is not fitted.

    Args:
        residual: weighted, shape (m,).
        jacobian: of the fitted coordinates, shape (m, k); k may be 0.
        blocks: block of every row, shape (m,).

    Returns:
        Weighted residual, shape (m,).
    """
    left_out = residual.copy()
    if jacobian.shape[1]:
        scale = np.linalg.norm(jacobian, axis=0)
        scaled = jacobian / np.where(scale > 0, scale, 1.0)
        normal = scaled.T @ scaled
        for fold in range(FOLDS):
            rows = blocks % FOLDS == fold
            part = scaled[rows]
            rest = normal - part.T @ part
            # at the fit J'r = 0; a fit that stopped early is taken as it is, not as it might have become
            move = -np.linalg.lstsq(rest, part.T @ residual[rows], rcond=1e-12)[0]
            left_out[rows] = residual[rows] - part @ move
    return left_out


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
            whole[name] = whole.get(name, 0.0) + float(np.sum(chosen)) * (error / one.noise[name]) ** 2
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
