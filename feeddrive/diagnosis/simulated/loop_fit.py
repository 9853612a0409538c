"""Values of effects fitted by closed-loop simulation error, held where they were where the loop does not tell.

    minimise  sum_c sum_i (e_c,i / s_c)^2 / tau_c  +  (x - x0)' P^-1 (x - x0)

| symbol | meaning | unit |
|---|---|---|
| e_c | recorded less simulated channel c, over the fitted samples | N m, m |
| s_c | its rms after a first fit | N m, m |
| tau_c | samples over which it stays alike: 1 + 2 sum of its autocorrelation | 1 |
| x, x0, P | coordinates of the effects' values, those of the equation error, and their covariance | 1 |

Gauss-Newton with Levenberg's damping, the derivatives of the simulated loop by forward sensitivities. Coordinates
whose derivative does not foretell what a small step does (free play: chaotic motion) or that have none (delays) stay.
Source: Ljung, System Identification (1999), sections 7.4 and 10.2; Bar-Shalom, Li, Kirubarajan, Estimation with
Applications to Tracking and Navigation (2001), section 2.3 (the prior).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from feeddrive.diagnosis.likelihood.coordinates import read_coordinates, write_coordinates
from feeddrive.diagnosis.simulated.loop_evidence import LoopEvidence
from feeddrive.effects.base import Effect, Kind
from feeddrive.engine.step.linear_part import SimulationError
from feeddrive.plant.plant import Plant
from feeddrive.simulate.controlled.sensitivity import simulate_sensitivity
from feeddrive.typing import BoolArray, FloatArray

VALUE_STEP = 1e-6
"""Step of the differences from coordinates to values, which are elementary functions."""

ITERATIONS = 10
FORETOLD = 0.2
"""Share of a small step's outcome that its derivative may be wrong by."""

ENOUGH = 1e-4
"""A step that lowers the objective by less than this share ends the fit."""


@dataclass(frozen=True)
class LoopProblem:
    """What is fitted to what.

    Attributes:
        plant: as declared.
        effects: found, with the values of the equation error.
        loops: recordings that are fitted.
        start: coordinates of the effects, shape (k,).
        precision: inverse covariance of the start, shape (k, k).
        weights: channel to the weight of its squared error [1/unit^2].
        free: coordinates that may move, shape (k,).
    """

    plant: Plant
    effects: tuple[Effect, ...]
    loops: tuple[LoopEvidence, ...]
    start: FloatArray
    precision: FloatArray
    weights: dict[str, float]
    free: BoolArray

    def with_values(self, coordinates: FloatArray) -> Plant:
        """The plant with the effects at some coordinates."""
        return self.plant.with_effects(*write_coordinates(self.effects, self.plant, coordinates))

    def missed(self, plant: Plant) -> FloatArray:
        """Weighted simulation error at the fitted samples of all recordings, shape (m,)."""
        parts = [loop.missed(loop.simulated(plant), loop.fit_rows) for loop in self.loops]
        return np.concatenate([np.sqrt(self.weights[name]) * e for part in parts for name, e in part.items()])

    def held_back(self, coordinates: FloatArray) -> float:
        """What the prior adds to the objective."""
        away = coordinates - self.start
        return float(away @ self.precision @ away)

    def slopes(self, coordinates: FloatArray) -> FloatArray:
        """Derivative of the weighted simulation with the coordinates, shape (m, k); 0 for those that have none."""
        plant = self.with_values(coordinates)
        names, by_coordinate = value_slopes(self, coordinates)
        moved = np.flatnonzero(by_coordinate.any(axis=1))
        chosen = [names[i] for i in moved]
        if not chosen:
            return np.zeros((len(self.missed(plant)), len(coordinates)))
        parts = []
        for loop in self.loops:
            changes = _changes(plant, loop, chosen)
            for name in loop.channels:
                part = changes[name][loop.fit_rows] @ by_coordinate[moved]
                part = part - part.mean(axis=0) if name in loop.evidence.floating else part
                parts.append(np.sqrt(self.weights[name]) * part)
        return np.concatenate(parts)


def loop_problem(
    plant: Plant, effects: Sequence[Effect], loops: Sequence[LoopEvidence], covariance: FloatArray
) -> LoopProblem:
    """The problem with its weights, at the values of the effects.

    Args:
        plant: as declared.
        effects: found.
        loops: recordings that are fitted.
        covariance: of the effects' coordinates, shape (k, k).

    Raises:
        SimulationError: the loop cannot be simulated with these effects.
    """
    weights = _channel_weights(plant.with_effects(*effects), loops)
    free = np.concatenate([np.full(coordinate_count(e, plant), e.kind is not Kind.TIMING) for e in effects])
    start = read_coordinates(effects, plant)
    return LoopProblem(plant, tuple(effects), tuple(loops), start, _inverse(covariance), weights, free)


def _channel_weights(plant: Plant, loops: Sequence[LoopEvidence]) -> dict[str, float]:
    """1 / (s_c^2 tau_c) of every channel, with the errors of this plant."""
    parts = [loop.missed(loop.simulated(plant), loop.fit_rows) for loop in loops]
    weights = {}
    for name in dict.fromkeys(name for part in parts for name in part):
        series = [part[name] for part in parts if name in part]
        power = float(np.mean(np.concatenate(series) ** 2))
        if not np.isfinite(power):
            raise SimulationError("the loop cannot be simulated with the effects found", plant.name, "")
        weights[name] = 1 / (power * float(np.mean([alike(one) for one in series])))
    return weights


def value_slopes(problem: LoopProblem, coordinates: FloatArray) -> tuple[tuple[str, ...], FloatArray]:
    """Names of the effects' values, as sensitivities know them, and their slopes with the free coordinates."""

    def values(at: FloatArray) -> dict[str, float]:
        plant = problem.with_values(at)
        labels = [effect.label for effect in plant.effects[-len(problem.effects) :]]
        flat: dict[str, float] = {}
        for label, effect in zip(labels, plant.effects[-len(problem.effects) :], strict=True):
            for key, value in effect.values.items():
                many = value if isinstance(value, tuple) else (value,)
                keys = [f"{label}.{key}"] if len(many) == 1 else [f"{label}.{key}[{i}]" for i in range(len(many))]
                flat |= {name: float(number) for name, number in zip(keys, many, strict=True)}
        return flat

    base = values(coordinates)
    columns = []
    for i, free in enumerate(problem.free):
        unit = VALUE_STEP * np.eye(len(coordinates))[i]
        up, down = values(coordinates + unit), values(coordinates - unit)
        columns.append([(up[name] - down[name]) / (2 * VALUE_STEP) if free else 0.0 for name in base])
    return tuple(base), np.array(columns, dtype=float).T


def _changes(plant: Plant, loop: LoopEvidence, names: Sequence[str]) -> dict[str, FloatArray]:
    """Channel to its derivatives with the values, shape (n, values)."""
    start = loop.loop.begin(plant, loop.position, loop.velocity)
    controller = loop.loop.started(plant, loop.position, loop.velocity)
    found = simulate_sensitivity(
        plant, controller, loop.reference, names, torque_loop=loop.loop.torque_loop, start=start
    ).changes
    torques = [loop.loop.recorded_torque(found[name]["command"]) for name in names]
    positions = [found[name]["table_position"][:: loop.loop.ticks] for name in names]
    return {"motor_torque": np.column_stack(torques), "table_position": np.column_stack(positions)}


def fit_loop(problem: LoopProblem) -> FloatArray:
    """Coordinates that minimise the objective, from the start, shape (k,).

    The channels are weighed again by what a first fit leaves, and fitted again: values that were far off at the start
    would else decide on the weights.

    Raises:
        SimulationError: the loop cannot be simulated with the effects as they are.
    """
    first = _minimised(problem, problem.start)
    again = replace(problem, weights=_channel_weights(problem.with_values(first), problem.loops))
    return _minimised(again, first)


def _minimised(problem: LoopProblem, start: FloatArray) -> FloatArray:
    at, damping = start, 1e-4
    missed = problem.missed(problem.with_values(at))
    objective = float(missed @ missed) + problem.held_back(at)
    for _ in range(ITERATIONS):
        slopes = problem.slopes(at)
        if not (slopes.any() and np.all(np.isfinite(slopes))):
            break
        normal = slopes.T @ slopes + problem.precision
        pull = slopes.T @ missed - problem.precision @ (at - problem.start)
        for _ in range(6):
            trial = at + _step(normal, pull, damping, problem.free)
            tried = problem.missed(problem.with_values(trial))
            lower = float(tried @ tried) + problem.held_back(trial)
            if lower < objective:  # false where it is not a number
                break
            damping = max(10 * damping, 1e-3)
        else:
            break
        gain, at, missed, objective = 1 - lower / objective, trial, tried, lower
        damping = max(damping / 10, 1e-9)
        if gain < ENOUGH:
            break
    return at


def _step(normal: FloatArray, pull: FloatArray, damping: float, free: BoolArray) -> FloatArray:
    step = np.zeros(len(free))
    inner = normal[np.ix_(free, free)]
    step[free] = np.linalg.lstsq(inner + damping * np.diag(np.diag(inner)), pull[free], rcond=1e-14)[0]
    return step


def foretold(problem: LoopProblem) -> BoolArray:
    """Coordinates whose derivative foretells what a small step does, to a fifth; shape (k,).

    All free coordinates are moved at once by a twentieth of their standard deviation, and one by one only where the
    derivative fails then. Coordinates of which the loop shows nothing pass.
    """
    slopes = problem.slopes(problem.start)
    spread = 1 / np.sqrt(np.maximum(np.diag(problem.precision), 1e-300))
    step = np.where(problem.free & slopes.any(axis=0), np.minimum(0.05 * spread, 0.01), 0.0)
    if _foretells(problem, slopes, step):
        return problem.free.copy()
    good = problem.free.copy()
    for i in np.flatnonzero(step):
        good[i] = _foretells(problem, slopes, np.where(np.arange(len(step)) == i, step, 0.0))
    return good


def _foretells(problem: LoopProblem, slopes: FloatArray, step: FloatArray) -> bool:
    if not step.any():
        return True
    ends = [problem.missed(problem.with_values(problem.start + sign * step)) for sign in (1, -1)]
    found = (ends[1] - ends[0]) / 2  # missed is recorded less simulated
    return bool(np.linalg.norm(found - slopes @ step) < FORETOLD * np.linalg.norm(found))


def alike(series: FloatArray) -> float:
    """Samples over which a series stays alike: 1 + 2 sum of its autocorrelation up to its first zero."""
    about = series - series.mean()
    size = 2 ** int(np.ceil(np.log2(2 * len(about))))
    spectrum = np.abs(np.fft.rfft(about, size)) ** 2
    correlation = np.fft.irfft(spectrum, size)[: len(about)]
    if not correlation[0] > 0:
        return 1.0
    correlation = correlation / correlation[0]
    negative = np.flatnonzero(correlation < 0)
    last = int(negative[0]) if len(negative) else len(correlation)
    return float(1 + 2 * correlation[1:last].sum())


def coordinate_count(effect: Effect, plant: Plant) -> int:
    """Number of coordinates in which an effect is fitted."""
    return len(read_coordinates([effect], plant))


def _inverse(covariance: FloatArray) -> FloatArray:
    """Inverse of a covariance; directions of no spread are taken to be known to a thousandth of the widest."""
    scale = np.sqrt(np.maximum(np.diag(covariance), 0.0))
    scale[scale <= 0] = 1.0
    values, vectors = np.linalg.eigh(covariance / np.outer(scale, scale))
    inverse = vectors @ np.diag(1 / np.maximum(values, 1e-6 * values.max())) @ vectors.T
    scaled: FloatArray = inverse / np.outer(scale, scale)
    return scaled
