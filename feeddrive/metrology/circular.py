"""Circular deviation of one axis after ISO 230-4, and its quadrant glitches.

One axis makes no circle. The other one is taken as ideal with the same gain and lag as this one has in its fundamental:

    x = c + a sin(p) + b cos(p) + rest,   y = a cos(p) - b sin(p),   radius = sqrt((x - c)^2 + y^2)

| symbol | meaning | unit |
|---|---|---|
| p | angle of the set-point along the circle | rad |
| a, b, c | fundamental and centre, by least squares | m |

The circular deviation is the difference of the largest and the smallest radius about the least-squares centre.
Source: ISO 230-4:2022, definitions of circular and radial deviation; the ideal second axis is a choice of this program.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from feeddrive.errors import InputError
from feeddrive.typing import FloatArray

GLITCH_SPAN = math.radians(30.0)
"""Of the angle after a reversal in which its glitch is looked for."""


@dataclass(frozen=True)
class Circular:
    """Figures of a circular test of one axis.

    Attributes:
        angle: of the set-point, within whole turns [rad], shape (n,).
        radial: radius minus nominal radius [m], shape (n,).
        deviation: G, largest minus smallest radius [m].
        radial_maximum, radial_minimum: F max and F min [m].
        gain: of the fundamental, 1 for an exact radius.
        lag: of the fundamental [rad].
        glitch: largest deviation from the fundamental after a reversal at + and at - [m], along the radius:
            positive outwards.
    """

    angle: FloatArray
    radial: FloatArray
    deviation: float
    radial_maximum: float
    radial_minimum: float
    gain: float
    lag: float
    glitch: tuple[float, float]


def circular(angle: FloatArray, position: FloatArray, radius: float) -> Circular:
    """The figures from samples over whole turns.

    Args:
        angle: of the set-point x_set = centre + radius sin(angle) [rad], rising, shape (n,).
        position: of the table [m], shape (n,).
        radius: nominal [m].

    Raises:
        InputError: less than one turn.
    """
    if len(angle) < 8 or angle[-1] - angle[0] < 2 * math.pi * (1 - 1e-3):
        raise InputError("less than one turn at constant feed", "circular test", "make more turns")
    sine, cosine = np.sin(angle), np.cos(angle)
    basis = np.column_stack([np.ones_like(angle), sine, cosine])
    (centre, a, b), *_ = np.linalg.lstsq(basis, position, rcond=None)
    rest = position - centre - a * sine - b * cosine
    # second axis: the same gain and lag, a quarter of a turn ahead
    second = a * cosine - b * sine
    radial = np.hypot(position - centre, second) - radius
    reversals = [_glitch(angle, rest, math.atan2(b, a), side) for side in (1.0, -1.0)]
    return Circular(
        angle, radial, float(np.ptp(radial)), float(radial.max()), float(radial.min()),
        float(math.hypot(a, b) / radius), float(-math.atan2(b, a)), (reversals[0], reversals[1]),
    )  # fmt: skip


def _glitch(angle: FloatArray, rest: FloatArray, lead: float, side: float) -> float:
    """Deviation of largest magnitude after the reversal at + (side 1) or - (-1), positive outwards."""
    after = np.mod(angle + lead - side * math.pi / 2, 2 * math.pi)
    within = side * rest[after < GLITCH_SPAN]
    return float(within[np.argmax(np.abs(within))]) if len(within) else 0.0
