"""Weibull law of lives and its fit to tests in which some specimens have not failed.

    S(L) = exp(-(L / A)^e),      ln ln(1 / (1 - F)) = e ln L - e ln A,      F = 1 - S

| symbol | meaning | unit |
|---|---|---|
| L | life, in whatever unit the sample counts it (revolutions, 10^6 revolutions, hours) | life |
| A | scale: life that 36.8 % survive | life |
| e | slope of the line in Weibull paper | 1 |
| F, S | probability of having failed, of having survived | 1 |

Source: paper 001, eq. (1) of section 2.2 (F there as a fraction, not per cent). Two parameters, no failure-free life.

How far the slope of a Weibull fit can be trusted where every specimen failed.

e_hat / e then follows a law that depends on the count alone (Thoman, Bain, Antle, Technometrics 11 (1969) 445); drawing
samples of that count gives an interval that covers what it says. Source of the fit: `feeddrive.parts.life.weibull`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from feeddrive.errors import InputError
from feeddrive.parts.elementary import power
from feeddrive.typing import FloatArray

RATED_FAILURE = 0.1
"""Share of specimens that have failed at the rated life L10."""


@dataclass(frozen=True)
class WeibullLaw:
    """A Weibull law: scale [life] and slope [1], both above zero.

    Raises:
        InputError: scale or slope not finite and positive.
    """

    scale: float
    slope: float

    def __post_init__(self) -> None:
        for key, value in (("scale", self.scale), ("slope", self.slope)):
            if not (math.isfinite(value) and value > 0.0):
                raise InputError(f"{value} is not possible", f"Weibull {key}", "write a value above 0")

    def survival(self, life: float) -> float:
        """Probability of surviving `life`; refuses a negative one."""
        return math.exp(-self._hazard(life))

    def failure(self, life: float) -> float:
        """Probability of having failed by `life`, exact also where it is tiny; refuses a negative one."""
        return -math.expm1(-self._hazard(life))

    def life(self, failed: float = RATED_FAILURE) -> float:
        """Life by which the share `failed` has failed; L10 by default. Refuses a share outside 0 to 1."""
        _check_share(failed)
        return float(self.scale * (-math.log1p(-failed)) ** (1.0 / self.slope))

    @classmethod
    def through(cls, life: float, failed: float, slope: float) -> WeibullLaw:
        """The law of a known slope by which the share `failed` has failed at `life`; refuses what is not possible."""
        _check_share(failed)
        if not slope > 0.0:
            raise InputError(f"{slope} is not possible", "Weibull slope", "write a value above 0")
        return cls(life / max(power(-math.log1p(-failed), 1.0 / slope), 1e-300), slope)

    def _hazard(self, life: float) -> float:
        """(L / A)^e; infinite beyond the range of numbers."""
        if not life >= 0.0:
            raise InputError(f"a life of {life:g}", "Weibull law", "write a life of 0 or more")
        return power(life / self.scale, self.slope)


def line_fit(lives: FloatArray, failed: FloatArray) -> WeibullLaw:
    """The line through lives and shares failed, (k,), by least squares in ln ln 1/(1 - F), as the paper draws it.

    Raises InputError: all lives equal, or a line that does not rise.
    """
    ordinate, abscissa = np.log(-np.log1p(-failed)), np.log(lives)
    if np.ptp(abscissa) == 0.0:
        raise InputError("all failures at one life", "Weibull line", "a slope needs two different lives")
    slope, offset = np.polyfit(abscissa, ordinate, 1)
    return WeibullLaw(math.exp(-offset / slope) if slope > 0.0 else math.nan, float(slope))


def _check_share(failed: float) -> None:
    """Refuse a share of failures outside 0 to 1, ends excluded, or so small that no law of lives holds for it."""
    if not 1e-12 <= failed < 1.0:
        raise InputError(f"a share of failures of {failed:g}", "Weibull law", "write one between 0 and 1, such as 0.1")


_VALUES = 1_000_000
_SEED = 1969
_STEPS = 60


@dataclass(frozen=True)
class Interval:
    """A confidence interval in the unit of the estimate; an end more than a factor of 1000 away is 0 or infinite."""

    low: float
    estimate: float
    high: float
    level: float


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
