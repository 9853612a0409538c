"""The sums behind a functional analysis of variance: normal equations of all columns, fold by fold.

What a fold's own blocks alone tell of a term is drawn to the prior as in `diagnose.cross_validation`: the term is
absent, give or take its size. For linear columns both are one: with y = r + J c the fit without the fold is
(H - H_k + P)^-1 (J'y - J_k'y_k).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from feeddrive.diagnosis.likelihood.cross_validation import Comparison, compare_left_out, prior_information
from feeddrive.diagnosis.likelihood.folds import FOLDS
from feeddrive.diagnosis.unexplained.terms import Term
from feeddrive.typing import FloatArray, IntegerArray

RIDGE = 1e-8
"""Ridge for columns of length one: settles tables whose hats add up to another column, and moves no value."""


@dataclass(frozen=True)
class Sample:
    """A residual, as it is taken apart.

    Attributes:
        residual: (n,), unit of its channel.
        blocks: block of time of every value, (n,).
        offsets: columns that are always there, (n, m); m may be 0.
        columns: terms to their columns at the same values, one after the other, (n, sum of k).
        noise_square: mean square of the noise.
        least: least share of the squared error that a term must take away.
    """

    residual: FloatArray
    blocks: IntegerArray
    offsets: FloatArray
    columns: Callable[[Sequence[Term]], FloatArray]
    noise_square: float
    least: float


class Sums:
    """Normal equations of all columns, per fold. Not a record: it grows by the terms that are added."""

    def __init__(self, sample: Sample) -> None:
        self._sample = sample
        self._folds = [sample.blocks % FOLDS == fold for fold in range(FOLDS)]
        self._matrix = np.zeros((len(sample.residual), 0))
        self._scale = np.zeros(0)
        self._gram = np.zeros((FOLDS, 0, 0))
        self._moment = np.zeros((FOLDS, 0))
        self._at: dict[Term, IntegerArray] = {}
        self._left: dict[tuple[Term, ...], FloatArray] = {}
        self._append(sample.offsets)
        self._fixed = np.arange(sample.offsets.shape[1])
        self._squares = np.array([float(np.sum(sample.residual[fold] ** 2)) for fold in self._folds])

    def add(self, terms: Sequence[Term]) -> None:
        """Take further terms in."""
        new = [term for term in dict.fromkeys(terms) if term not in self._at]
        if not new:
            return
        start = self._matrix.shape[1]
        for term in new:
            self._at[term] = np.arange(start, start + term.size)
            start += term.size
        self._append(self._sample.columns(new))

    def _append(self, columns: FloatArray) -> None:
        length: FloatArray = np.sqrt(np.sum(columns**2, axis=0))
        scale = np.where(length > 0, length, 1.0)
        before, columns = self._matrix.shape[1], columns / scale
        self._scale = np.concatenate([self._scale, scale])
        self._matrix = np.column_stack([self._matrix, columns])
        size = self._matrix.shape[1]
        gram, moment = np.zeros((FOLDS, size, size)), np.zeros((FOLDS, size))
        for k, fold in enumerate(self._folds):
            part, new = self._matrix[fold], columns[fold]
            cross = part.T @ new
            gram[k, :before, :before] = self._gram[k]
            gram[k, :, before:], gram[k, before:, :] = cross, cross.T
            moment[k] = part.T @ self._sample.residual[fold]
        self._gram, self._moment = gram, moment

    def _columns(self, terms: Sequence[Term]) -> IntegerArray:
        return np.concatenate([self._fixed, *(self._at[term] for term in terms)]).astype(np.int64)

    def _solved(self, gram: FloatArray, moment: FloatArray) -> FloatArray:
        return np.asarray(np.linalg.solve(gram + RIDGE * np.eye(len(moment)), moment), dtype=np.float64)

    def _fold_values(self, terms: Sequence[Term]) -> list[FloatArray]:
        """Values fitted without each fold."""
        at = self._columns(terms)
        pick = np.ix_(at, at)
        gram, moment = np.sum(self._gram, axis=0)[pick], np.sum(self._moment, axis=0)[at]
        known = np.diag(self._known(terms, gram, moment))
        return [self._solved(gram - self._gram[k][pick] + known, moment - self._moment[k][at]) for k in range(FOLDS)]

    def _known(self, terms: Sequence[Term], gram: FloatArray, moment: FloatArray) -> FloatArray:
        """Information of the prior on each column: a term has one width, the offsets are not known beforehand."""
        values = self._solved(gram, moment)
        square = float(self._squares.sum() - moment @ values) / max(len(self._sample.residual), 1)
        count = len(self._fixed)
        groups = np.repeat(np.arange(len(terms)), [len(self._at[term]) for term in terms])
        squares = np.bincount(groups, weights=values[count:] ** 2) / np.maximum(np.bincount(groups), 1)
        known = np.zeros(len(values))
        known[count:] = prior_information(np.sqrt(squares)[groups], max(square, 0.0))
        return known

    def squared_error(self, terms: Sequence[Term]) -> float:
        """Squared error on blocks not fitted."""
        at = self._columns(terms)
        total = float(self._squares.sum())
        for k, values in enumerate(self._fold_values(terms)):
            total += float(values @ self._gram[k][np.ix_(at, at)] @ values - 2 * values @ self._moment[k][at])
        return total

    def left_out(self, terms: Sequence[Term]) -> FloatArray:
        """Residual on blocks not fitted, (n,)."""
        key = tuple(terms)
        if key not in self._left:
            at = self._columns(terms)
            left = self._sample.residual.copy()
            for fold, values in zip(self._folds, self._fold_values(terms), strict=True):
                left[fold] -= self._matrix[np.ix_(fold, at)] @ values
            self._left[key] = left
        return self._left[key]

    def compared(self, before: Sequence[Term], after: Sequence[Term]) -> Comparison:
        """Gain of one set of terms over another on blocks not fitted."""
        return compare_left_out(self.left_out(before), self.left_out(after), self._sample.blocks, 0.0)

    def least(self, terms: Sequence[Term]) -> float:
        """Gain that is asked for beyond these terms."""
        count, squared = len(self._sample.residual), float(np.sum(self.left_out(terms) ** 2))
        return max(self._sample.least, self._sample.least * self._sample.noise_square * count / squared)

    def fit_residual(self, terms: Sequence[Term]) -> FloatArray:
        """Residual of the fit to all, (n,)."""
        at = self._columns(terms)
        values = self._solved(self._gram.sum(axis=0)[np.ix_(at, at)], self._moment.sum(axis=0)[at])
        left: FloatArray = self._sample.residual - self._matrix[:, at] @ values
        return left

    def coefficients(self, terms: Sequence[Term]) -> tuple[dict[Term, FloatArray], dict[Term, FloatArray], FloatArray]:
        """Values and standard errors of each term, and of the offsets, from the fit to all.

        The middle of the sandwich sums over blocks of time, which counts correlation inside them.
        """
        at = self._columns(terms)
        inverse = np.linalg.inv(self._gram.sum(axis=0)[np.ix_(at, at)] + RIDGE * np.eye(len(at)))
        values = inverse @ self._moment.sum(axis=0)[at]
        scores = self._matrix[:, at] * self.fit_residual(terms)[:, None]
        sums = np.zeros((int(self._sample.blocks.max(initial=0)) + 1, len(at)))
        np.add.at(sums, self._sample.blocks, scores)
        errors = np.linalg.norm(sums @ inverse, axis=0) / self._scale[at]
        values = values / self._scale[at]
        cuts = np.cumsum([len(self._fixed), *(len(self._at[term]) for term in terms)])[:-1]
        parts, spreads = np.split(values, cuts), np.split(errors, cuts)
        return dict(zip(terms, parts[1:], strict=True)), dict(zip(terms, spreads[1:], strict=True)), parts[0]
