"""Which values and additions a measured frequency response asks for, by the evidence of every set that is tried.

    v_k = a² (1 - γ_k²) / (2 γ_k²) + d²
    log p(r|S) = 1/τ Σ_k [-(Re² + Im²) r_k / (2 v_k) - ln(2π v_k)] - ½ Σ θ_i²/p_i² - ½ log det(1 + P^½ J'V^-1 J P^½/τ)

| symbol | meaning | unit |
|---|---|---|
| γ² | coherence; the first term is its scatter of one average (Bendat, Piersol, Random Data, sec. 9.1) | 1 |
| a² | one over the averages, inferred from the residual | 1 |
| d | discrepancy of the plant's law, relative, inferred likewise | 1 |
| τ | lines that one independent line stands for: 1 + 2 Σ ρ_l over the whitened residual's correlation ρ_l | 1 |
| p_i | standard deviation of coordinate i before the measurement, `numbers.explanations` | 1 |

Values move within their tolerances in every set. Round after round the addition or the value beyond its tolerance that
raises the evidence most is taken, its share of the prior included; then what no longer raises it is dropped. Two sets
are compared with the τ of the one that leaves less.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import least_squares, minimize

from feeddrive.diagnosis.likelihood.set_evidence import log_prior_of_size
from feeddrive.diagnosis.likelihood.tolerances import BEYOND
from feeddrive.diagnosis.responses.response_problem import Lines, ResponseProblem
from feeddrive.errors import InputError
from feeddrive.typing import FloatArray

MOST = 4
"""Values beyond their tolerances and additions at once; more is another machine."""

STARTS = 3
"""Places of the largest misfit from which a further mode is begun."""

LOW_COHERENCE = 0.05
"""Coherence below which a line is taken at this one: what is lost in noise has no phase."""

SCREENED = 4
"""Candidates of a round that are fitted; the others promise less by one linear step."""

AWAY = (-0.7, -0.35, 0.35, 0.7)
"""Logarithms of a value over the one so far from which it is looked at: half to twice, where the first resonance moves
by half of itself."""


@dataclass(frozen=True)
class ResponseFit:
    """A fitted set.

    Attributes:
        beyond: places in `values` that are beyond their tolerances.
        lines: additions.
        coordinates: (k,).
        covariance: of them, (k, k).
        residual: (2 n,).
        variance: v of every row, (2 n,).
        correlation: τ.
        log_likelihood: of the rows as if independent.
        jacobian: of the residual, (2 n, k).
        spreads: p, (k,).
    """

    beyond: tuple[int, ...]
    lines: Lines
    coordinates: FloatArray
    covariance: FloatArray
    residual: FloatArray
    variance: FloatArray
    correlation: float
    log_likelihood: float
    jacobian: FloatArray
    spreads: FloatArray

    @property
    def size(self) -> int:
        """Values beyond their tolerances, and additions."""
        return len(self.beyond) + int(self.lines.delay) + len(self.lines.modes)

    def evidence(self, correlation: float) -> float:
        """Log evidence with a given τ."""
        scaled = self.jacobian / np.sqrt(self.variance)[:, None] * self.spreads / math.sqrt(correlation)
        _, volume = np.linalg.slogdet(np.eye(len(self.spreads)) + scaled.T @ scaled)
        prior = float(np.sum((self.coordinates / self.spreads) ** 2))
        return self.log_likelihood / correlation - 0.5 * (prior + float(volume))


@dataclass(frozen=True)
class Step:
    """A candidate of a round: what it is, and by how much it changes the log evidence, its prior included."""

    name: str
    gain: float
    taken: bool


@dataclass(frozen=True)
class ResponseSearch:
    """What a search found.

    Attributes:
        problem: with the values that the response depends on.
        declared: nothing fitted at all.
        calibrated: values within their tolerances alone.
        found: the set that was found.
        gains: log evidence that each of its members brings, in the order of `beyond`, delay, modes.
        rivals: for each member the candidates that would have done about as well in its round.
        steps: everything that was tried.
    """

    problem: ResponseProblem
    declared: FloatArray
    calibrated: ResponseFit
    found: ResponseFit
    gains: tuple[float, ...]
    rivals: dict[str, tuple[str, ...]]
    steps: tuple[Step, ...]


def search_response(problem: ResponseProblem, progress: Callable[[str], None] = lambda text: None) -> ResponseSearch:
    """Find what the declared plant lacks for a measured frequency response.

    Raises:
        InputError: a plant that cannot be linearised at the operating point.
    """
    progress("fitting declared values within their tolerances")
    zero = np.zeros(len(problem.values))
    declared = problem.residual(zero, Lines())
    problem = _of_seen_values(problem, declared)
    base = found = _fitted(problem, (), Lines(), np.zeros(len(problem.values)))
    seen = range(len(problem.values))
    steps: list[Step] = []
    rivals: dict[str, tuple[str, ...]] = {}
    count = len(seen) + 2
    while found.size < MOST:
        progress(f"{found.size} found so far")
        tried = [(name, one) for name, one in _candidates(problem, found, seen)]
        gains = [_gain(found, one, count) for _, one in tried]
        if not gains:
            break
        best = int(np.argmax(gains))
        steps += [
            Step(name, gain, i == best and gain > 0)
            for i, ((name, _), gain) in enumerate(zip(tried, gains, strict=True))
        ]
        if gains[best] <= 0:
            break
        near = [name for (name, _), gain in zip(tried, gains, strict=True) if gains[best] - gain < math.log(20)]
        rivals[tried[best][0]] = tuple(name for name in near if name != tried[best][0])
        found = tried[best][1]
    found, gains_of = _needed(problem, found, count)
    return ResponseSearch(problem, declared, base, found, gains_of, rivals, tuple(steps))


def _of_seen_values(problem: ResponseProblem, declared: FloatArray) -> ResponseProblem:
    """The problem without values that the response does not depend on.

    Kept are those that move it, within tolerance, by a tenth of what all its lines together can tell; of values that
    are exact, which can only be beyond it, those that do so there.
    """
    zero = np.zeros(len(problem.values))
    slopes = _slopes(problem, zero, Lines(), declared)
    deviations = np.array([BEYOND if one.exact else one.deviation for one in problem.values])
    size_over_noise = np.sqrt(np.sum((slopes * deviations) ** 2 / _variance(problem, declared)[:, None], axis=0))
    kept = tuple(one for one, size in zip(problem.values, size_over_noise, strict=True) if size > 0.1)
    return replace(problem, values=kept)


def _candidates(problem: ResponseProblem, found: ResponseFit, seen: Sequence[int]) -> list[tuple[str, ResponseFit]]:
    """What may be added to a set, fitted."""
    promised: list[tuple[float, str, tuple[int, ...], Lines, FloatArray]] = []
    for place in seen:
        if place not in found.beyond and not problem.values[place].missing:
            gain = _linear_promise(found, place)
            promised.append((gain, problem.values[place].key, (*found.beyond, place), found.lines, found.coordinates))
    promised = sorted(promised, key=lambda one: -one[0])[:SCREENED]
    promised = [(*one[:4], _nearest_start(problem, one[4], one[2][-1], found.lines)) for one in promised]
    own = len(problem.values)
    if not found.lines.delay and problem.response.given != "cutting_force":
        start = np.insert(found.coordinates, own, 0.1)
        promised.append((0.0, "drive_delay", found.beyond, replace(found.lines, delay=True), start))
    for frequency in _mode_starts(problem, found):
        lines = replace(found.lines, modes=(*found.lines.modes, frequency))
        start = np.concatenate([found.coordinates, [-1.0, 0.0, 0.0]])
        promised.append((0.0, f"structural_mode at {frequency:.0f} Hz", found.beyond, lines, start))
    fitted = []
    for _, name, beyond, lines, start in promised:
        try:
            fitted.append((name, _fitted(problem, beyond, lines, start)))
        except (InputError, np.linalg.LinAlgError):  # no such machine
            continue
    return fitted


def _nearest_start(problem: ResponseProblem, at: FloatArray, place: int, lines: Lines) -> FloatArray:
    """Coordinates with the likeliest of some values at one place: a resonance far from its lines pulls nowhere."""
    starts = []
    for step in (0.0, *AWAY):
        moved = at.copy()
        moved[place] += step
        try:
            residual = problem.residual(moved, lines)
        except InputError:  # no such machine
            continue
        variance = _variance(problem, residual)
        starts.append((float(np.sum(residual**2 / variance + np.log(variance))), moved))
    return min(starts, key=lambda one: one[0])[1]


def _linear_promise(found: ResponseFit, place: int) -> float:
    """Fall of the weighted squared error and prior by one linear step with a value beyond its tolerance."""
    spreads = found.spreads.copy()
    spreads[place] = BEYOND
    weight = 1 / (found.variance * found.correlation)
    normal = found.jacobian.T @ (weight[:, None] * found.jacobian) + np.diag(1 / spreads**2)
    slope = found.jacobian.T @ (weight * found.residual) + found.coordinates / spreads**2
    freed = float(found.coordinates[place] / found.spreads[place])
    return 0.5 * freed**2 + 0.5 * float(slope @ np.linalg.solve(normal, slope))


def _mode_starts(problem: ResponseProblem, found: ResponseFit) -> list[float]:
    """Frequencies of the largest weighted misfit, at least a tenth apart [Hz]."""
    n = len(problem.response.frequency)
    weighted = found.residual**2 / found.variance
    misfit = weighted[:n] + weighted[n:]
    starts: list[float] = []
    for place in np.argsort(-misfit):
        frequency = float(problem.response.frequency[place])
        if all(abs(math.log(frequency / other)) > 0.1 for other in (*starts, *found.lines.modes)):
            starts.append(frequency)
        if len(starts) == STARTS:
            break
    return starts


def _gain(before: ResponseFit, after: ResponseFit, count: int) -> float:
    """Change of the log evidence with its prior, both with the τ of the one that leaves less."""
    less = min((before, after), key=lambda one: -one.log_likelihood)
    change = after.evidence(less.correlation) - before.evidence(less.correlation)
    return change + log_prior_of_size(after.size, count) - log_prior_of_size(before.size, count)


def _needed(problem: ResponseProblem, found: ResponseFit, count: int) -> tuple[ResponseFit, tuple[float, ...]]:
    """The set without members that do not raise the evidence, and what each of the others brings."""
    while True:
        gains = [_gain(_without(problem, found, member), found, count) for member in range(found.size)]
        if not gains or min(gains) > 0:
            return found, tuple(gains)
        found = _without(problem, found, int(np.argmin(gains)))


def _without(problem: ResponseProblem, found: ResponseFit, member: int) -> ResponseFit:
    own, beyond = len(problem.values), found.beyond
    if member < len(beyond):
        return _fitted(problem, (*beyond[:member], *beyond[member + 1 :]), found.lines, found.coordinates)
    member -= len(beyond)
    if found.lines.delay and member == 0:
        return _fitted(problem, beyond, replace(found.lines, delay=False), np.delete(found.coordinates, own))
    mode = member - int(found.lines.delay)
    first = own + int(found.lines.delay) + 3 * mode
    modes = (*found.lines.modes[:mode], *found.lines.modes[mode + 1 :])
    return _fitted(
        problem, beyond, replace(found.lines, modes=modes), np.delete(found.coordinates, slice(first, first + 3))
    )


def _fitted(problem: ResponseProblem, beyond: tuple[int, ...], lines: Lines, start: FloatArray) -> ResponseFit:
    """The most likely coordinates of a set, variances and coordinates in turn."""
    spreads = problem.spreads(beyond, lines, BEYOND)
    coordinates = np.asarray(start, dtype=float)
    variance = _variance(problem, problem.residual(coordinates, lines))
    for _ in range(3):
        weight = 1 / np.sqrt(variance)

        def missed(at: FloatArray, weight: FloatArray = weight) -> FloatArray:
            try:
                rows = problem.residual(at, lines) * weight
            except InputError:  # no such machine: far away
                rows = np.full(2 * len(problem.response.frequency), 1e6)
            return np.concatenate([np.nan_to_num(rows, nan=1e6, posinf=1e6, neginf=-1e6), at / spreads])

        solved = least_squares(missed, coordinates, x_scale=spreads, diff_step=1e-5, xtol=1e-4, ftol=1e-4, max_nfev=8)
        moved = np.max(np.abs(solved.x - coordinates) / spreads)
        coordinates = solved.x
        variance = _variance(problem, problem.residual(coordinates, lines))
        if moved < 0.1:
            break
    residual = problem.residual(coordinates, lines)
    jacobian = _slopes(problem, coordinates, lines, residual)
    correlation = _correlation(residual / np.sqrt(variance))
    information = jacobian.T @ (jacobian / variance[:, None]) / correlation + np.diag(1 / spreads**2)
    likelihood = -0.5 * float(np.sum(residual**2 / variance + np.log(2 * math.pi * variance)))
    covariance: FloatArray = np.asarray(np.linalg.inv(information), dtype=np.float64)
    return ResponseFit(
        beyond, lines, coordinates, covariance, residual, variance, correlation, likelihood, jacobian, spreads
    )


def _slopes(problem: ResponseProblem, at: FloatArray, lines: Lines, base: FloatArray) -> FloatArray:
    columns = []
    for place in range(len(at)):
        moved = at.copy()
        moved[place] += 1e-4
        columns.append((problem.residual(moved, lines) - base) / 1e-4)
    return np.column_stack(columns)


def _variance(problem: ResponseProblem, residual: FloatArray) -> FloatArray:
    """v of every row: averages and discrepancy at which the residual is most likely, (2 n,)."""
    coherence = np.clip(problem.response.coherence, LOW_COHERENCE, 1.0)
    scatter = np.where(np.isnan(coherence), 0.0, (1 - coherence) / (2 * coherence))
    square = residual[: len(scatter)] ** 2 + residual[len(scatter) :] ** 2
    square = np.where(np.isfinite(square), square, 1e12)

    def cost(logs: FloatArray) -> float:
        v = np.exp(2 * logs[0]) * scatter + np.exp(2 * logs[1])
        return float(np.sum(0.5 * square / v + np.log(v)))

    level = 0.5 * math.log(max(float(np.median(square)) / 2, 1e-16))
    starts = [np.array([0.0, level]), np.array([-1.0, level - 1.0]), np.array([-2.0, level + 1.0])]
    bounds = [(-6.0, 1.0), (-14.0, 3.0)]
    best = min((minimize(cost, one, bounds=bounds, method="L-BFGS-B") for one in starts), key=lambda one: one.fun)
    found = np.exp(2 * best.x[0]) * scatter + np.exp(2 * best.x[1])
    return np.concatenate([found, found])


def _correlation(whitened: FloatArray) -> float:
    """τ: one, and twice the correlations up to the first that is not above their own scatter."""
    n = len(whitened) // 2
    total = 1.0
    power = float(whitened @ whitened)
    for lag in range(1, n // 4):
        rho = sum(float(part[lag:] @ part[:-lag]) for part in (whitened[:n], whitened[n:])) / power
        if rho < 2 / math.sqrt(2 * n):
            break
        total += 2 * rho
    return total
