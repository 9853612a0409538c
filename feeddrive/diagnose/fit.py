"""Least squares on all channels at once, each weighted by its sensor noise, with the zero of a linear scale left free.

    r_c = (measured_c - predicted_c) / noise_c      in the band, table position less its mean per recording

The Jacobian comes from simulations at slightly changed coordinates; the loop over samples is compiled and exact, so the
differences are smooth. Levenberg-Marquardt; the Jacobian is kept where the prediction is straight, and corrected where
it bends a little, as simulations are what costs time.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from feeddrive.diagnose.coordinates import read_coordinates, write_coordinates
from feeddrive.diagnose.evidence import Evidence
from feeddrive.diagnose.predictor import Machine, Predictor
from feeddrive.effects.base import Effect
from feeddrive.typing import FloatArray

DIFFERENCE = 1e-4
"""Step of the differences in coordinates of size one."""

COARSE = 1e-2
"""The step where a prediction is smooth only beyond 1e-12 m: a simulation that goes from cell to cell of positions ends
one step earlier or later. What has the size one moves the table by nanometres, a hundredth of it by 30 times that."""

ENOUGH = 1e-4
"""A step that lowers the squared error by less than this share ends the fit."""

STRAIGHT = 0.03
"""Bend of the prediction over a step, as a share of the step, below which the slope before it still holds after it."""

BENT = 0.5
"""Bend above which the slope is computed anew; below, it is corrected along the step (Broyden, 1965)."""

FREE = 1e-6
"""Damping that does not hold a step back."""


@dataclass(frozen=True)
class Fit:
    """A fitted set of effects.

    Attributes:
        effects: with fitted values, in the order given.
        residual: weighted, at the thinned fitted samples of all channels and recordings, shape (m,).
        jacobian: of the prediction in fit coordinates, weighted alike, shape (m, k).
        coordinates: shape (k,).
    """

    effects: tuple[Effect, ...]
    residual: FloatArray
    jacobian: FloatArray
    coordinates: FloatArray

    @property
    def squared_error(self) -> float:
        """Sum of the weighted squared residuals; infinite where the plant could not be simulated."""
        total = float(self.residual @ self.residual)
        return total if np.isfinite(total) else float("inf")


@dataclass(frozen=True)
class Problem:
    """Declared plant, recordings, and what predicts them."""

    plant: Machine
    evidence: tuple[Evidence, ...]
    predictor: Predictor[Any, Any]

    def predicted(self, effects: Sequence[Effect]) -> FloatArray:
        """Weighted prediction at the fitted samples of all recordings."""
        plant = self.plant.with_effects(*effects)
        return np.concatenate(
            [e.weighted(self.predictor.predict(plant, e), e.thinned(e.fit_rows)) for e in self.evidence]
        )

    def measured(self) -> FloatArray:
        """Weighted measurement at the fitted samples of all recordings."""
        return np.concatenate([e.weighted(e.measured, e.thinned(e.fit_rows)) for e in self.evidence])

    def residual(self, effects: Sequence[Effect]) -> FloatArray:
        """Weighted residual at the fitted samples of all recordings."""
        return self.measured() - self.predicted(effects)

    @property
    def difference(self) -> float:
        """Step of the differences in coordinates of size one."""
        return DIFFERENCE if self.predictor.smooth(self.plant) else COARSE

    def jacobian(self, effects: Sequence[Effect], free: Sequence[bool], base: FloatArray) -> FloatArray:
        """Slope of the prediction with the coordinates of the free effects."""
        moved = [effect for effect, is_free in zip(effects, free, strict=True) if is_free]
        vector = read_coordinates(moved, self.plant)
        columns = []
        for i in range(len(vector)):
            step = np.zeros(len(vector))
            step[i] = self.difference
            changed = _placed(effects, free, write_coordinates(moved, self.plant, vector + step))
            columns.append((self.predicted(changed) - base) / self.difference)
        return np.column_stack(columns) if columns else np.zeros((len(base), 0))


def fit(
    problem: Problem, effects: Sequence[Effect], free: Sequence[bool] | None = None, iterations: int = 12,
    error_only: bool = False,
) -> Fit:  # fmt: skip
    """Fit the free effects by Levenberg-Marquardt, starting from their values.

    Args:
        problem: what is fitted to what.
        effects: beyond the declared ones; the others keep their values.
        free: which are fitted; all if None.
        iterations: at most.
        error_only: leave out the Jacobian, where only the error of the values as they are is asked for.

    Returns:
        The fit, its Jacobian taken at the end.
    """
    chosen = [True] * len(effects) if free is None else list(free)
    measured, predicted = problem.measured(), problem.predicted(effects)
    at = _State(list(effects), predicted, measured - predicted)
    if error_only:
        return Fit(tuple(effects), at.residual, np.zeros((len(predicted), 0)), np.zeros(0))
    jacobian, exact = problem.jacobian(at.effects, chosen, at.predicted), True
    damping = FREE
    for _ in range(iterations):
        if jacobian.shape[1] == 0 or not np.all(np.isfinite(jacobian)):
            break
        lower = _lower(problem, at, chosen, jacobian, damping)
        damping = lower.damping
        if lower.state is None:
            if exact:
                break
            jacobian, exact = problem.jacobian(at.effects, chosen, at.predicted), True
            continue
        before, at, straight = at, lower.state, jacobian @ lower.step
        bent, length = at.predicted - before.predicted - straight, float(np.linalg.norm(straight))
        bend = float(np.linalg.norm(bent)) / length if length > 0 else np.inf
        exact = exact and bend < STRAIGHT
        if before.squared_error - at.squared_error < ENOUGH * before.squared_error:
            break
        if damping <= FREE and float(bent @ bent) < ENOUGH * at.squared_error:
            break  # a further step could gain no more than what this one bent
        if bend < BENT:
            jacobian = jacobian + np.outer(bent, lower.step) / float(lower.step @ lower.step)
        else:
            jacobian, exact = problem.jacobian(at.effects, chosen, at.predicted), True
    if not exact:
        jacobian = problem.jacobian(at.effects, chosen, at.predicted)
    moved = [effect for effect, is_free in zip(at.effects, chosen, strict=True) if is_free]
    return Fit(tuple(at.effects), at.residual, jacobian, read_coordinates(moved, problem.plant))


@dataclass(frozen=True)
class _State:
    """Effects with the prediction of the plant that has them, and what it misses."""

    effects: list[Effect]
    predicted: FloatArray
    residual: FloatArray

    @property
    def squared_error(self) -> float:
        return float(self.residual @ self.residual)


@dataclass(frozen=True)
class _Lower:
    """A step that lowers the squared error; no state where none was found."""

    state: _State | None
    step: FloatArray
    damping: float


def _lower(problem: Problem, at: _State, free: Sequence[bool], jacobian: FloatArray, damping: float) -> _Lower:
    """A damped Gauss-Newton step, damped more until it lowers the squared error."""
    measured = at.predicted + at.residual
    moved = [effect for effect, is_free in zip(at.effects, free, strict=True) if is_free]
    normal = jacobian.T @ jacobian
    scale = np.diag(normal).copy()
    scale[scale <= 0] = 1.0
    for _ in range(5):
        damped = normal + damping * np.diag(scale)
        step = np.asarray(np.linalg.lstsq(damped, jacobian.T @ at.residual, rcond=1e-14)[0], dtype=np.float64)
        vector = read_coordinates(moved, problem.plant) + step
        effects = _placed(at.effects, free, write_coordinates(moved, problem.plant, vector))
        predicted = problem.predicted(effects)
        state = _State(effects, predicted, measured - predicted)
        if state.squared_error < at.squared_error:  # false where it is not a number
            return _Lower(state, step, max(damping * 0.1, 1e-9))
        damping = max(damping * 30, 1e-4)
    return _Lower(None, step, damping)


def _placed(effects: Sequence[Effect], free: Sequence[bool], moved: Sequence[Effect]) -> list[Effect]:
    rest = iter(moved)
    return [next(rest) if is_free else effect for effect, is_free in zip(effects, free, strict=True)]
