"""Least squares on all channels at once, each weighted by its sensor noise, with the zero of a linear scale left free.

    r_c = (measured_c - predicted_c) / noise_c      in the band, table position less its mean per recording

The Jacobian comes from simulations at slightly changed coordinates; the loop over samples is compiled and exact, so the
differences are smooth. Levenberg-Marquardt inside the physical range of every value: a step that would leave it ends
there, and the others are solved for again. The Jacobian is kept where the prediction is straight, and corrected where
it bends a little, as simulations are what costs time.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from feeddrive.diagnosis.budget import Budget
from feeddrive.diagnosis.calibration.calibration import Calibration, Whitener, whitener
from feeddrive.diagnosis.calibration.declared import with_values
from feeddrive.diagnosis.finding.remembered import Remembered, effects_key
from feeddrive.diagnosis.likelihood.coordinates import (
    coordinate_ends,
    longest_steps,
    numbers,
    read_coordinates,
    value_slopes,
    write_coordinates,
)
from feeddrive.diagnosis.likelihood.evidence import Evidence
from feeddrive.diagnosis.likelihood.predictability import has_play
from feeddrive.diagnosis.likelihood.predictor import Predictor
from feeddrive.diagnosis.numbers.number_rows import MeasuredRows
from feeddrive.effects.base import Effect
from feeddrive.plant.passive_friction import is_passive
from feeddrive.plant.plant import Plant
from feeddrive.typing import FloatArray

DIFFERENCE = 1e-4
"""Step of the differences in coordinates of size one."""

COARSE = 1e-2
"""The step where a prediction is smooth only beyond 1e-12 m: a simulation that goes from cell to cell of positions ends
one step earlier or later. What has the size one moves the table by nanometres, a hundredth of it by 30 times that."""

ENOUGH = 1e-4
"""A step that lowers the squared error by less than this share ends the fit."""

SEEN = 0.5
"""Move of all rows together, in deviations, from which a difference is believed where a prediction goes from cell to
cell: the cells leave some hundredths. What declared values do as well is whitened away, and the step that is long
enough for a prediction shows nothing but cells in what is left of it. With free play it is the move of the median row:
a table that bounces goes elsewhere however short the step, and of its rows the slope tells nothing."""

BENT_AT = 0.1
"""Share of a step at which its bend is read: a hundredth of that of the whole, and still some deviations of the noise
where a step fails."""

STRAIGHT = 0.03
"""Bend of the prediction over a step, as a share of the step, below which the slope before it still holds after it."""

BENT = 0.5
"""Bend above which the slope is computed anew; below, it is corrected along the step (Broyden, 1965)."""

LEVEL = 0.8
"""Residual over the noise that a channel is stated to have, below which the noise is put right: a level read from
the quietest tenth of the blocks is known to some per cent."""

PREDICTIONS = 8_000_000
"""Bytes of predictions that a problem keeps: some twenty of a minute at 2 kHz."""

UNEXPLAINED = 1.3
"""Weighted squared error per sample beyond which much is left; noise alone gives one."""

FREE = 1e-6
"""Damping that does not hold a step back."""


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
        with np.errstate(over="ignore", invalid="ignore"):
            total = float(self.residual @ self.residual)
        return total if np.isfinite(total) else float("inf")


@dataclass(frozen=True)
class Problem:
    """Declared plant, recordings, what predicts them, and the declared values that are fitted within their tolerances.

    Attributes:
        plant: as declared.
        evidence: recordings.
        predictor: of their kind.
        calibration: of the declared values; None where all are taken as exact.
        numbers: measured beside the recordings; their rows stand behind those of all recordings.
        budget: of time.
    """

    plant: Plant
    evidence: tuple[Evidence, ...]
    predictor: Predictor[Any]
    calibration: Calibration | None = None
    numbers: MeasuredRows = field(default_factory=MeasuredRows)
    budget: Budget = field(default_factory=Budget, compare=False)

    def machine(self, effects: Sequence[Effect] = ()) -> Plant:
        """The plant with its declared values as calibrated, and further effects."""
        return self._calibrated.with_effects(*effects)

    @cached_property
    def _calibrated(self) -> Plant:
        if self.calibration is None:
            return self.plant
        return with_values(self.plant, self.calibration.values, self.calibration.coordinates)

    @cached_property
    def whitener(self) -> Whitener | None:
        """What takes away the part of a series that declared values within their tolerances may stand for."""
        known = self.calibration
        if known is None or not known.values:
            return None
        count = len(known.values)
        rows = sum(int(e.thinned(e.fit_rows).sum()) * len(e.channels) for e in self.evidence)
        columns = np.empty((rows + len(self.numbers), count))
        columns[rows:] = self.numbers.weight * known.number_slopes if len(self.numbers) else 0.0
        for i in range(count):
            parts = [
                e.weighted({name: known.slopes[e.recording][name][:, i] for name in e.channels}, e.thinned(e.fit_rows))
                for e in self.evidence
            ]
            columns[:rows, i] = np.concatenate(parts)
        return whitener(columns, known.coordinates, known.variance)

    def at_values(self, coordinates: FloatArray, variance: float | None = None) -> Problem:
        """The problem with other coordinates of its declared values, (k,), and another λ; its slopes as they are."""
        known = self.calibration
        assert known is not None
        variance = known.variance if variance is None else variance
        there = replace(self, calibration=replace(known, coordinates=coordinates, variance=variance))
        weighed = self.__dict__.get("whitener")  # where it was asked for: the slopes need not be weighed again
        if weighed is not None:
            there.__dict__["whitener"] = weighed.at(coordinates, variance)
        return there

    def levelled(self, effects: Sequence[Effect] = ()) -> Problem:
        """The problem with no channel's noise above what is left of it: a sensor adds no more than the residual holds.

        The noise is read from fourth differences, which in a stiff loop hold what the drive does as well.
        """
        evidence = []
        for e, rows in zip(self.evidence, self.by_channel(self.residual(effects)), strict=True):
            left = {name: float(np.mean(one**2)) for name, one in rows.items()}
            level = {name: math.sqrt(one) if 0 < one < LEVEL**2 else 1.0 for name, one in left.items()}
            evidence.append(replace(e, noise={name: noise * level.get(name, 1.0) for name, noise in e.noise.items()}))
        return replace(self, evidence=tuple(evidence))

    def by_channel(self, residual: FloatArray) -> list[dict[str, FloatArray]]:
        """Per recording, channel to its rows of a residual, (rows,) each."""
        found, first = [], 0
        for e in self.evidence:
            count, rows = int(e.thinned(e.fit_rows).sum()), {}
            for name in e.channels:
                rows[name] = residual[first : first + count]
                first += count
            found.append(rows)
        return found

    def balanced(self, effects: Sequence[Effect]) -> Problem:
        """The problem with each channel weighed by what is left of it, beside the channel that is met best.

        A channel whose noise is far below what the model reaches, a current with ripple and structure beside a scale,
        holds an error of the model, whose variance is not known: the most likely one is its mean square, n/2 log r'r in
        place of r'r / 2 σ². Weighed by its noise it would lead everything that the other channel tells astray.

        Args:
            effects: found, with the declared values as they are.
        """
        plain = self.plain
        if len({name for e in self.evidence for name in e.channels}) < 2 or not self.predictor.of_motion:
            return plain
        recordings = plain.by_channel(plain.residual(effects))
        left = {
            name: math.sqrt(float(np.mean(np.concatenate([rows[name] ** 2 for rows in recordings if name in rows]))))
            for name in dict.fromkeys(name for rows in recordings for name in rows)
        }
        if not all(np.isfinite(one) for one in left.values()):
            return self
        least = max(1.0, min(left.values()))
        used = self.evidence[0].left
        if all(LEVEL < left[name] / least / used.get(name, 1.0) < 1 / LEVEL for name in left):
            return self  # as it is weighed, but for a few
        return self.weighed({name: one / least for name, one in left.items() if one * LEVEL > least})

    def weighed(self, left: dict[str, float]) -> Problem:
        """The problem with other factors on the noise of channels."""
        if all(e.left == left for e in self.evidence):
            return self
        return replace(self, evidence=tuple(replace(e, left=left) for e in self.evidence))

    @property
    def plain(self) -> Problem:
        """The problem with every channel weighed by its noise."""
        return self.weighed({})

    def plain_error(self, effects: Sequence[Effect]) -> float:
        """Weighted squared error per row, every channel weighed by its noise."""
        residual = self.plain.residual(effects)
        return float(residual @ residual) / max(len(residual), 1)

    def unwhitened(self, effects: Sequence[Effect]) -> FloatArray:
        """Measured less predicted over the noise at the fitted samples of all recordings."""
        plant, parts = self.machine(effects), []
        for e in self.evidence:
            predicted = self.predictor.predict(plant, e)
            rows = e.thinned(e.fit_rows)
            parts.append(e.weighted(e.measured, rows) - e.weighted(predicted, rows))
        if len(self.numbers):
            parts.append(self.numbers.measured() - self._numbers(effects))
        return np.concatenate(parts)

    def _numbers(self, effects: Sequence[Effect]) -> FloatArray:
        """The rows of the measured numbers."""
        return self.numbers.predicted(self.machine(effects))

    def predicted(self, effects: Sequence[Effect]) -> FloatArray:
        """Weighted prediction at the fitted samples of all recordings, whitened; to be read only."""
        return self._predictions.found(None, effects_key(effects), lambda: self._predicted(effects))

    @cached_property
    def _predictions(self) -> Remembered[FloatArray]:
        """The latest predictions: every candidate of a round asks for the set at hand again."""
        return Remembered(lambda rows: rows.nbytes, PREDICTIONS)

    def _predicted(self, effects: Sequence[Effect]) -> FloatArray:
        plant = self.machine(effects)
        rows = np.concatenate(
            [e.weighted(self.predictor.predict(plant, e), e.thinned(e.fit_rows)) for e in self.evidence]
            + ([self._numbers(effects)] if len(self.numbers) else [])
        )
        known = self.whitener
        found = rows if known is None else known.applied(rows - known.offset)
        found.flags.writeable = False
        return found

    def possible(self, effects: Sequence[Effect]) -> bool:
        """Whether the plant with these effects is one that a file may hold: its friction takes power everywhere."""
        plant = self.machine(effects)
        return not self.predictor.of_motion or is_passive(plant)

    @cached_property
    def measured(self) -> FloatArray:
        """Weighted measurement at the fitted samples of all recordings, whitened."""
        rows = np.concatenate(
            [e.weighted(e.measured, e.thinned(e.fit_rows)) for e in self.evidence]
            + ([self.numbers.measured()] if len(self.numbers) else [])
        )
        return rows if self.whitener is None else self.whitener.applied(rows)

    def residual(self, effects: Sequence[Effect]) -> FloatArray:
        """Weighted residual at the fitted samples of all recordings, whitened."""
        return self.measured - self.predicted(effects)

    def settled(self, effects: Sequence[Effect]) -> Problem:
        """The problem with its declared values as they are most likely with these effects."""
        return self if self.whitener is None else self.stepped(effects, self.unwhitened(effects))

    def stepped(self, effects: Sequence[Effect], residual: FloatArray) -> Problem:
        """The problem at the most likely declared values, or as far towards them as the error falls.

        Where the straight step takes less than half of what its slopes promise, what its tenth bends the prediction by
        is fitted as well, and the values go along c + s d + s^2 a: values that stand in for each other, an inertia, a
        mass and a torque constant, lie in a narrow valley, straight for some of them in the values and for others in
        their logarithms. Source: Transtrum and Sethna, arXiv:1201.5885 (2012), section 3.

        Args:
            effects: beside them.
            residual: not whitened, with the values as they are, (m,).
        """
        known, slopes = self.calibration, self.whitener
        if known is None or slopes is None or not np.all(np.isfinite(residual)):
            return self
        step = slopes.most_likely(residual) - known.coordinates
        possible = self.possible(effects)

        def at(share: float, bend: FloatArray) -> tuple[float, Problem, FloatArray]:
            coordinates = known.coordinates + share * step + share**2 * bend
            there = self.at_values(coordinates)
            if possible and not there.possible(effects):  # friction that an effect takes more than all of
                return math.inf, there, residual
            left = there.unwhitened(effects)
            cost = float(left @ left) + known.variance * float(coordinates @ coordinates)
            return cost if math.isfinite(cost) else math.inf, there, left

        straight = np.zeros(len(step))
        before = float(residual @ residual) + known.variance * float(known.coordinates @ known.coordinates)
        promised = residual - slopes.columns @ step
        least = float(promised @ promised) + known.variance * float(np.sum((known.coordinates + step) ** 2))
        whole, there, _ = at(1.0, straight)
        if before - whole >= 0.5 * (before - least):
            return there
        best, other, left = at(BENT_AT, straight)
        if not math.isfinite(best):
            return there if whole < before else self
        best, there = min((whole, there), (best, other), key=lambda one: one[0])
        bent = (left - residual) / BENT_AT**2 + slopes.columns @ step / BENT_AT
        bend = slopes.most_likely(bent - slopes.offset)
        for share in (1.0, 0.5, 0.25):
            cost, other, _ = at(share, bend)
            if cost > best and best < before:
                break
            if cost < best:
                best, there = cost, other
        return there if best < before else self

    @property
    def difference(self) -> float:
        """Step of the differences in coordinates of size one."""
        return DIFFERENCE if self.predictor.smooth(self.plant) else COARSE

    def jacobian(self, effects: Sequence[Effect], free: Sequence[bool], base: FloatArray) -> FloatArray:
        """Slope of the prediction with the coordinates of the free effects."""
        moved = [effect for effect, is_free in zip(effects, free, strict=True) if is_free]
        vector = read_coordinates(moved, self.plant)
        if moved and (exact := self._exact_jacobian(effects, moved, vector)) is not None:
            return exact
        _, high = coordinate_ends(moved, self.plant)
        bounces = has_play(effects) and any(e.lost is not None for e in self.evidence)
        longest = longest_steps(moved, self.plant)
        coarse = bounces or not self.predictor.smooth(self.plant)
        short = COARSE if coarse else DIFFERENCE
        columns = []
        for i in range(len(vector)):
            step = np.zeros(len(vector))
            step[i] = short if vector[i] + short <= high[i] else -short
            moves = self._moves(effects, free, moved, vector + step, base)
            size = float(np.median(np.abs(moves)) if bounces else np.linalg.norm(moves))
            if coarse and size < SEEN:
                far = min(longest[i], short * SEEN / max(size, 1e-3 * SEEN))
                step[i] = far if vector[i] + far <= high[i] else -far
                moves = self._moves(effects, free, moved, vector + step, base)
            columns.append(moves / step[i])
        return np.column_stack(columns) if columns else np.zeros((len(base), 0))

    def _moves(
        self, effects: Sequence[Effect], free: Sequence[bool], moved: Sequence[Effect], to: FloatArray, base: FloatArray
    ) -> FloatArray:
        """What the prediction changes by when the free effects go to other coordinates."""
        return self.predicted(_placed(effects, free, write_coordinates(moved, self.plant, to))) - base

    def _exact_jacobian(
        self, effects: Sequence[Effect], moved: Sequence[Effect], vector: FloatArray
    ) -> FloatArray | None:
        """The slope by the predictor's own sensitivities, where it has them; the moved effects come last."""
        plant = self.plant.with_effects(*effects)
        labelled = plant.effects[len(plant.effects) - len(moved) :]
        names = [f"{to.label}.{name}" for to, effect in zip(labelled, moved, strict=True) for name in numbers(effect)]
        columns = []
        for e in self.evidence:
            found = self.predictor.slopes(plant, e, names)
            if found is None:
                return None
            rows = e.thinned(e.fit_rows)
            parts = [e.weighted({c: s[:, i] for c, s in found.items()}, rows) for i in range(len(names))]
            columns.append(np.column_stack(parts))
        if not columns:
            return None
        return np.asarray(np.vstack(columns) @ value_slopes(moved, self.plant, vector))


def fit(
    problem: Problem, effects: Sequence[Effect], free: Sequence[bool] | None = None, iterations: int = 12,
    error_only: bool = False,
) -> Fit:  # fmt: skip
    """Fit the free effects by Levenberg-Marquardt, starting from their values.

    Args:
        problem: what is fitted to what.
        effects: beyond the declared ones.
        free: which are fitted, those that are not first; all if None.
        iterations: at most.
        error_only: leave out the Jacobian, where only the error of the values as they are is asked for.

    Returns:
        The fit, its Jacobian taken at the end.
    """
    chosen = [True] * len(effects) if free is None else list(free)
    measured, predicted = problem.measured, problem.predicted(effects)
    at = _State(list(effects), predicted, measured - predicted)
    if error_only:
        return Fit(tuple(effects), at.residual, np.zeros((len(predicted), 0)), np.zeros(0), len(effects))
    jacobian, exact = problem.jacobian(at.effects, chosen, at.predicted), True
    damping = FREE
    for done in range(iterations):
        if done and problem.budget.is_spent:
            break
        if jacobian.shape[1] == 0 or not np.all(np.isfinite(jacobian)) or not np.isfinite(at.squared_error):
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
    held = chosen.index(True) if any(chosen) else len(chosen)
    return Fit(tuple(at.effects), at.residual, jacobian, read_coordinates(moved, problem.plant), held)


@dataclass(frozen=True)
class _State:
    """Effects with the prediction of the plant that has them, and what it misses."""

    effects: list[Effect]
    predicted: FloatArray
    residual: FloatArray

    @property
    def squared_error(self) -> float:
        with np.errstate(over="ignore", invalid="ignore"):
            return float(self.residual @ self.residual)


@dataclass(frozen=True)
class _Lower:
    """A step that lowers the squared error; no state where none was found."""

    state: _State | None
    step: FloatArray
    damping: float


def _lower(problem: Problem, at: _State, free: Sequence[bool], jacobian: FloatArray, damping: float) -> _Lower:
    """A damped step inside the physical range, damped more until it lowers the squared error."""
    measured = at.predicted + at.residual
    moved = [effect for effect, is_free in zip(at.effects, free, strict=True) if is_free]
    start = read_coordinates(moved, problem.plant)
    low, high = coordinate_ends(moved, problem.plant)
    prior = _prior(moved, problem.plant)
    for _ in range(5):
        step = inside_step(jacobian, at.residual, damping, low - start, high - start, prior)
        vector = start + step
        effects = _placed(at.effects, free, write_coordinates(moved, problem.plant, vector))
        if not problem.possible(effects) and problem.possible(at.effects):
            damping = max(damping * 30, 1e-4)  # a shorter step stays where friction takes power
            continue
        predicted = problem.predicted(effects)
        state = _State(effects, predicted, measured - predicted)
        if state.squared_error < at.squared_error:  # false where it is not a number
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


def _placed(effects: Sequence[Effect], free: Sequence[bool], moved: Sequence[Effect]) -> list[Effect]:
    rest = iter(moved)
    return [next(rest) if is_free else effect for effect, is_free in zip(effects, free, strict=True)]
