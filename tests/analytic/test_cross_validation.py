"""Errors on blocks not fitted are those of refitting without them; what one fold alone tells gains nothing."""

from __future__ import annotations

import numpy as np
import pytest

from feeddrive.diagnosis.finding.attempt import Attempt
from feeddrive.diagnosis.likelihood.cross_validation import Prior, compare_left_out, compare_levelled, left_out
from feeddrive.diagnosis.likelihood.fit import Fit
from feeddrive.diagnosis.likelihood.folds import FOLDS, kinds_of_motion
from feeddrive.diagnosis.unexplained.functional_anova import Sample, Sums
from feeddrive.diagnosis.unexplained.terms import Form, Term
from feeddrive.typing import FloatArray

BLOCKS, ROWS = 36, 50
BLOCK = np.repeat(np.arange(BLOCKS), ROWS)
RANDOM = np.random.default_rng(7)
NOISE = RANDOM.standard_normal(len(BLOCK))
SHAPE = RANDOM.standard_normal(len(BLOCK))
OTHER = RANDOM.standard_normal(len(BLOCK))
IN_FOLD, IN_BLOCK = BLOCK % FOLDS == 2, BLOCK == 20

# name: columns, and the true values that make the measurement beside unit noise
SYNTHETIC: dict[str, tuple[list[FloatArray], list[float]]] = {
    "seen everywhere": ([SHAPE], [0.5]),
    "in one fold": ([SHAPE * IN_FOLD], [1.0]),
    "in one fold, beside another": ([SHAPE * IN_FOLD, OTHER], [1.0, 0.5]),
    "in one block": ([SHAPE * IN_BLOCK], [3.0]),
    "in one block, beside another": ([SHAPE * IN_BLOCK, OTHER], [3.0, 0.5]),
    "noise, in one block": ([SHAPE * IN_BLOCK], [0.0]),
    "nearly in one fold": ([SHAPE * np.where(IN_FOLD, 1.0, 1e-6)], [1.0]),
}


def fitted(columns: list[FloatArray], signal: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Residual, columns and values of a fit to all."""
    jacobian = np.column_stack(columns) if columns else np.zeros((len(signal), 0))
    values = np.linalg.lstsq(jacobian, signal, rcond=None)[0]
    return signal - jacobian @ values, jacobian, values


def own_gain(columns: list[FloatArray], signal: FloatArray) -> float:
    """Gain of the first column by `left_out`."""
    residual, jacobian, values = fitted(columns, signal)
    after = left_out(residual, jacobian, BLOCK, Prior(values, np.abs(values)))
    residual, jacobian, values = fitted(columns[1:], signal)
    before = left_out(residual, jacobian, BLOCK, Prior(values, np.abs(values)))
    return compare_left_out(before, after, BLOCK).gain


def refitted_gain(columns: list[FloatArray], signal: FloatArray) -> float:
    """Gain of the first column by fitting anew without each fold; 0 for what a fold alone tells."""
    squares = []
    for chosen in (columns[1:], columns):
        left = signal.copy()
        for fold in range(FOLDS):
            out = fold == BLOCK % FOLDS
            jacobian = np.column_stack(chosen) if chosen else np.zeros((len(signal), 0))
            # a column of which the rest sees less than noise is left at none
            seen = [np.linalg.norm(column[~out]) > 1.0 for column in chosen]
            part = jacobian[:, seen]
            values = np.linalg.lstsq(part[~out], signal[~out], rcond=None)[0]
            left[out] = signal[out] - part[out] @ values
        squares.append(float(left @ left))
    return 1 - squares[1] / squares[0]


@pytest.mark.parametrize("name", SYNTHETIC)
def test_gain_is_that_of_refitting_without_each_fold(name: str) -> None:
    columns, truth = SYNTHETIC[name]
    signal = NOISE + sum(value * column for value, column in zip(truth, columns, strict=True))
    # values told by ten standard deviations and more are drawn to none by at most 1 %, which costs 1e-4 of a gain of
    # 0.2; noise moves the two gains apart by some 2 / rows = 1e-3 of the square
    assert own_gain(columns, signal) == pytest.approx(refitted_gain(columns, signal), abs=1.5e-3)


def test_what_one_fold_alone_tells_gains_nothing() -> None:
    for name in ("in one fold", "in one block", "nearly in one fold"):
        columns, truth = SYNTHETIC[name]
        # beyond rounding; a value from a millionth of the column costs what little it misses
        assert own_gain(columns, NOISE + truth[0] * columns[0]) <= 1e-9, name


def test_sums_of_the_unexplained_agree() -> None:
    """The other implementation, by normal equations, leaves out the same."""
    columns, truth = SYNTHETIC["in one fold, beside another"]
    signal = NOISE + truth[0] * columns[0] + truth[1] * columns[1]
    terms = [Term(Form.LEVEL, "a"), Term(Form.LEVEL, "b")]
    given = {terms[0]: columns[0], terms[1]: columns[1]}
    offsets = np.zeros((len(signal), 0))
    sums = Sums(Sample(signal, BLOCK, offsets, lambda term: given[term][:, None], 1.0, 0.0))
    sums.add(terms)
    residual, jacobian, values = fitted(columns, signal)
    theirs = left_out(residual, jacobian, BLOCK, Prior(values, np.abs(values)))
    # the ridge of the sums is 1e-8 of a column
    np.testing.assert_allclose(sums.left_out(terms), theirs, atol=1e-6)


def test_form_of_a_law_is_kept_where_the_rest_does_not_tell_it() -> None:
    """A column that only moves a form: nothing else tells it, and it stays as fitted."""
    column = SHAPE * IN_FOLD
    residual, jacobian, _ = fitted([column], NOISE + column)
    left = left_out(residual, jacobian, BLOCK, Prior(np.zeros(1), np.ones(1)))
    # drawn by nothing but its own fold's score, which is 0 at the fit
    np.testing.assert_allclose(left, residual, atol=1e-9)


def test_kinds_of_motion() -> None:
    time = np.arange(4000) / 1000
    stroke, chirp = np.full(1000, 2.0), 0.5 + 0.2 * np.sin(300 * time[:1000])
    reversal = np.sin(2 * np.pi * time[:1000])
    speed = np.concatenate([np.zeros(1000), stroke, chirp, reversal])
    assert kinds_of_motion(speed, (time / 0.5).astype(int))[[0, 1, 3, 4, 5]].tolist() == [0, 0, 1, 2, 2]
    assert kinds_of_motion(speed, (time / 1.0).astype(int))[3] == 3


@pytest.mark.parametrize(("law", "pays"), [(0.45, True), (0.0, False)])
def test_a_law_that_one_block_meets_roughly_pays_by_the_others(law: float, pays: bool) -> None:
    """One block holds most of the error and of the law's misfit, and alone makes the scatter of the whole."""
    roughly = np.where(IN_BLOCK, 20.0, 0.0) * OTHER
    before, after = NOISE + law * SHAPE + roughly, NOISE + 0.7 * roughly
    plain, evenly = (of(before, after, BLOCK) for of in (compare_left_out, compare_levelled))
    made = Attempt("law", Fit((), after, np.zeros((ROWS, 0)), np.zeros(0)), plain, None, evenly)  # type: ignore[arg-type]
    assert plain.gain > plain.least and not plain.pays
    assert made.pays is pays
