"""Declared values fitted within their tolerances beside a set of effects, and named where they are beyond them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from feeddrive.diagnosis.calibration.calibration import Calibration
from feeddrive.diagnosis.calibration.declared import CalibratedValue, as_effect, calibrated_values
from feeddrive.diagnosis.certainty.noise_colour import score_covariance
from feeddrive.diagnosis.likelihood.evidence import Evidence
from feeddrive.diagnosis.likelihood.fit import Fit, Problem, linear_step
from feeddrive.effects.base import Effect, Value, number
from feeddrive.effects.friction.friction_deviation import FrictionDeviation
from feeddrive.plant.plant import Plant
from feeddrive.recording import Recording
from feeddrive.typing import FloatArray

STEP = 1e-3
"""Change of the logarithm of a value from which its slope is taken; ten times that of a coordinate of size one."""

ENOUGH = 0.1
"""Move of a value over its deviation that needs no new slopes: it moves the evidence by a two-hundredth."""

PASSES = 4
"""New slopes at most, before anything is found."""

TOLERANCE = 2.0
"""Deviations of a coordinate that a tolerance is, by definition (`tolerances`)."""

SURE = 3.0
"""Deviations of what the recordings alone say by which a value must lie beyond its tolerance, and of the gain on blocks
left out where the judged data cannot confirm a name: one of 700 by chance, as some dozen are asked a search."""

UNSEEN = 0.1
"""Deviations by which a value within its tolerance moves all rows together, below which they do not see it: its
interval would be narrower than its tolerance by half a per cent."""


def calibrated(problem: Problem) -> Problem:
    """The problem with its declared values fitted within their tolerances, nothing else being there."""
    if problem.calibration is not None or not isinstance(problem.plant, Plant):
        return problem
    values = calibrated_values(problem.plant)
    if not values:
        return problem
    start = replace(problem, calibration=Calibration(values, np.zeros(len(values)), {}, 1.0))
    start = _without_unseen(recalibrated(start, ()))
    for _ in range(PASSES - 1):
        before, start = start, recalibrated(start, ())
        if np.max(np.abs(_moved(before, start)), initial=0.0) < ENOUGH:
            break
    return recalibrated(start.levelled(), ())


def recalibrated(problem: Problem, effects: Sequence[Effect]) -> Problem:
    """The problem with new slopes, and its declared values as they are most likely beside these effects."""
    known = problem.calibration
    if known is None or not known.values:
        return problem
    slopes = {e.recording: slopes_of(problem, effects, e) for e in problem.evidence}
    sloped = replace(problem, calibration=replace(known, slopes=slopes))
    assert sloped.whitener is not None
    if not np.all(np.isfinite(sloped.whitener.columns)):
        return problem
    residual = sloped.unwhitened(effects)
    # what is left once the values are as they are most likely tells how much a row is worth
    left = residual - sloped.whitener.columns @ (sloped.whitener.most_likely(residual) - known.coordinates)
    variance = _variance(sloped, left)
    sloped = replace(problem, calibration=replace(known, slopes=slopes, variance=variance))
    return _stepped(sloped, effects, residual)


def slopes_of(problem: Problem, effects: Sequence[Effect], evidence: Evidence) -> dict[str, FloatArray]:
    """Channel to its slope with the coordinates of the declared values, (n, k), SI."""
    known = problem.calibration
    assert known is not None
    base = problem.predictor.predict(problem.machine(effects), evidence)
    slopes = {name: np.empty((len(base[name]), len(known.values))) for name in evidence.channels}
    length = STEP if problem.predictor.smooth(problem.plant) else 30 * STEP
    for i, value in enumerate(known.values):
        step = length / value.deviation
        coordinates = known.coordinates.copy()
        coordinates[i] += step
        there = replace(problem, calibration=replace(known, coordinates=coordinates)).machine(effects)
        predicted = problem.predictor.predict(there, evidence)
        for name in evidence.channels:
            slopes[name][:, i] = (predicted[name] - base[name]) / step
    return slopes


def with_recordings(problem: Problem, effects: Sequence[Effect], more: Sequence[Evidence]) -> Problem:
    """The problem with further recordings, their slopes beside those of the others."""
    joined = replace(problem, evidence=(*problem.evidence, *more))
    known = problem.calibration
    if known is None or not known.values:
        return joined
    slopes: dict[Recording, dict[str, FloatArray]] = {e.recording: slopes_of(problem, effects, e) for e in more}
    return replace(joined, calibration=replace(known, slopes={**slopes, **known.slopes}))


def _stepped(problem: Problem, effects: Sequence[Effect], residual: FloatArray) -> Problem:
    """The problem at the most likely values, or as far towards them as the error falls."""
    known = problem.calibration
    assert known is not None and problem.whitener is not None
    wanted = problem.whitener.most_likely(residual)
    before = float(residual @ residual) + known.variance * float(known.coordinates @ known.coordinates)
    for share in (1.0, 0.5, 0.1):
        coordinates = known.coordinates + share * (wanted - known.coordinates)
        there = replace(problem, calibration=replace(known, coordinates=coordinates))
        left = there.unwhitened(effects)
        if np.all(np.isfinite(left)) and left @ left + known.variance * float(coordinates @ coordinates) < before:
            return there
    return problem


def _variance(problem: Problem, residual: FloatArray) -> float:
    """λ: square of a row times the rows that one independent value stands for, along the slopes of the values."""
    assert problem.whitener is not None
    columns = problem.whitener.columns
    score = score_covariance(problem.evidence, [e.fit_rows for e in problem.evidence], residual, columns)
    squares = np.sum(columns**2, axis=0)
    told = squares > 0
    return float(np.median(np.diag(score)[told] / squares[told])) if told.any() else 1.0


def _without_unseen(problem: Problem) -> Problem:
    """The problem without values that its recordings do not see."""
    assert problem.calibration is not None and problem.whitener is not None
    seen = np.sum(problem.whitener.columns**2, axis=0) > UNSEEN**2 * problem.calibration.variance
    return _with(problem, seen)


def _with(problem: Problem, kept: Sequence[bool] | np.ndarray[tuple[int], np.dtype[np.bool_]]) -> Problem:
    known = problem.calibration
    assert known is not None
    places = np.flatnonzero(np.asarray(kept))
    return replace(
        problem,
        calibration=replace(
            known,
            values=tuple(known.values[i] for i in places),
            coordinates=known.coordinates[places],
            slopes={of: {name: k[:, places] for name, k in one.items()} for of, one in known.slopes.items()},
        ),
    )


def _moved(before: Problem, after: Problem) -> FloatArray:
    assert before.calibration is not None and after.calibration is not None
    return after.calibration.coordinates - before.calibration.coordinates


@dataclass(frozen=True)
class Calibrated:
    """A declared value, fitted within its tolerance.

    Attributes:
        value: which.
        coordinate: most likely, as the plant has it.
        deviation: of the coordinate, given the recordings.
        beyond: by how many of its own deviations the recordings alone put the coordinate beyond its tolerance.
    """

    value: CalibratedValue
    coordinate: float
    deviation: float
    beyond: float

    @property
    def number(self) -> float:
        """Most likely value [SI]."""
        return self.value.declared * self.value.factor(self.coordinate)

    @property
    def ci95(self) -> tuple[float, float]:
        """Interval of 95 % [SI]."""
        half = 1.96 * self.deviation
        low, high = (self.value.declared * self.value.factor(self.coordinate + way * half) for way in (-1, 1))
        return low, high


def calibrated_list(problem: Problem, found: Fit) -> tuple[Calibrated, ...]:
    """What is known of the declared values beside a fitted set.

    The information of the recordings is H S⁻¹ H, with H = K'K of the slopes less what the effects' own slopes explain
    and S the covariance of K'r by the colour of the residual; the prior's is one.
    """
    known, whitened = problem.calibration, problem.whitener
    if known is None or whitened is None:
        return ()
    columns, rows = whitened.columns, [e.fit_rows for e in problem.evidence]
    residual = problem.unwhitened(found.effects)
    own = _own_slopes(problem, found)
    columns = (
        columns - own @ np.column_stack([linear_step(own, column) for column in columns.T]) if own.size else columns
    )
    left = residual - whitened.columns @ (whitened.most_likely(residual) - known.coordinates)
    score = score_covariance(problem.evidence, rows, left, columns)
    normal = columns.T @ columns
    weight = normal @ np.linalg.pinv(score, rcond=1e-10, hermitian=True)
    precision = weight @ normal + np.eye(len(normal))
    covariance = np.linalg.inv(0.5 * (precision + precision.T))
    mean = covariance @ (weight @ (columns.T @ (residual + whitened.offset)))
    settled = whitened.most_likely(residual)
    result = []
    for i, value in enumerate(known.values):
        known_to, told = float(covariance[i, i]), max(1 - float(covariance[i, i]), 1e-9)
        beyond, spread = (
            abs(float(mean[i])) / told - TOLERANCE,
            math.sqrt(known_to / told),
        )  # without the prior of this value
        result.append(Calibrated(value, float(settled[i]), math.sqrt(known_to), beyond / spread))
    return tuple(result)


def _own_slopes(problem: Problem, found: Fit) -> FloatArray:
    """Slopes of the effects that were found, not whitened, (m, k)."""
    if not found.effects:
        return np.zeros((0, 0))
    bare = replace(problem, plant=problem.machine(), calibration=None)
    return bare.jacobian(found.effects, [True] * len(found.effects), bare.predicted(found.effects))


def beyond_tolerance(problem: Problem, found: Fit) -> tuple[Problem, Effect] | None:
    """The declared value that is surest to be beyond its tolerance, as an effect; None where none is asserted.

    Returns:
        The problem without it among the values that are fitted, and the effect.
    """
    able = [one for one in calibrated_list(problem, found) if one.value.name and one.beyond > SURE]
    if not able or problem.calibration is None or not isinstance(problem.plant, Plant):
        return None
    best = max(able, key=lambda one: one.beyond).value
    known = problem.calibration
    alike = [(one.name, one.place) == (best.name, best.place) for one in known.values]
    effects = [
        as_effect(problem.plant, one, float(c))
        for one, c, same in zip(known.values, known.coordinates, alike, strict=True)
        if same
    ]
    effect = effects[0]
    if isinstance(effect, FrictionDeviation):  # Coulomb and viscous friction of a port are one effect
        keys = ("coulomb_factor", "viscous_factor")
        factors: dict[str, Value] = {key: float(np.prod([number(e.values[key]) for e in effects])) for key in keys}
        effect = effect.with_values(**factors)
    return _with(problem, [not same for same in alike]), effect
