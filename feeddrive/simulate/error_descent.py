"""Descent of the error of a simulated run over the logarithms of a plant's values; equations in `output_error`."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from feeddrive.errors import InputError
from feeddrive.plant.plant import Plant
from feeddrive.simulate.controlled.controlled import simulate_controlled
from feeddrive.simulate.controlled.sensitivity import simulate_sensitivity
from feeddrive.simulate.recorded_run import RecordedRun, with_values
from feeddrive.typing import FloatArray

ITERATIONS = 40
TRIALS = 14
LONGEST = math.log(3.0)
"""Longest step in a logarithm."""

PROBE = 0.1
"""Part of a step after which its curvature is read."""

BENT = 0.75
"""Second-order part over the first-order one beyond which it is left out."""

ENOUGH = 0.02
"""Fall of the objective that ends a descent when it happens twice."""

RANGE = math.log(100.0)
"""Distance from the start, in a logarithm, beyond which nothing is tried."""


@dataclass(frozen=True)
class End:
    """Where a descent ended: mean squared error over the noise, logarithms, and how well they are told, shape (k,)."""

    mean_square: float
    logs: FloatArray
    spread: FloatArray


class RunProblem:
    """Errors and slopes at logarithms of the values; counts its simulations."""

    def __init__(self, plant: Plant, recorded: RecordedRun, names: tuple[str, ...]) -> None:
        self.plant, self.recorded, self.names, self.runs = plant, recorded, names, 0
        self.channels = tuple(recorded.channels)
        self.noise = np.array([recorded.noise[name] for name in self.channels])
        self.samples = len(self.channels) * len(recorded.reference)
        self.begin = self.logarithms()

    def logarithms(self) -> FloatArray:
        """Of the plant's values."""
        given = dict(self.plant.chain.values) | self.plant.effect_values()
        values = [given.get(name) for name in self.names]
        for name, value in zip(self.names, values, strict=True):
            if not (isinstance(value, float | int) and value > 0):
                raise InputError(f"{name} is no value above zero", self.plant.name, "start it above zero")
        logs: FloatArray = np.log(np.array(values, dtype=np.float64))
        return logs

    def at(self, logs: FloatArray) -> Plant:
        """The plant at some logarithms."""
        values = np.exp(np.clip(logs, -700.0, 700.0))
        return with_values(self.plant, dict(zip(self.names, map(float, values), strict=True)))

    def errors(self, logs: FloatArray) -> FloatArray | None:
        """Simulated less recorded, shape (channels, n); None where it cannot be simulated."""
        r = self.recorded
        if np.abs(logs - self.begin).max() > RANGE:
            return None
        self.runs += 1
        try:
            run = simulate_controlled(
                self.at(logs), r.controller, r.reference, torque_loop=r.torque_loop, quantised=False
            )
        except InputError:  # a value outside its range, or a motion that cannot be followed
            return None
        missed: FloatArray = np.array([getattr(run, name) - r.channels[name] for name in self.channels])
        return missed

    def slopes(self, logs: FloatArray) -> FloatArray:
        """Of the simulated channels with the logarithms, shape (channels, n, k)."""
        r, plant, values = self.recorded, self.at(logs), np.exp(logs)
        self.runs += 1
        found = simulate_sensitivity(plant, r.controller, r.reference, self.names, torque_loop=r.torque_loop).changes
        columns = [[found[n][c] * v for n, v in zip(self.names, values, strict=True)] for c in self.channels]
        slopes: FloatArray = np.asarray(columns, dtype=np.float64).transpose(0, 2, 1)
        return slopes

    def objective(self, errors: FloatArray | None) -> float:
        """Of errors; infinite where there are none."""
        if errors is None:
            return math.inf
        return float(errors.shape[1] * np.log(np.mean(errors**2, axis=1) + self.noise**2).sum())

    def descent(self, start: FloatArray) -> End | None:
        """Where a descent ends; None where it cannot begin."""
        at, errors, damping, small = start, self.errors(start), 1e-3, 0
        spread = np.ones(len(start))
        if errors is None:
            return None
        for _ in range(ITERATIONS):
            weight = 1 / np.sqrt(np.mean(errors**2, axis=1) + self.noise**2)
            slopes = np.concatenate(self.slopes(at) * weight[:, None, None])
            spread = _spread(slopes)
            step = _Step(slopes, (errors * weight[:, None]).ravel(), weight)
            before = self.objective(errors)
            for _ in range(TRIALS):
                move = step.move(self, at, damping)
                trial = self.errors(at + move)
                if self.objective(trial) < before:
                    break
                damping *= 4
            else:
                break
            assert trial is not None
            at, errors, damping = at + move, trial, max(damping / 5, 1e-10)
            small = small + 1 if before - self.objective(errors) < ENOUGH else 0
            if small == 2:
                break
        return End(float(np.mean((errors / self.noise[:, None]) ** 2)), at, spread)


def _spread(slopes: FloatArray) -> FloatArray:
    """Standard deviation of each coordinate for errors of size one, from the slopes (m, k)."""
    size = np.linalg.norm(slopes, axis=0)
    scale = np.where(size > 0, size, 1.0)
    scaled = slopes / scale
    inverse = np.linalg.pinv(scaled.T @ scaled, rcond=1e-14, hermitian=True)
    return np.asarray(np.sqrt(np.maximum(np.diag(inverse), 0.0)) / scale)


@dataclass(frozen=True)
class _Step:
    """Weighted slopes (m, k) and errors (m,) at a point, and the weights of the channels."""

    slopes: FloatArray
    errors: FloatArray
    weight: FloatArray

    def move(self, problem: RunProblem, at: FloatArray, damping: float) -> FloatArray:
        """Damped Gauss-Newton step with its second-order part, where that is small against it."""
        normal = self.slopes.T @ self.slopes
        size = np.sqrt(np.diag(normal))
        scale = np.where(size > 0, size, 1.0)
        damped = normal / np.outer(scale, scale) + damping * np.eye(len(size))
        first = -np.linalg.solve(damped, self.slopes.T @ self.errors / scale) / scale
        first *= min(1.0, LONGEST / max(float(np.abs(first).max()), 1e-300))
        probe = problem.errors(at + PROBE * first)
        if probe is None:
            return first
        ahead = (probe * self.weight[:, None]).ravel()
        curvature = 2 / PROBE * ((ahead - self.errors) / PROBE - self.slopes @ first)
        second = -0.5 * np.linalg.solve(damped, self.slopes.T @ curvature / scale) / scale
        bent = np.linalg.norm(scale * second) > BENT * np.linalg.norm(scale * first)
        move: FloatArray = first if bent else first + second
        return move
