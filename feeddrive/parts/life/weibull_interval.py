"""How far the slope of a Weibull fit can be trusted where every specimen failed.

e_hat / e then follows a law that depends on the count alone (Thoman, Bain, Antle, Technometrics 11 (1969) 445); drawing
samples of that count gives an interval that covers what it says. Source of the fit: `feeddrive.parts.life.weibull`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from feeddrive.errors import InputError
from feeddrive.typing import FloatArray

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
