"""Which declared values explain measured numbers, by the evidence of every set of values beyond their tolerances.

    y_j = f_j(θ) + e_j,   e_j ~ N(0, s_j²),   θ_i ~ N(0, t_i²) within tolerance, N(0, w²) beyond it

    log p(y|S) = -½ Σ ((y_j - f_j(θ^))/s_j)² - ½ Σ θ^_i²/p_i² - Σ log(s_j √2π) - ½ log det(1 + P^½ J' Σ^-1 J P^½)

| symbol | meaning | unit |
|---|---|---|
| y_j, s_j | measured number, its standard deviation | SI |
| f_j | what the plant gives | SI |
| θ_i | log of a value over the declared one; of a missing part its share of the compliance | 1 |
| t_i | half the tolerance of value i, `declared_values` | 1 |
| w | ln(4) / 1.96: a value beyond its tolerance is within a factor of four, either way | 1 |
| S | the values that are beyond their tolerances | |
| p_i | w for i in S, t_i otherwise; P = diag(p_i²) | 1 |
| θ^, J | most likely θ, slope of f there | 1 |

Every declared value is fitted under its tolerance in every set: that is calibration, and no finding. A set costs its
share of the prior: one deviation is expected at even odds, whichever of the K values that the numbers see it is,

    p(S) = B(1 + |S|, 2K - |S|) / B(1, K)

Laplace's approximation; numbers and values are few, θ is nearly linear in logarithms, and the sets that matter are
linearised again at their own θ^. Sources: MacKay, Neural Computation 4 (1992) 415 (evidence); Scott and Berger, Ann.
Statist. 38 (2010) 2587 (price of many candidates).
"""

from __future__ import annotations

import itertools
import math
import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from scipy.optimize import minimize_scalar
from scipy.special import chdtri

from feeddrive.diagnosis.likelihood.set_evidence import log_prior_of_size
from feeddrive.diagnosis.likelihood.tolerances import BEYOND, WIDEST
from feeddrive.diagnosis.numbers.declared_values import DeclaredPlant, DeclaredValue, values_of
from feeddrive.diagnosis.numbers.measured_file import MeasuredNumber
from feeddrive.errors import InputError, ValidityWarning
from feeddrive.plant.plant import Plant
from feeddrive.typing import FloatArray

MOST = 2
"""Values beyond their tolerances at once: a third one would need more numbers than anyone measures."""

RELINEARISED = 8
"""Sets that are linearised at their own best values; the others keep the slopes of the declared plant."""

UNSEEN = 0.01
"""Standard deviations by which a value within its tolerance moves the numbers, below which they do not see it: even a
value beyond it, some ten times as far, is lost in their noise."""

STEP = 1e-3
"""Step of the differences, in coordinates whose tolerances are some hundredths."""


@dataclass(frozen=True, eq=False)
class NumbersProblem(DeclaredPlant):
    """A plant file and the numbers measured on the machine.

    Attributes:
        measured: the numbers.
        seen: places in `values` of those that a measured number depends on.
    """

    measured: tuple[MeasuredNumber, ...]
    seen: tuple[int, ...] = ()

    def predicted(self, coordinates: FloatArray, numbers: Sequence[MeasuredNumber] | None = None) -> FloatArray:
        """What the plant gives for the numbers, (n,) SI."""
        with warnings.catch_warnings():
            # values that no part has are tried on the way; what is kept is checked when the plant is read with it
            warnings.simplefilter("ignore", ValidityWarning)
            plant = self.plant_with(coordinates)
            return np.array([one.kind.of(plant, one.setting) for one in numbers or self.measured])

    def slopes(
        self, at: FloatArray, numbers: Sequence[MeasuredNumber] | None = None, places: Sequence[int] | None = None
    ) -> FloatArray:
        """Slope of the numbers with the coordinates, (n, k); forward, as a missing part cannot be less than none.

        Args:
            at: coordinates, (k,).
            numbers: those measured if left out.
            places: of the coordinates that matter; the slope with the others is taken as zero.
        """
        base = self.predicted(at, numbers)
        slopes = np.zeros((len(base), len(at)))
        for place in range(len(at)) if places is None else places:
            moved = at.copy()
            moved[place] += STEP
            slopes[:, place] = (self.predicted(moved, numbers) - base) / STEP
        return slopes


def numbers_problem(
    entries: Mapping[str, Any], path: Path, plant: Plant, measured: Sequence[MeasuredNumber]
) -> NumbersProblem:
    """The problem of a plant file and its measured numbers.

    Raises:
        InputError: nothing in the file may be other than declared.
    """
    values = values_of(entries, path, plant, plant.middle)
    problem = NumbersProblem(entries, path, plant, values, tuple(measured))
    moved = np.abs(problem.slopes(np.zeros(len(values)))) * np.array([one.deviation for one in values])
    noise = np.array([one.deviation for one in measured])
    seen = np.flatnonzero(np.max(moved / noise[:, None], axis=0) > UNSEEN)
    return replace(problem, seen=tuple(int(place) for place in seen))


@dataclass(frozen=True)
class Explanation:
    """A set of values beyond their tolerances, all others within theirs.

    Attributes:
        beyond: places in `values`; empty where everything is within tolerance.
        coordinates: most likely, (k,).
        covariance: of the coordinates, (k, k).
        predicted: numbers at them, (n,) SI.
        log_evidence: log p(y|S).
        probability: of the set, over all that were compared.
    """

    beyond: tuple[int, ...]
    coordinates: FloatArray
    covariance: FloatArray
    predicted: FloatArray
    log_evidence: float
    probability: float = 0.0


@dataclass(frozen=True)
class SingleCause:
    """One value alone made to meet the numbers, all others exactly as declared.

    Attributes:
        value: which.
        coordinate: at which the numbers are met best.
        predicted: there, (n,) SI.
        misfit: Σ ((y - f)/s)², [1].
        meets: whether that is no more than chance would leave (95 % of chi² with n degrees of freedom).
    """

    value: DeclaredValue
    coordinate: float
    predicted: FloatArray
    misfit: float
    meets: bool


def explanations(
    problem: NumbersProblem, progress: Callable[[str], None] = lambda text: None
) -> tuple[Explanation, ...]:
    """Every set of at most `MOST` values beyond their tolerances, the most probable first; probabilities add to one."""
    progress("slopes of the numbers with the declared values")
    zero = np.zeros(len(problem.values))
    base, slopes = problem.predicted(zero), problem.slopes(zero)
    sets = [chosen for size in range(MOST + 1) for chosen in itertools.combinations(problem.seen, size)]
    found = [_explained(problem, chosen, zero, base, slopes) for chosen in sets]
    found.sort(key=lambda one: -(one.log_evidence + log_prior_of_size(len(one.beyond), len(problem.seen))))
    progress("the likeliest sets at their own values")
    ends = [_settled(problem, one) for one in found[:RELINEARISED]] + found[RELINEARISED:]
    logs = np.array([one.log_evidence + log_prior_of_size(len(one.beyond), len(problem.seen)) for one in ends])
    shares = np.exp(logs - np.max(logs))
    shares = shares / np.sum(shares)
    ranked = sorted(zip(shares, ends, strict=True), key=lambda pair: -pair[0])
    return tuple(replace(one, probability=float(share)) for share, one in ranked)


def inclusion(problem: NumbersProblem, found: Sequence[Explanation]) -> FloatArray:
    """Probability of each value to be beyond its tolerance, (k,)."""
    total = np.zeros(len(problem.values))
    for one in found:
        total[list(one.beyond)] += one.probability
    return total


def single_causes(problem: NumbersProblem) -> tuple[SingleCause, ...]:
    """Each value alone made to meet the numbers, the best first; those that move no number are left out."""
    found = []
    zero = np.zeros(len(problem.values))
    before = _misfit(problem, problem.predicted(zero))
    for place in problem.seen:
        value = problem.values[place]

        def missed(coordinate: float, place: int = place) -> float:
            at = zero.copy()
            at[place] = coordinate
            try:
                return _misfit(problem, problem.predicted(at))
            except InputError:  # no such machine: a nut off its screw
                return 1e6 * before

        low = 0.0 if value.missing else -WIDEST
        solved = minimize_scalar(missed, bounds=(low, WIDEST), method="bounded", options={"xatol": 1e-6})
        misfit = float(solved.fun)
        if misfit < before * (1 - 1e-3):
            at = zero.copy()
            at[place] = float(solved.x)
            meets = misfit <= float(chdtri(len(problem.measured), 0.05))
            found.append(SingleCause(value, float(solved.x), problem.predicted(at), misfit, meets))
    return tuple(sorted(found, key=lambda one: one.misfit))


def _explained(
    problem: NumbersProblem, chosen: tuple[int, ...], at: FloatArray, base: FloatArray, slopes: FloatArray
) -> Explanation:
    """The set's best values and evidence, linear about `at`."""
    variance = np.array([one.deviation**2 for one in problem.values])
    variance[list(chosen)] = BEYOND**2
    measured, noise = _measured(problem)
    spread = slopes * variance @ slopes.T + np.diag(noise**2)
    gain = (variance[:, None] * slopes.T) @ np.linalg.inv(spread)
    coordinates = gain @ (measured - base + slopes @ at)
    for place, value in enumerate(problem.values):
        if value.missing:
            coordinates[place] = max(coordinates[place], 0.0)
    covariance = np.diag(variance) - gain @ (slopes * variance)
    predicted = base + slopes @ (coordinates - at)
    return Explanation(
        chosen, coordinates, covariance, predicted, _evidence(problem, variance, coordinates, predicted, slopes)
    )


def _settled(problem: NumbersProblem, one: Explanation) -> Explanation:
    """The set linearised at its own best values until they stay."""
    for _ in range(6):
        at = one.coordinates
        try:
            base, slopes = problem.predicted(at), problem.slopes(at, places=problem.seen)
        except InputError:  # no such machine at these values
            return replace(one, log_evidence=-math.inf)
        one = _explained(problem, one.beyond, at, base, slopes)
        # a tenth of a standard deviation moves the evidence by a two-hundredth
        if np.all(np.abs(one.coordinates - at) <= 0.1 * np.sqrt(np.diag(one.covariance))):
            break
    predicted = problem.predicted(one.coordinates)
    variance = np.array([value.deviation**2 for value in problem.values])
    variance[list(one.beyond)] = BEYOND**2
    evidence = _evidence(problem, variance, one.coordinates, predicted, slopes)
    return replace(one, predicted=predicted, log_evidence=evidence)


def _evidence(
    problem: NumbersProblem, variance: FloatArray, coordinates: FloatArray, predicted: FloatArray, slopes: FloatArray
) -> float:
    _, noise = _measured(problem)
    scaled = slopes / noise[:, None] * np.sqrt(variance)
    _, volume = np.linalg.slogdet(np.eye(len(noise)) + scaled @ scaled.T)
    prior = float(np.sum(coordinates**2 / variance))
    width = float(np.sum(np.log(noise * math.sqrt(2 * math.pi))))
    return -0.5 * (_misfit(problem, predicted) + prior + float(volume)) - width


def _misfit(problem: NumbersProblem, predicted: FloatArray) -> float:
    measured, noise = _measured(problem)
    return float(np.sum(((measured - predicted) / noise) ** 2))


def _measured(problem: NumbersProblem) -> tuple[FloatArray, FloatArray]:
    return (
        np.array([one.value for one in problem.measured]),
        np.array([one.deviation for one in problem.measured]),
    )
