"""Functional analysis of variance: a residual as a sum of functions of one variable, and of products of two.

    e = sum offsets + sum_j f_j(s_j) + sum_jk f_jk(s_j) m_k + noise

Each f is a table (hat functions), a few sines, a step or a level; m is a direction or a velocity. Terms are added one
at a time while they lower the error on blocks of time that were not fitted (folds as in `cross_validation`); of terms
that cannot be distinguished the simplest is taken, a function of one variable before a product.
Sources: Hoeffding, Ann. Math. Stat. 19 (1948) 293; Hooker, J. Comput. Graph. Stat. 16 (2007) 709 (dependent variables);
Roberts et al., Ecography 40 (2017) 913 (blocks).

What a fold's own blocks alone tell of a term is drawn to the prior as in `cross_validation`: the term is
absent, give or take its size. For linear columns both are one: with y = r + J c the fit without the fold is
(H - H_k + P)^-1 (J'y - J_k'y_k).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.linalg import null_space

from feeddrive.diagnosis.finding.remembered import Remembered
from feeddrive.diagnosis.likelihood.cross_validation import Comparison, compare_left_out, prior_information
from feeddrive.diagnosis.likelihood.folds import FOLDS
from feeddrive.diagnosis.likelihood.tolerances import SURE
from feeddrive.diagnosis.unexplained.terms import Form, Term
from feeddrive.typing import FloatArray, IntegerArray

MOST_TERMS = 4
"""Terms at most: what needs more is not read by a person."""

TIE = 0.05
"""Share of the squared error by which a simpler term may be worse, if the difference is within twice its scatter."""

COUNT = 2.0
"""Factor in columns by which a term is simpler."""


RIDGE = 1e-8
"""Ridge for columns of length one: settles tables whose hats add up to another column, and moves no value."""


COLUMNS = 32_000_000
"""Bytes of columns that are kept: those of the few terms chosen, beside which each of hundreds is weighed."""


@dataclass(frozen=True)
class Found:
    """A term of the decomposition.

    Attributes:
        term: what it is.
        values: coefficient of each column, (k,), unit of the residual over that of the factor.
        errors: standard errors, blocks of time taken as independent, (k,).
        share: of the squared residual, by which the error on blocks not fitted is lower with the term than without.
        alike: terms over other variables that do as well.
    """

    term: Term
    values: FloatArray
    errors: FloatArray
    share: float
    alike: tuple[Term, ...]


def decompose(
    sample: Sample, terms: Sequence[Term], proposed: Callable[[FloatArray], list[Term]],
    refined: Callable[[Term], list[Term]],
) -> tuple[Found, ...]:  # fmt: skip
    """Take a residual apart.

    Args:
        sample: the residual.
        terms: tried in every round.
        proposed: what is left (n,) to further terms that it suggests, such as sines.
        refined: a term to finer ones of its form.

    Returns:
        The terms that pay, the strongest first; none where nothing does.
    """
    sums = Sums(sample)
    sums.add(terms)
    chosen: list[Term] = []
    alike: dict[Term, tuple[Term, ...]] = {}
    while len(chosen) < MOST_TERMS:
        suggestions = proposed(sums.fit_residual(chosen))
        sums.add(suggestions)
        best = _best(sums, chosen, [*terms, *suggestions])
        if best is None:
            break
        winner, others = best
        finer = refined(winner)
        sums.add(finer)
        winner = min([winner, *finer], key=lambda term: sums.squared_error([*chosen, term]))
        following = [*_needed(sums, chosen, winner), winner]
        if sums.squared_error(following) >= sums.squared_error(chosen):
            break  # terms that took each other's place in turn would do so for ever
        chosen, alike[winner] = following, others
    shares = {term: sums.compared([c for c in chosen if c != term], chosen).gain for term in chosen}
    scale = {term: sums.left_out([c for c in chosen if c != term]) for term in chosen}
    whole = float(np.sum(sums.left_out([]) ** 2))
    values, errors = sums.coefficients(chosen)
    found = [
        Found(t, values[t], errors[t], shares[t] * float(np.sum(scale[t] ** 2)) / whole, alike.get(t, ()))
        for t in chosen
    ]
    return tuple(sorted(found, key=lambda one: -one.share))


def _best(sums: Sums, chosen: list[Term], terms: Sequence[Term]) -> tuple[Term, tuple[Term, ...]] | None:
    """The simplest of the best terms, and those over other variables that do as well; None where none pays."""
    ranked = sorted((t for t in terms if t not in chosen), key=lambda term: sums.squared_error([*chosen, term]))
    if not ranked:
        return None
    first = ranked[0]
    if not _pays(sums, sums.compared(chosen, [*chosen, first]), chosen):
        return None
    tied = [first]
    for other in ranked[1:]:
        if _as_good(sums, chosen, other, first):
            tied.append(other)
        elif sums.squared_error([*chosen, other]) > (1 + 2 * TIE) * sums.squared_error([*chosen, first]):
            break
    winner = min(tied, key=lambda term: (*_complexity(term), ranked.index(term)))
    others = {
        (t.variable, t.times): t for t in reversed(tied) if (t.variable, t.times) != (winner.variable, winner.times)
    }
    return winner, tuple(others.values())


def _complexity(term: Term) -> tuple[bool, bool, int]:
    """What is taken last of terms that do alike: what need not come again, a product, more columns."""
    return term.variable == "time", bool(term.times), math.ceil(math.log(term.size) / math.log(COUNT))


def _as_good(sums: Sums, chosen: list[Term], other: Term, best: Term) -> bool:
    better = sums.compared([*chosen, other], [*chosen, best])
    return better.gain < max(sums.least(chosen), min(2 * better.standard_error, TIE))


def _pays(sums: Sums, comparison: Comparison, chosen: list[Term]) -> bool:
    return comparison.gain > sums.least(chosen) and comparison.gain > SURE * comparison.standard_error


def _needed(sums: Sums, chosen: list[Term], new: Term) -> list[Term]:
    """Terms found before that still pay beside the new one."""
    kept = list(chosen)
    for term in chosen:
        rest = [t for t in kept if t != term]
        if not _pays(sums, sums.compared([*rest, new], [*kept, new]), [*rest, new]):
            kept = rest
    return kept


@dataclass(frozen=True)
class Sample:
    """A residual, as it is taken apart.

    Attributes:
        residual: (n,), unit of its channel.
        blocks: block of time of every value, (n,).
        offsets: columns that are always there, (n, m); m may be 0.
        columns: a term to its columns at the same values, (n, k).
        noise_square: mean square of the noise.
        least: least share of the squared error that a term must take away.
    """

    residual: FloatArray
    blocks: IntegerArray
    offsets: FloatArray
    columns: Callable[[Term], FloatArray]
    noise_square: float
    least: float


class Sums:
    """Normal equations of the columns, per fold: products are taken when a sum asks for them, and kept.

    Not a record: it grows by the terms that are added.
    """

    def __init__(self, sample: Sample) -> None:
        self._sample = sample
        folds = sample.blocks % FOLDS
        self._order = np.argsort(folds, kind="stable")
        ends = np.searchsorted(folds[self._order], np.arange(FOLDS + 1))
        self._folds = [slice(first, last) for first, last in pairwise(ends)]
        self._residual = sample.residual[self._order]
        self._scale: dict[Term | None, FloatArray] = {}
        self._moments: dict[Term | None, FloatArray] = {}
        self._products: dict[tuple[Term | None, Term | None], FloatArray] = {}
        self._left: dict[tuple[Term, ...], FloatArray] = {}
        self._errors: dict[tuple[Term, ...], float] = {}
        self._begun: tuple[tuple[Term, ...], FloatArray, FloatArray] | None = None
        self._latest: Remembered[FloatArray] = Remembered(lambda columns: columns.nbytes, COLUMNS)
        self._take(None)
        self._squares = np.array([float(np.sum(self._residual[fold] ** 2)) for fold in self._folds])

    def add(self, terms: Sequence[Term]) -> None:
        """Take further terms in."""
        for term in terms:
            if term not in self._scale:
                self._take(term)

    def _raw(self, term: Term | None) -> FloatArray:
        """Columns of a term, or the offsets: held once for all channels (`terms.columns_in`): they fill gigabytes."""
        return self._sample.offsets if term is None else self._sample.columns(term)

    def _take(self, term: Term | None) -> None:
        """Take columns of a term in, or those of the offsets."""
        raw = self._raw(term)
        length: FloatArray = np.sqrt(np.sum(raw**2, axis=0))
        self._scale[term] = np.where(length > 0, length, 1.0)
        ordered = self._latest.found(None, term, lambda: raw[self._order] / self._scale[term])
        self._moments[term] = np.stack([ordered[fold].T @ self._residual[fold] for fold in self._folds])
        self._products[term, term] = np.stack([ordered[fold].T @ ordered[fold] for fold in self._folds])

    def _ordered(self, term: Term | None) -> FloatArray:
        """Columns of length one, fold after fold; those of the latest terms are kept."""
        return self._latest.found(None, term, lambda: self._raw(term)[self._order] / self._scale[term])

    def _product(self, one: Term | None, other: Term | None) -> FloatArray:
        """Columns of one term times those of another, (folds, k, l)."""
        if (one, other) not in self._products:
            a, b = self._ordered(one), self._ordered(other)
            found = np.stack([a[fold].T @ b[fold] for fold in self._folds])
            self._products[one, other], self._products[other, one] = found, found.transpose(0, 2, 1)
        return self._products[one, other]

    def _normal(self, terms: Sequence[Term]) -> tuple[FloatArray, FloatArray]:
        """Products of all columns of a set, offsets first, and those with the residual: (folds, k, k), (folds, k).

        A round asks for every term behind the same others, whose products are put together once.
        """
        first = tuple(terms[:-1])
        if self._begun is None or self._begun[0] != first:
            every: list[Term | None] = [None, *first]
            gram = np.concatenate([np.concatenate([self._product(a, b) for b in every], axis=2) for a in every], axis=1)
            self._begun = first, gram, np.concatenate([self._moments[term] for term in every], axis=1)
        _, gram, moment = self._begun
        if not len(terms):
            return gram, moment
        last = terms[-1]
        beside = np.concatenate([self._product(term, last) for term in (None, *first)], axis=1)
        own = np.concatenate([beside.transpose(0, 2, 1), self._product(last, last)], axis=2)
        whole = np.concatenate([np.concatenate([gram, beside], axis=2), own], axis=1)
        return whole, np.concatenate([moment, self._moments[last]], axis=1)

    def _columns(self, terms: Sequence[Term]) -> FloatArray:
        """Columns of length one of a set, offsets first, (n, k)."""
        return np.hstack([self._raw(term) / self._scale[term] for term in (None, *terms)])

    @property
    def _fixed(self) -> int:
        return int(self._sample.offsets.shape[1])

    def _solved(self, gram: FloatArray, moment: FloatArray) -> FloatArray:
        return np.asarray(np.linalg.solve(gram + RIDGE * np.eye(len(moment)), moment), dtype=np.float64)

    def _fold_values(self, terms: Sequence[Term], grams: FloatArray, moments: FloatArray) -> list[FloatArray]:
        """Values fitted without each fold; products as `_normal` gives them."""
        gram, moment = grams.sum(axis=0), moments.sum(axis=0)
        known = np.diag(self._known(terms, gram, moment))
        return [self._solved(gram - g + known, moment - m) for g, m in zip(grams, moments, strict=True)]

    def _known(self, terms: Sequence[Term], gram: FloatArray, moment: FloatArray) -> FloatArray:
        """Information of the prior on each column: a term has one width, the offsets are not known beforehand."""
        values = self._solved(gram, moment)
        square = float(self._squares.sum() - moment @ values) / max(len(self._sample.residual), 1)
        count = self._fixed
        groups = np.repeat(np.arange(len(terms)), [term.size for term in terms])
        squares = np.bincount(groups, weights=values[count:] ** 2) / np.maximum(np.bincount(groups), 1)
        known = np.zeros(len(values))
        known[count:] = prior_information(np.sqrt(squares)[groups], max(square, 0.0))
        return known

    def squared_error(self, terms: Sequence[Term]) -> float:
        """Squared error on blocks not fitted."""
        key = tuple(terms)
        if key not in self._errors:
            total, normal = float(self._squares.sum()), self._normal(terms)
            for values, gram, moment in zip(self._fold_values(terms, *normal), *normal, strict=True):
                total += float(values @ gram @ values - 2 * values @ moment)
            self._errors[key] = total
        return self._errors[key]

    def left_out(self, terms: Sequence[Term]) -> FloatArray:
        """Residual on blocks not fitted, (n,)."""
        key = tuple(terms)
        if key not in self._left:
            columns, left = self._columns(terms), self._sample.residual.copy()
            for fold, values in zip(self._folds, self._fold_values(terms, *self._normal(terms)), strict=True):
                rows = self._order[fold]
                left[rows] -= columns[rows] @ values
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
        gram, moment = (parts.sum(axis=0) for parts in self._normal(terms))
        left: FloatArray = self._sample.residual - self._columns(terms) @ self._solved(gram, moment)
        return left

    def coefficients(self, terms: Sequence[Term]) -> tuple[dict[Term, FloatArray], dict[Term, FloatArray]]:
        """Values and standard errors of each term, from the fit to all.

        The level of a product, the mean of a curve times its factor, is that factor's own function: where another term
        holds it (`_holds_level`) the curve has none. Both would have it, of opposite signs and many times what is left,
        for no more than a different shape near rest. The middle of the sandwich sums over blocks of time, which counts
        correlation inside them.
        """
        gram, moment = (parts.sum(axis=0) for parts in self._normal(terms))
        known = gram + RIDGE * np.eye(len(gram))
        free = self._without_levels(terms, gram)
        inverse = free @ np.linalg.inv(free.T @ known @ free) @ free.T
        scale = np.concatenate([self._scale[term] for term in (None, *terms)])
        columns, solved = self._columns(terms), inverse @ moment
        values = solved / scale
        scores = columns * (self._sample.residual - columns @ solved)[:, None]
        sums = np.zeros((int(self._sample.blocks.max(initial=0)) + 1, len(gram)))
        np.add.at(sums, self._sample.blocks, scores)
        errors = np.linalg.norm(sums @ inverse, axis=0) / scale
        cuts = np.cumsum([self._fixed, *(term.size for term in terms)])[:-1]
        parts, spreads = np.split(values, cuts), np.split(errors, cuts)
        return dict(zip(terms, parts[1:], strict=True)), dict(zip(terms, spreads[1:], strict=True))

    def _without_levels(self, terms: Sequence[Term], gram: FloatArray) -> FloatArray:
        """Directions of all columns, (k, l), along which no product has a level that another term holds."""
        ends = np.cumsum([self._fixed, *(term.size for term in terms)])
        rows = []
        for first, last, term in zip(ends[:-1], ends[1:], terms, strict=True):
            if any(_holds_level(other, term) for other in terms):
                row = np.zeros(len(gram))
                row[first:last] = gram[first:last, first:last] @ self._scale[term]
                rows.append(row)
        return null_space(np.array(rows)) if rows else np.eye(len(gram))


def _holds_level(other: Term, product: Term) -> bool:
    """Whether a term is a function of the factor that a curve is taken times; a velocity has its direction."""
    return (
        bool(product.times)
        and product.form is Form.CURVE
        and not other.times
        and (other.variable in (product.times, "table_velocity"))
    )
