"""Intervals of fitted parameters that hold where the residual is coloured.

    cov = (J'J)^-1 S (J'J)^-1

S, the covariance of J'r, comes from the spectrum of the residual (`noise_colour`), and along what declared values may
do from noise and their tolerances (`_scores`). Two things that a spectrum cannot see widen a coordinate's interval:

- where the residual is larger at the samples that tell of the coordinate than elsewhere (misfit at reversals), by the
  ratio of the two;
- where sums over blocks of time scatter more than the spectrum says, beyond chance, the blocks are believed instead:
  they count correlation of any form, but are few, so that alone they would make every interval wide and uncertain.

Intervals use Student's t with the degrees of freedom of whichever is used. What the model itself may miss (thermal
plants) is added as the worst it can do to a coordinate: in every channel an error of that rms along the one direction
of the residual that moves it, taken as a bound of 95 %; errors of two channels are independent. Logarithmic
coordinates give intervals that are a factor to either side; all end at the parameter's physical range.
Source: Priestley, Spectral Analysis and Time Series (1981), section 7.8; Liang and Zeger, Biometrika 73 (1986) 13 and
Newey and West, Econometrica 55 (1987) 703 (blocks).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import chdtri, stdtrit

from feeddrive.diagnosis.calibration.value_slopes import SHORT
from feeddrive.diagnosis.certainty.information import inverse_information
from feeddrive.diagnosis.certainty.noise_colour import fitted_away, score_covariance, spectral_freedom
from feeddrive.diagnosis.likelihood.coordinates import (
    LOGARITHMIC,
    coordinate_ends,
    longest_steps,
    read_coordinates,
    spread_to_values,
    write_coordinates,
)
from feeddrive.diagnosis.likelihood.cross_validation import model_error_rows
from feeddrive.diagnosis.likelihood.fit import Fit
from feeddrive.diagnosis.likelihood.folds import blocks_in_time
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.likelihood.slopes import COARSE, difference_of
from feeddrive.diagnosis.motion.predictability import has_play
from feeddrive.effects.base import Effect
from feeddrive.typing import BoolArray, FloatArray, IntegerArray

BEYOND_CHANCE = 0.99
"""Quantile of the blocks' scatter from which they are believed rather than the spectrum."""

Interval = tuple[float, float]


@dataclass(frozen=True)
class Certainty:
    """How well the coordinates of a fit are known.

    Attributes:
        covariance: of the coordinates, shape (k, k).
        reach: half width of the 95 % interval over the standard deviation, shape (k,).
    """

    covariance: FloatArray
    reach: FloatArray

    @property
    def half_covariance(self) -> FloatArray:
        """Covariance scaled so that standard deviations become half widths of 95 % intervals."""
        scaled: FloatArray = self.covariance * np.outer(self.reach, self.reach)
        return scaled


def certainty(problem: Problem, fitted: Fit, held: Sequence[int] = ()) -> Certainty:
    """How well the coordinates of a fit of all effects are known; k is 0 where nothing was fitted.

    Args:
        problem: recordings.
        fitted: effects.
        held: coordinates that stay where they are: the others' covariance is that beside them, their own is 0.
    """
    count = fitted.jacobian.shape[1]
    if not count or not fitted.effects:
        return Certainty(np.zeros((0, 0)), np.zeros(0))
    jacobian = slopes(problem, fitted)
    if not held:
        return _certainty(problem, fitted, jacobian)
    free = np.setdiff1d(np.arange(count), held)
    known = _certainty(problem, fitted, jacobian[:, free])
    covariance, reach = np.zeros((count, count)), np.ones(count)
    covariance[np.ix_(free, free)], reach[free] = known.covariance, known.reach
    return Certainty(covariance, reach)


def certainty_along(problem: Problem, fitted: Fit, group: IntegerArray) -> tuple[FloatArray, Certainty]:
    """How well a group of coordinates is known along the directions that the recordings tell apart.

    A level that all nodes of a curve share may not be told from a declared value that is fitted as well. In the
    covariance of the nodes it drowns, by rounding, what is known of their differences; along directions of its own it
    does not.

    Args:
        problem: recordings.
        fitted: effects.
        group: places of the coordinates, (n,).

    Returns:
        Directions of the group's coordinates, in columns, (n, n), and how well the coordinates along them are known.
    """
    jacobian = slopes(problem, fitted)
    own, others = jacobian[:, group], np.delete(jacobian, group, axis=1)
    if others.shape[1]:
        own = own - others @ np.linalg.lstsq(others, own, rcond=None)[0]
    _, _, rows = np.linalg.svd(own, full_matrices=False)
    return rows.T, _certainty(problem, fitted, own @ rows.T)


def _certainty(problem: Problem, fitted: Fit, jacobian: FloatArray) -> Certainty:
    """How well coordinates are known of which these are the slopes, (m, k)."""
    inverse = inverse_information(jacobian.T @ jacobian)
    rows = [evidence.fit_rows for evidence in problem.evidence]
    middle = _scores(problem, rows, fitted.residual, jacobian)
    influence = jacobian @ inverse
    model = model_error_rows(problem.evidence, [e.thinned(e.fit_rows) for e in problem.evidence])
    model = np.concatenate([model, np.zeros(len(problem.numbers))])
    covariance = inverse @ middle @ inverse
    missed = np.diag(inverse @ fitted_away(problem.evidence, rows, jacobian, inverse) @ inverse)
    widened = np.sqrt(_where_it_matters(problem, fitted.residual, influence) / _left(missed, np.diag(inverse)))
    covariance = covariance * np.outer(widened, widened)
    blocks, freedom = _by_blocks(fitted.residual, influence, blocks_in_time(problem))
    spread = np.diag(covariance)
    believed = blocks > spread * chdtri(freedom, 1 - BEYOND_CHANCE) / freedom
    more = np.sqrt(np.where(believed & (spread > 0), blocks / np.where(spread > 0, spread, 1.0), 1.0))
    covariance = covariance * np.outer(more, more) + influence.T @ (model[:, None] * influence) / 1.96**2
    reach = stdtrit(np.where(believed, freedom, max(spectral_freedom(problem.evidence, rows), 2.0)), 0.975)
    return Certainty(covariance, reach)


def _scores(
    problem: Problem, rows: Sequence[BoolArray], residual: FloatArray, jacobian: FloatArray
) -> FloatArray:  # fmt: skip
    """S of whitened slopes, (k, k): the residual's colour where it is noise, λ where it is what declared values may be.

    Along the slopes of the declared values the scatter is that of noise and of their tolerances, λ by the whitening;
    one residual, in which they are what they are once, does not show it.
    """
    known = problem.whitener
    if known is None:
        return score_covariance(problem.evidence, rows, residual, jacobian)
    along = known.basis.T @ jacobian
    beside = score_covariance(problem.evidence, rows, residual, jacobian - known.basis @ along)
    return beside + known.variance * along.T @ along


def score_variances(problem: Problem, residual: FloatArray, columns: FloatArray) -> FloatArray:
    """Variance of each of the columns' products with the residual, (k,): by its spectrum, widened as intervals are.

    Args:
        problem: recordings.
        residual: weighted, (m,).
        columns: (m, k).
    """
    rows = [evidence.fit_rows for evidence in problem.evidence]
    variance: FloatArray = np.diag(score_covariance(problem.evidence, rows, residual, columns)).copy()
    variance *= _where_it_matters(problem, residual, columns)
    measured = columns[len(columns) - len(problem.numbers) :]  # known to their own deviations
    variance += problem.numbers.weight**2 * np.sum(measured**2, axis=0)
    blocks, freedom = _by_blocks(residual, columns, blocks_in_time(problem))
    believed = blocks > variance * chdtri(freedom, 1 - BEYOND_CHANCE) / freedom
    return np.where(believed, blocks, variance)


def slopes(problem: Problem, fitted: Fit) -> FloatArray:
    """Slopes of the prediction where a fit ended, (m, k).

    Those of the fit are of steps so short that the solver's own show in them, by up to a hundredth, and may be of
    where it came from. A mass is told by a hundredth of what it does where friction, stiffness and the torque constant
    may all be other with it, and what is wrong in its slope by as much is taken for what tells it. So a coordinate is
    moved until all rows together move by `SHORT` deviations, as a declared value is; one at the upper end of its range
    downwards.
    """
    jacobian, base = fitted.jacobian.copy(), problem.predicted(fitted.effects)
    here, (_, high) = read_coordinates(fitted.effects, problem.plant), coordinate_ends(fitted.effects, problem.plant)
    for i, step in enumerate(_steps(problem, fitted)):
        if step > 0:
            there = here.copy()
            there[i] += step if there[i] + step <= high[i] else -step
            moved = problem.predicted(write_coordinates(fitted.effects, problem.plant, there))
            if np.all(np.isfinite(moved)):
                jacobian[:, i] = (moved - base) / (there[i] - here[i])
    return jacobian


def _steps(problem: Problem, fitted: Fit) -> FloatArray:
    """Steps of the coordinates from which their slopes are taken anew, (k,); 0 where the fit's slope is kept."""
    short, still = difference_of(problem), ~fitted.jacobian.any(axis=0)
    known = problem.whitener
    sizes = np.linalg.norm(fitted.jacobian, axis=0) if known is None else known.lengths(fitted.jacobian)
    if short == COARSE or not problem.predictor.of_motion or has_play(fitted.effects):
        return np.where(still, short, 0.0)
    longest = np.maximum(longest_steps(fitted.effects, problem.plant), short)
    return np.where(still, short, np.clip(SHORT / np.where(still, 1.0, sizes), short, longest))


def _left(missed: FloatArray, whole: FloatArray) -> FloatArray:
    """Share of each variance that the residual still shows after the fit, at least a quarter; shape (k,)."""
    share: FloatArray = 1 - missed / np.where(whole > 0, whole, 1.0)
    return np.maximum(share, 0.25)


def _where_it_matters(problem: Problem, residual: FloatArray, influence: FloatArray) -> FloatArray:
    """Residual square where a coordinate is known from, over that of the same channels at large, at least 1; (k,)."""
    weight, level = influence**2, np.full_like(residual, float(np.mean(residual**2)))
    for levels, rows in zip(problem.by_channel(level), problem.by_channel(residual), strict=True):
        for name, part in levels.items():
            part[:] = np.mean(rows[name] ** 2)
    usual = weight.T @ level
    there: FloatArray = weight.T @ residual**2 / np.where(usual > 0, usual, 1.0)
    return np.maximum(there, 1.0)


def _by_blocks(residual: FloatArray, influence: FloatArray, blocks: IntegerArray) -> tuple[FloatArray, FloatArray]:
    """Variance of each coordinate from its sums over blocks and half the products of neighbours, and its freedom."""
    count = int(blocks.max(initial=0)) + 1
    sums, informative = np.zeros((count, influence.shape[1])), np.zeros((count, influence.shape[1]))
    np.add.at(sums, blocks, influence * residual[:, None])
    np.add.at(informative, blocks, influence**2)
    # the neighbours may take variance away by chance; blocks alone are then the safer count
    variance = np.sum(sums**2, axis=0) + np.maximum(np.sum(sums[1:] * sums[:-1], axis=0), 0.0)
    squares = np.sum(informative**2, axis=0)
    informed = np.sum(informative, axis=0) ** 2 / np.where(squares > 0, squares, 1.0)
    return variance, np.maximum(informed - 1, 2.0)


def intervals(problem: Problem, fitted: Fit, known: Certainty) -> list[dict[str, list[Interval] | None]]:
    """95 % intervals per effect and key, SI, one per number of the value; None for parameters that were not fitted."""
    if not fitted.effects:
        return []
    half = spread_to_values(fitted.effects, problem.plant, fitted.coordinates, known.half_covariance)
    return [
        {key: _ends(effect, key, widths) if np.any(widths) else None for key, widths in spans.items()}
        for effect, spans in zip(fitted.effects, half, strict=True)
    ]


def _ends(effect: Effect, key: str, widths: FloatArray) -> list[Interval]:
    """The ends of one parameter's intervals, inside its physical range."""
    parameter, value = effect.parameter(key), effect.values[key]
    numbers = np.atleast_1d(np.asarray(value, dtype=float))
    low, high = numbers - widths, numbers + widths
    if (effect.name, key) in LOGARITHMIC:
        # a factor of e^30 either way is "not known"; more would overflow
        factor = np.exp(np.minimum(widths / numbers, 30.0))
        low, high = numbers / factor, numbers * factor
    low, high = np.maximum(low, parameter.minimum), np.minimum(high, parameter.maximum)
    return [(float(a), float(b)) for a, b in zip(low, high, strict=True)]
