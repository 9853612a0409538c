"""Functional analysis of variance: a residual as a sum of functions of one variable, and of products of two.

    e = sum offsets + sum_j f_j(s_j) + sum_jk f_jk(s_j) m_k + noise

Each f is a table (hat functions), a few sines, a step or a level; m is a direction or a velocity. Terms are added one
at a time while they lower the error on blocks of time that were not fitted (folds as in `cross_validation`); of terms
that cannot be distinguished the simplest is taken, a function of one variable before a product.
Sources: Hoeffding, Ann. Math. Stat. 19 (1948) 293; Hooker, J. Comput. Graph. Stat. 16 (2007) 709 (dependent variables);
Roberts et al., Ecography 40 (2017) 913 (blocks).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from feeddrive.diagnosis.likelihood.cross_validation import Comparison
from feeddrive.diagnosis.unexplained.functional_sums import Sample, Sums
from feeddrive.diagnosis.unexplained.terms import Term
from feeddrive.typing import FloatArray

MOST_TERMS = 4
"""Terms at most: what needs more is not read by a person."""

SURE = 3.0
"""Gain over its standard error that is asked for: some sixty terms are tried a round."""

TIE = 0.05
"""Share of the squared error by which a simpler term may be worse, if the difference is within twice its scatter."""

COUNT = 2.0
"""Factor in columns by which a term is simpler."""


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


@dataclass(frozen=True)
class Decomposition:
    """Terms, the strongest first, and coefficients of the offsets, (m,)."""

    found: tuple[Found, ...]
    offsets: FloatArray


def decompose(
    sample: Sample, terms: Sequence[Term], proposed: Callable[[FloatArray], list[Term]],
    refined: Callable[[Term], list[Term]],
) -> Decomposition:  # fmt: skip
    """Take a residual apart.

    Args:
        sample: the residual.
        terms: tried in every round.
        proposed: what is left (n,) to further terms that it suggests, such as sines.
        refined: a term to finer ones of its form.

    Returns:
        The terms that pay, none where nothing does.
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
        chosen, alike[winner] = [*_needed(sums, chosen, winner), winner], others
    shares = {term: sums.compared([c for c in chosen if c != term], chosen).gain for term in chosen}
    scale = {term: sums.left_out([c for c in chosen if c != term]) for term in chosen}
    whole = float(np.sum(sums.left_out([]) ** 2))
    values, errors, offsets = sums.coefficients(chosen)
    found = [
        Found(t, values[t], errors[t], shares[t] * float(np.sum(scale[t] ** 2)) / whole, alike.get(t, ()))
        for t in chosen
    ]
    return Decomposition(tuple(sorted(found, key=lambda one: -one.share)), offsets)


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
