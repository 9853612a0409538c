"""Least squares on all channels at once: Levenberg-Marquardt inside the physical range of every value.

A step that would leave the range ends there, and the other values are solved for again. The Jacobian is kept where the
prediction is straight, and corrected where it bends a little, as simulations are what costs time.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from feeddrive.diagnosis.likelihood.coordinates import coordinate_ends, read_coordinates, write_coordinates
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.likelihood.slopes import jacobian_of, placed
from feeddrive.diagnosis.motion.predictability import has_play
from feeddrive.effects.base import Effect
from feeddrive.plant.plant import Plant
from feeddrive.typing import FloatArray

ENOUGH = 1e-4
"""A step that lowers the squared error by less than this share ends the fit."""

MOVED = 0.1
"""Share of a deviation that a fit to the end leaves: intervals are wider by half a per cent for it."""

STRAIGHT = 0.03
"""Bend of the prediction over a step, as a share of the step, below which the slope before it still holds after it."""

BENT = 0.5
"""Bend above which the slope is computed anew; below, it is corrected along the step (Broyden, 1965)."""

FREE = 1e-6
"""Damping that does not hold a step back."""

DAMPED = 6
"""Times that a step is damped, by 30 each: from `FREE` to 81, a step of a hundredth. A spring over the stroke beside
declared ones told of itself by three deviations at no size, and by ten at a twentieth: the step there led four times
too far, and one of a quarter still twice."""


@dataclass(frozen=True)
class Fit:
    """A fitted set of effects.

    Attributes:
        effects: with fitted values, in the order given.
        residual: weighted, at the thinned fitted samples of all channels and recordings, shape (m,).
        jacobian: of the prediction in fit coordinates, weighted alike, shape (m, k).
        coordinates: of the free effects, shape (k,).
        held: number of effects that were not free; they come first.
    """

    effects: tuple[Effect, ...]
    residual: FloatArray
    jacobian: FloatArray
    coordinates: FloatArray
    held: int = 0

    @property
    def free(self) -> tuple[Effect, ...]:
        """The effects that the coordinates are of."""
        return self.effects[self.held :]

    @property
    def squared_error(self) -> float:
        """Sum of the weighted squared residuals; infinite where the plant could not be simulated."""
        return _squared(self.residual)


def fit(
    problem: Problem, effects: Sequence[Effect], free: Sequence[bool] | None = None, iterations: int = 12,
    still: Sequence[int] = (), least: float | None = None,
) -> Fit:  # fmt: skip
    """Fit the free effects by Levenberg-Marquardt, starting from their values.

    Args:
        problem: what is fitted to what.
        effects: beyond the declared ones.
        free: which are fitted, those that are not first; all if None.
        iterations: at most.
        still: coordinates of the free effects that stay as they are.
        least: squared error that a step must take away for another one to follow; a share of it (`ENOUGH`) if None.

    Returns:
        The fit, its Jacobian taken at the end.
    """
    chosen = [True] * len(effects) if free is None else list(free)
    at, jacobian = _descended(problem, effects, chosen, iterations, still, least)
    if jacobian is None:
        jacobian = jacobian_of(problem, at.effects, chosen, at.predicted)
    moved = [effect for effect, is_free in zip(at.effects, chosen, strict=True) if is_free]
    held = chosen.index(True) if any(chosen) else len(chosen)
    return Fit(tuple(at.effects), at.residual, jacobian, read_coordinates(moved, problem.plant), held)


def fitted_to_the_end(problem: Problem, found: Fit) -> Fit:
    """A fit that no step moves by more than `MOVED` of a deviation any more; itself where it is there.

    A share of the squared error ends the other fits: of ten thousand rows that is a step of a deviation along what they
    hardly tell, a mass beside a stiffness and a torque constant, which intervals and values are to be right to.
    """
    least = MOVED**2 * found.squared_error / max(len(found.residual), 1)
    left = found.residual - found.jacobian @ linear_step(found.jacobian, found.residual)
    if found.held or not found.squared_error - _squared(left) > least:
        return found
    return fit(problem, found.effects, least=least)


def fitted_effects(problem: Problem, effects: Sequence[Effect], iterations: int = 12) -> tuple[Effect, ...]:
    """Effects as `fit` leaves them, all free, without the slopes at the end: those are simulations."""
    return tuple(_descended(problem, effects, [True] * len(effects), iterations, (), None)[0].effects)


def _descended(
    problem: Problem, effects: Sequence[Effect], chosen: Sequence[bool], iterations: int, still: Sequence[int],
    least: float | None,
) -> tuple[_State, FloatArray | None]:  # fmt: skip
    """Where the steps of a fit end, and the Jacobian there; None where the last one was taken elsewhere."""
    measured, predicted = problem.measured, problem.predicted(effects)
    at = _State(list(effects), predicted, measured - predicted)
    jacobian, exact = jacobian_of(problem, at.effects, chosen, at.predicted), True
    damping = FREE
    for done in range(iterations):
        if done and problem.budget.is_spent:
            break
        if jacobian.shape[1] == 0 or not np.all(np.isfinite(jacobian)) or not np.isfinite(at.squared_error):
            break
        lower = _lower(problem, at, chosen, jacobian, damping, still)
        damping = lower.damping
        if lower.state is None:
            if exact:
                break
            jacobian, exact = jacobian_of(problem, at.effects, chosen, at.predicted), True
            continue
        before, at, straight = at, lower.state, jacobian @ lower.step
        bent, length = at.predicted - before.predicted - straight, float(np.linalg.norm(straight))
        bend = float(np.linalg.norm(bent)) / length if length > 0 else np.inf
        exact = exact and bend < STRAIGHT
        enough = ENOUGH * before.squared_error if least is None else least
        if before.squared_error - at.squared_error < enough:
            break
        if damping <= FREE and float(bent @ bent) < enough:
            break  # a further step could gain no more than what this one bent
        if bend < BENT:
            jacobian = jacobian + np.outer(bent, lower.step) / float(lower.step @ lower.step)
        else:
            jacobian, exact = jacobian_of(problem, at.effects, chosen, at.predicted), True
    return at, jacobian if exact else None


def error_of(problem: Problem, effects: Sequence[Effect]) -> float:
    """Sum of the weighted squared residuals of effects with the values that they have; infinite as `squared_error`."""
    return _squared(problem.residual(effects))


def _squared(residual: FloatArray) -> float:
    with np.errstate(over="ignore", invalid="ignore"):
        total = float(residual @ residual)
    return total if np.isfinite(total) else float("inf")


@dataclass(frozen=True)
class _State:
    """Effects with the prediction of the plant that has them, and what it misses."""

    effects: list[Effect]
    predicted: FloatArray
    residual: FloatArray

    @property
    def squared_error(self) -> float:
        return _squared(self.residual)


@dataclass(frozen=True)
class _Lower:
    """A step that lowers the squared error; no state where none was found."""

    state: _State | None
    step: FloatArray
    damping: float


def _lower(
    problem: Problem, at: _State, free: Sequence[bool], jacobian: FloatArray, damping: float, still: Sequence[int]
) -> _Lower:
    """A damped step inside the physical range, damped more until it lowers the squared error."""
    measured = at.predicted + at.residual
    moved = [effect for effect, is_free in zip(at.effects, free, strict=True) if is_free]
    start = read_coordinates(moved, problem.plant)
    low, high = coordinate_ends(moved, problem.plant)
    low[list(still)] = high[list(still)] = start[list(still)]
    prior = _prior(moved, problem.plant)
    for _ in range(DAMPED):
        step = inside_step(jacobian, at.residual, damping, low - start, high - start, prior)
        vector = start + step
        effects = placed(at.effects, free, write_coordinates(moved, problem.plant, vector))
        if not problem.possible(effects) and problem.possible(at.effects):
            damping = max(damping * 30, 1e-4)  # a shorter step stays where friction takes power
            continue
        predicted = problem.predicted(effects)
        state = _State(effects, predicted, measured - predicted)
        if state.squared_error < at.squared_error:
            return _Lower(state, step, max(damping * 0.1, 1e-9))
        damping = max(damping * 30, 1e-4)
    return _Lower(None, step, damping)


def _prior(moved: Sequence[Effect], plant: Plant) -> FloatArray:
    """Information that a step is damped by, (k,): of a free play that of its size, of others none.

    Where a load holds the play on one flank no slope tells its width, and a step along one goes anywhere.
    """
    return np.array([float(has_play([effect])) for effect in moved for _ in read_coordinates([effect], plant)])


def inside_step(
    jacobian: FloatArray, residual: FloatArray, damping: float, low: FloatArray, high: FloatArray,
    prior: FloatArray | None = None,
) -> FloatArray:  # fmt: skip
    """Damped Gauss-Newton step that stays inside its ends, each column damped by a share of its own square.

    A coordinate that would leave its range is set to the end of it, and the others are solved for again.

    Args:
        jacobian: shape (m, k).
        residual: shape (m,).
        damping: share of each column's square.
        low, high: ends of the step, shape (k,).
        prior: information of each coordinate, shape (k,), that damps those of which the residual tells less.

    Returns:
        The step, shape (k,); 0 along columns of zeros, or that no number can hold.
    """
    columns, length = unit_columns(jacobian)
    step = np.zeros(len(length))
    free = length > 0
    known = columns.T @ columns + damping * np.eye(len(length))
    if prior is not None:
        hardly = free & (length**2 < prior)
        known += np.diag(np.where(hardly, prior / np.where(hardly, length, 1.0) ** 2, 0.0))
    wanted = columns.T @ residual
    while free.any():
        held = known[np.ix_(free, ~free)] @ (step * length)[~free]
        solved = np.linalg.lstsq(known[np.ix_(free, free)], wanted[free] - held, rcond=1e-14)[0]
        step[free] = solved / length[free]
        outside = free & ((step < low) | (step > high))
        if not outside.any():
            break
        step[outside] = np.clip(step, low, high)[outside]
        free &= ~outside
    return step


def linear_step(jacobian: FloatArray, residual: FloatArray) -> FloatArray:
    """Step (k,) that one linear fit of a residual (m,) makes; 0 along columns of zeros, or that no number can hold."""
    columns, length = unit_columns(jacobian)
    if not len(length) or not np.all(np.isfinite(residual)):
        return np.zeros(len(length))
    step: FloatArray = np.linalg.lstsq(columns, residual, rcond=1e-10)[0] / np.where(length > 0, length, 1.0)
    return np.where(length > 0, step, 0.0)


def unit_columns(jacobian: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Columns of length one and their lengths, (m, k) and (k,); both are 0 for a column of zeros, or not finite."""
    with np.errstate(over="ignore", invalid="ignore"):
        length = np.linalg.norm(jacobian, axis=0)
    usable = np.isfinite(length) & (length > 0)
    columns = np.where(usable, jacobian, 0.0) / np.where(usable, length, 1.0)
    return columns, np.where(usable, length, 0.0)
