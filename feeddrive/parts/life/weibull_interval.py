"""How far a Weibull fit can be trusted: intervals by the likelihood ratio, and exact ones for tests run to the end.

    2 (l_max - l(theta)) <= chi^2_1(level),    l(theta) the likelihood with theta held and the other parameter free

The likelihood-ratio interval holds for any censoring; one of 90 % covers about 86 % with ten failures and 84 % with
five of ten. Where every specimen failed, e_hat / e follows a law that depends on the count alone (Thoman, Bain, Antle,
Technometrics 11 (1969) 445); drawing samples of that count gives an interval that covers what it says.

Source of the fit: `feeddrive.parts.life.weibull`.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from scipy.optimize import brentq, minimize_scalar
from scipy.stats import chi2

from feeddrive.errors import InputError
from feeddrive.parts.life.weibull import RATED_FAILURE, LifeSample, WeibullLaw, likelihood_fit, log_likelihood
from feeddrive.typing import FloatArray

_VALUES = 1_000_000
_SEED = 1969
_STEPS = 60
_STRETCH = 1.6


@dataclass(frozen=True)
class Interval:
    """A confidence interval in the unit of the estimate; an end more than a factor of 1000 away is 0 or infinite."""

    low: float
    estimate: float
    high: float
    level: float


def slope_interval(sample: LifeSample, level: float = 0.9) -> Interval:
    """Interval of the slope by the likelihood ratio, two-sided, of confidence `level`.

    Raises:
        InputError: as `likelihood_fit`, or a level outside 0 to 1.
    """
    best = likelihood_fit(sample)
    # The life by which as many fail as failed in the test hardly depends on the slope; the scale may, by powers of ten.
    share = sample.failures / (sample.size + 1.0)

    def law(slope: float, life: float) -> WeibullLaw:
        return WeibullLaw.through(life, share, slope)

    return _interval(sample, best, law, best.slope, best.life(share), level)


def life_interval(sample: LifeSample, failed: float = RATED_FAILURE, level: float = 0.9) -> Interval:
    """Interval of the life by which the share `failed` has failed, by the likelihood ratio; L10 by default.

    Raises:
        InputError: as `slope_interval`.
    """
    best = likelihood_fit(sample)

    def law(life: float, slope: float) -> WeibullLaw:
        return WeibullLaw.through(life, failed, slope)

    return _interval(sample, best, law, best.life(failed), best.slope, level)


def complete_slope_interval(slope: float, count: int, level: float = 0.9) -> Interval:
    """Interval of the slope where all `count` specimens failed, from the slope of maximum likelihood.

    By drawing a million lives; its ends are right to about 0.5 %.

    Raises:
        InputError: a slope that is not positive, fewer than 3 or more than 10 000 specimens, or a level outside 0 to 1.
    """
    _check_level(level)
    if not (math.isfinite(slope) and slope > 0.0):
        raise InputError(f"a slope of {slope:g}", "Weibull interval", "write a slope above 0")
    ratio = _slopes_of_unit_samples(count)
    low, high = np.quantile(ratio, (0.5 - 0.5 * level, 0.5 + 0.5 * level))
    return Interval(slope / float(high), slope, slope / float(low), level)


def _interval(
    sample: LifeSample, best: WeibullLaw, law: Callable[[float, float], WeibullLaw],
    held: float, free: float, level: float,
) -> Interval:  # fmt: skip
    """Ends at which the profile of the held parameter has fallen by half the chi-square value."""
    _check_level(level)
    top = log_likelihood(best, sample)
    fall = 0.5 * float(chi2.ppf(level, 1))

    def excess(logarithm: float) -> float:
        return top - _profile(sample, law, math.exp(logarithm), free) - fall

    low, high = (_crossing(excess, math.log(held), sign) for sign in (-1.0, 1.0))
    return Interval(math.exp(low), held, math.exp(high), level)


def _profile(sample: LifeSample, law: Callable[[float, float], WeibullLaw], held: float, free: float) -> float:
    """Largest log-likelihood over the free parameter, searched within e^4 of its best value."""

    def loss(logarithm: float) -> float:
        value = -log_likelihood(law(held, math.exp(logarithm)), sample)
        return value if math.isfinite(value) else 1e12

    centre = math.log(free)
    found = minimize_scalar(loss, bounds=(centre - 4.0, centre + 4.0), method="bounded", options={"xatol": 1e-7})
    return -float(found.fun)


def _crossing(excess: Callable[[float], float], start: float, sign: float) -> float:
    """Where the excess changes sign on one side of the start; infinite where it does not within a factor of e^7."""
    inner, step = start, 0.05
    while abs(inner - start) < 7.0:
        outer = inner + sign * step
        if excess(outer) > 0.0:
            return float(brentq(excess, inner, outer, xtol=1e-7))
        inner, step = outer, step * _STRETCH
    return sign * math.inf


@lru_cache(maxsize=16)
def _slopes_of_unit_samples(count: int) -> FloatArray:
    """Slopes of maximum likelihood of samples of the law of scale and slope 1, (draws,).

    The equation sum(x^e ln x)/sum(x^e) - 1/e - mean(ln x) = 0 by Newton's method in ln e, all samples at once.
    """
    if not 3 <= count <= 10_000:
        raise InputError(f"{count} specimens", "Weibull interval", "3 to 10 000 are possible")
    logs = np.log(np.random.default_rng(_SEED).exponential(size=(_VALUES // count, count)))
    slope = np.ones((_VALUES // count, 1))
    for _ in range(_STEPS):
        weights = np.exp(slope * (logs - logs.max(axis=1, keepdims=True)))
        weights /= weights.sum(axis=1, keepdims=True)
        mean = (weights * logs).sum(axis=1, keepdims=True)
        spread = (weights * logs**2).sum(axis=1, keepdims=True) - mean**2
        value = mean - 1.0 / slope - logs.mean(axis=1, keepdims=True)
        change = value / (slope * spread + 1.0 / slope)
        slope = slope * np.exp(-change.clip(-1.0, 1.0))
        if float(np.abs(change).max()) < 1e-10:
            break
    return np.asarray(slope[:, 0], dtype=float)


def _check_level(level: float) -> None:
    if not 0.0 < level < 1.0:
        raise InputError(f"a level of {level:g}", "confidence", "write a level between 0 and 1, such as 0.9")
