"""The size at which an effect is worth a given share of the error."""

from __future__ import annotations

import math
from collections.abc import Callable

from scipy.optimize import brentq

from tests.generator.effects import Effect

SHARES = (0.02, 0.10, 0.50)
"""Shares of the error at which an effect is hardly seen, seen, and the largest part."""


def sized(
    effect: Effect,
    share: float,
    error_ratio: Callable[[Effect], float],
    tolerance: float = 0.05,
    span: tuple[float, float] = (1e-4, 1e4),
) -> Effect:
    """Return `effect` made so large that leaving it out of the model costs `share` of the error.

    `error_ratio(effect)` is the validation error (rms, of the channel it touches most, in the band) of the true plant
    over that of the declared plant, on recordings with the effect: 1 where it does not show, towards 0 where it is
    large. Wanted is error_ratio = 1 - share. The noise and what the effect brings add in squares, and the latter is
    near to proportional to the size: so that 1 / ratio^2 - 1 is near to a straight line of slope 2 in logarithms,
    on which bracketing and bisection (Brent's) work.

    Args:
        effect: its parameters, of which those in `size_keys` are scaled; near the wanted size saves time.
        share: between 0 and 1.
        error_ratio: as above; the same seeds every time, so that it does not jump.
        tolerance: of the size, relative.
        span: least and largest factor on the size.

    Raises:
        ValueError: no size within the span, or none that the effect can have, reaches the share.
    """
    wanted = math.log(1.0 / (1.0 - share) ** 2 - 1.0)
    known: dict[float, float] = {}

    def excess(logarithm: float) -> float:
        if logarithm not in known:
            # Clipped, as noise can bring the ratio above 1, and a noiseless recording to 0.
            ratio = max(error_ratio(effect.scaled(math.exp(logarithm))), 1e-6)
            known[logarithm] = math.log(max(1.0 / ratio**2 - 1.0, 1e-9)) - wanted
        return known[logarithm]

    low, high = _bracket(effect, excess, (math.log(span[0]), math.log(span[1])))
    return effect.scaled(math.exp(brentq(excess, low, high, xtol=tolerance)))


def _bracket(effect: Effect, excess: Callable[[float], float], span: tuple[float, float]) -> tuple[float, float]:
    """Return logarithms of the size between which `excess` changes sign; ValueError where there are none."""
    here = 0.0
    above = excess(here) > 0.0
    while True:
        # Half of what is missing, as the slope is 2, and a fifth beyond; where nothing shows, no more than eightfold.
        step = min(max(0.6 * abs(excess(here)), 0.1), math.log(8.0))
        there = here - step if above else _possible(effect, here, here + step)
        if not span[0] <= there <= span[1] or there == here:
            raise ValueError(f"{effect.name}: no size it can have reaches this share of the error")
        if (excess(there) > 0.0) != above:
            return min(here, there), max(here, there)
        here = there


def _possible(effect: Effect, here: float, there: float) -> float:
    """Return `there`, or what of the way to it the effect allows (`here` if next to nothing)."""
    while there - here > 0.02:
        try:
            effect.scaled(math.exp(there))
        except ValueError:
            there = here + 0.5 * (there - here)
        else:
            return there
    return here
