"""Values of a plant found again from a recording of a controlled run, from starts that may be several times wrong.

    minimise  sum_c n_c ln( mean_i e_c,i^2 + s_c^2 )   over the logarithms of the values

| symbol | meaning | unit |
|---|---|---|
| e_c | simulated less recorded channel c | that of the channel |
| s_c, n_c | rms of its sensor noise, number of its samples | that of the channel, 1 |

The logarithm weighs each channel by the error that is left in it (the likelihood of a noise of unknown size, limited
below by the sensor's): far from the solution no channel drowns the others, near it both count by their noise. Gauss-
Newton by forward sensitivities, damped, with the second-order step along curved valleys (geodesic acceleration).

A stiffness that is far too high hardly shows, and others take its place: such a fit ends in a valley of its own. As the
noise is known, so is the error that a right fit leaves; where more is left the fit begins again, with one value moved
across its range, that first which the recording tells worst, and now and then at a draw from the whole range.
Source: Ljung, System Identification (1999), section 10.2; Transtrum, Sethna, arXiv:1201.5885 (2012), section 5.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.stats import qmc

from feeddrive.errors import InputError
from feeddrive.plant.plant import Plant
from feeddrive.servo.sampled import SampledController
from feeddrive.simulate.controlled import TorqueLoop, simulate_controlled
from feeddrive.simulate.sensitivity import SERIES, simulate_sensitivity
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

DRAWN = 2
"""Of so many descents one begins at a draw from the whole range; the others one value away from the best end so far."""

BETTER = 0.01
"""Share of the mean squared error by which an end must be better for descents to begin about it."""

SURE = 5.0
"""Standard errors of the mean squared error of white noise by which a right fit may exceed it."""


@dataclass(frozen=True)
class RecordedRun:
    """A controlled run as it was recorded, from rest at 0.

    Attributes:
        controller: that ran.
        reference: what it was fed, shape (n, number of its references), SI.
        channels: recorded series by their names in `sensitivity.SERIES`, (n,) each, SI.
        noise: rms of each channel's white noise, SI.
        torque_loop: lag and dead time of the motor torque.
    """

    controller: SampledController
    reference: FloatArray
    channels: Mapping[str, FloatArray]
    noise: Mapping[str, float]
    torque_loop: TorqueLoop

    def __post_init__(self) -> None:
        for name, series in self.channels.items():
            if name not in SERIES or len(series) != len(self.reference) or not np.isfinite(series).all():
                raise InputError(f"channel {name!r} cannot be used", "recorded run", f"known are {', '.join(SERIES)}")
            if not self.noise.get(name, 0.0) > 0:
                raise InputError(f"no noise of {name!r}", "recorded run", "give its rms, above zero")


@dataclass(frozen=True)
class OutputErrorFit:
    """Values found.

    Attributes:
        plant: with them.
        values: parameter to value, SI.
        deviation: parameter to its relative standard deviation where the noise is white.
        mean_square: of the errors over the noise; 1 for a right fit.
        converged: whether that is what the noise leaves.
        starts: descents that were made.
        runs: simulations, those with derivatives counted once.
    """

    plant: Plant
    values: Mapping[str, float]
    deviation: Mapping[str, float]
    mean_square: float
    converged: bool
    starts: int
    runs: int


def fit_recorded_run(
    plant: Plant, recorded: RecordedRun, parameters: Sequence[str], factor: float = 4.0, starts: int = 24
) -> OutputErrorFit:
    """Fit values of a plant to a recorded run.

    Args:
        plant: with the values to start from.
        recorded: below the torque limit, at which the run would jump with its values.
        parameters: names as for `simulate_sensitivity`, of the plant; their values are above zero and stay so.
        factor: by which each may be wrong; later starts are within it, the descents themselves are not held to it.
        starts: descents at most.

    Returns:
        The best fit; whether it converged stands in it.

    Raises:
        InputError: an unknown parameter, a value that is not above zero, a start that cannot be simulated, no compiler.
    """
    problem = _Problem(plant, recorded, tuple(parameters))
    begin, step = problem.logarithms(), math.log(factor)
    limit = 1 + SURE * math.sqrt(2 / problem.samples)
    draws = iter(qmc.Sobol(len(begin), seed=0).random(2 ** math.ceil(math.log2(max(starts, 2)))))
    best, made = problem.descent(begin), 1
    jumps = iter(_jumps(best, step) if best is not None else [])
    while made < starts and not (best is not None and best.mean_square < limit):
        jump = next(jumps, None) if made % DRAWN else None
        start = begin + step * (2 * next(draws) - 1) if jump is None else jump
        end = problem.descent(start)
        made += 1
        if end is not None and (best is None or end.mean_square < (1 - BETTER) * best.mean_square):
            best, jumps = end, iter(_jumps(end, step))
    if best is None:
        raise InputError("the recorded run cannot be simulated from any start", plant.name, "check the values")
    return problem.told(best, best.mean_square < limit, made)


@dataclass(frozen=True)
class _End:
    """Where a descent ended: mean squared error over the noise, logarithms, and how well they are told, shape (k,)."""

    mean_square: float
    logs: FloatArray
    spread: FloatArray


def _jumps(end: _End, step: float) -> list[FloatArray]:
    """One logarithm moved at a time, down and up, that first which is told worst."""
    order = np.argsort(-end.spread)
    return [end.logs + sign * step * np.eye(len(order))[i] for i in order for sign in (-1, 1)]


def with_values(plant: Plant, values: Mapping[str, float]) -> Plant:
    """The plant with other values, named `key` for the chain and `label.key` for effects.

    Raises:
        InputError: an unknown name, or a value outside its range.
    """
    chain = dict(plant.chain.values)
    effects = {effect.label: effect for effect in plant.effects}
    for name, value in values.items():
        label, _, key = name.rpartition(".")
        if not label and key in chain:
            chain[key] = value
        elif label in effects and key in effects[label].values:
            effects[label] = effects[label].with_values(**{key: value})
        else:
            raise InputError(f"unknown parameter {name!r}", plant.name, "name a value of the plant")
    changed = tuple(effects[effect.label] for effect in plant.effects)
    return replace(plant, chain=replace(plant.chain, values=chain), effects=changed)


class _Problem:
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
        return np.log(np.array(values, dtype=float))

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

    def descent(self, start: FloatArray) -> _End | None:
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
        return _End(float(np.mean((errors / self.noise[:, None]) ** 2)), at, spread)

    def told(self, end: _End, converged: bool, starts: int) -> OutputErrorFit:
        """The result where a descent ended."""
        values = dict(zip(self.names, map(float, np.exp(end.logs)), strict=True))
        deviation = dict(zip(self.names, map(float, end.spread), strict=True))
        return OutputErrorFit(
            self.at(end.logs), values, deviation, end.mean_square, converged, starts, self.runs
        )  # fmt: skip


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

    def move(self, problem: _Problem, at: FloatArray, damping: float) -> FloatArray:
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
