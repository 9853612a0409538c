"""Sets of effects held against each other, each on the samples that it predicts and beside its own declared values.

Sets with a free play decline to predict some samples, and are compared with others on those that both predict; where
only one, A, predicts, the other, B, says how large its error is at most,

    |r_B|² = m c (1 + log max(q_B / c, 1))

in place of the m squares of mean q_B: as likely as a normal distribution of that variance. A must do there as well as
elsewhere, B pays for its freedom. c is the mean square that the better of the two leaves where both predict.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from feeddrive.diagnosis.likelihood.cross_validation import (
    Comparison,
    compare_left_out,
    compare_levelled,
    least_gain,
    left_out_residual,
)
from feeddrive.diagnosis.likelihood.encoder_along import encoder_along
from feeddrive.diagnosis.likelihood.fit import Fit, fit
from feeddrive.diagnosis.likelihood.folds import block_numbers
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.likelihood.set_evidence import log_odds
from feeddrive.diagnosis.motion.predictability import has_play
from feeddrive.effects.base import Effect
from feeddrive.errors import InputError
from feeddrive.typing import BoolArray, FloatArray, IntegerArray


@dataclass(frozen=True)
class Standing:
    """A set of effects with the samples that it predicts, to which it is fitted."""

    problem: Problem
    fit: Fit


ITERATIONS = 4
"""Steps of a set that was fitted to more samples, on those that another predicts as well."""


def odds_between(first: Standing, second: Standing, count: int) -> float:
    """Logarithm of the odds for the second of two sets, each on the samples that it predicts.

    Each stands beside its own declared values: what the others leave unsaid they say within the same tolerances.

    Args:
        first: a set.
        second: another.
        count: candidates and starts that were tried.
    """
    if same_samples(first.problem, second.problem):
        return _odds_beside_encoder(first, second, count, 0.0)
    common = commonly_predicted(second.problem, first.problem)
    own = replace(first.problem, evidence=common.evidence)
    try:
        there = fitted_there(first, own), fitted_there(second, common)
        beyond = excess_beyond(first, second, _level(*there))
        return _odds_beside_encoder(Standing(own, there[0]), Standing(common, there[1]), count, beyond)
    except InputError:  # the first cannot be simulated with what suits the common samples best
        return math.inf


def _odds_beside_encoder(first: Standing, second: Standing, count: int, beyond: float) -> float:
    """`log_odds`, with what the encoder's steps give where the set of more values, or one of as many, is likelier.

    What the data say is smaller for it: a set of fewer values that is likelier by itself needs no simulation.
    """
    odds = log_odds(second.problem, first.fit, second.fit, count, beyond, first.problem)
    more = len(second.fit.coordinates) - len(first.fit.coordinates)
    if more * odds < 0 or not any(e.at_draws for e in second.problem.evidence):
        return odds
    # of as many values, that which leaves more is the one without
    pair = sorted((first, second), key=lambda one: (len(one.fit.coordinates), -one.fit.squared_error))
    plain, other = (one.problem.machine(one.fit.effects) for one in pair)
    encoder = encoder_along(second.problem, plain, other)
    return log_odds(second.problem, first.fit, second.fit, count, beyond, first.problem, encoder)


class Missed(NamedTuple):
    """What two sets miss, (m,) each, with the block of every row, (m,), and the gain that is asked for."""

    before: FloatArray
    after: FloatArray
    blocks: IntegerArray
    least: float

    @property
    def gain(self) -> Comparison:
        """What the second set brings."""
        return compare_left_out(*self)

    @property
    def levelled_gain(self) -> Comparison:
        """What the second set brings, with every block over the level of what both leave of it."""
        return compare_levelled(*self)


def gain_between(first: Standing, second: Standing, in_folds: bool = True) -> Comparison:
    """What the second of two sets brings, as `missed_by`."""
    return missed_by(first, second, in_folds).gain


def missed_by(first: Standing, second: Standing, in_folds: bool = True) -> Missed:
    """What two sets miss, each on the samples that it predicts.

    Args:
        first: a set.
        second: another.
        in_folds: on blocks left out; else as fitted, where a free play leaves too few blocks to leave one out.
    """
    blocks, others = block_numbers(first.problem), block_numbers(second.problem)
    without, errors = first.fit.residual, second.fit.residual
    if in_folds:
        without = left_out_residual(first.problem, first.fit, blocks)
        errors = left_out_residual(second.problem, second.fit, others)
    if same_samples(first.problem, second.problem):
        return Missed(without, errors, others, least_gain(second.problem, without, errors))
    inside, its = _inside(first.problem, second.problem), _inside(second.problem, first.problem)
    before, after = without[inside], errors[its]
    least = least_gain(commonly_predicted(second.problem, first.problem), before, after)
    level = min(float(before @ before), float(after @ after)) / max(len(before), 1)
    without, errors = without[~inside], errors[~its]
    first_declines = declining(errors, second.problem.residual(first.fit.effects)[~its], level)
    second_declines = declining(without, first.problem.residual(second.fit.effects)[~inside], level)
    return Missed(
        np.concatenate([before, without, first_declines]),
        np.concatenate([after, second_declines, errors]),
        np.concatenate([others[its], blocks[~inside], others[~its]]),
        least,
    )


def excess_beyond(first: Standing, second: Standing, level: float) -> float:
    """Squared error of the first set less that of the second on samples that one of them alone predicts.

    Args:
        first: a set.
        second: another.
        level: c, mean square on the samples that both predict.
    """
    total = 0.0
    for sign, able, other in ((1, first, second), (-1, second, first)):
        alone = ~_inside(able.problem, other.problem)
        if alone.any():
            error = able.fit.residual[alone]
            asked = able.problem
            if other.problem.calibration is not asked.calibration:  # each beside its own declared values
                asked = replace(other.problem, evidence=asked.evidence)
            declines = declining(error, asked.residual(other.fit.effects)[alone], level)
            total += sign * float(error @ error - declines @ declines)
    return total


def declining(error: FloatArray, own: FloatArray, level: float) -> FloatArray:
    """The residual, (m,), that is as likely as what a set says of samples that it declines to predict.

    Args:
        error: of another set that predicts them, (m,).
        own: of the set itself, if it is asked nevertheless, (m,).
        level: c, mean square on the samples that both predict.
    """
    if not len(own):
        return own
    square = float(np.mean(own**2))
    beyond = math.log(square / level) if level > 0 and np.isfinite(square) and square > level else 0.0
    return np.copysign(math.sqrt(level * (1 + beyond)), error)


def same_samples(one: Problem, other: Problem) -> bool:
    """Whether two problems, of the same recordings, weigh the same samples alike."""
    return all(
        a is b or (np.array_equal(a.fit_rows, b.fit_rows) and a.weighs_as(b))
        for a, b in zip(one.evidence, other.evidence, strict=True)
    )


def regained(problem: Problem, effects: Sequence[Effect]) -> Problem:
    """The problem with the samples again that a free play left unpredictable, where none of these effects is one."""
    if has_play(effects) or all(e.whole is e for e in problem.evidence):
        return problem
    return replace(problem, evidence=tuple(e.whole for e in problem.evidence))


def commonly_predicted(problem: Problem, other: Problem) -> Problem:
    """A problem on the samples that another one has as well, weighed as in the one that weighs a sample less."""
    pairs = zip(problem.evidence, other.evidence, strict=True)
    return replace(problem, evidence=tuple(mine.within(its) for mine, its in pairs))


def fitted_there(one: Standing, common: Problem) -> Fit:
    """A set fitted to fewer samples."""
    return one.fit if same_samples(one.problem, common) else fit(common, one.fit.effects, iterations=ITERATIONS)


def _level(*fits: Fit) -> float:
    return min(one.squared_error / max(len(one.residual), 1) for one in fits)


def _inside(problem: Problem, other: Problem) -> BoolArray:
    """Which rows of the residual of a problem another one has as well, (m,)."""
    parts = []
    for mine, its in zip(problem.evidence, other.evidence, strict=True):
        parts += [its.fit_rows[mine.thinned(mine.fit_rows)]] * len(mine.channels)
    parts.append(np.ones(len(problem.numbers), dtype=bool))
    return np.concatenate(parts)
