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
from feeddrive.metrology.finite import refuse_unknown
from feeddrive.typing import FloatArray

GLITCH_SPAN = math.radians(30.0)
"""Angle after a reversal in which its glitch is looked for."""

ANOTHER = 2.0
"""Factor between a measured and a nominal radius from which they are of two circles."""


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
    """The figures of samples over whole turns, x_set = centre + radius sin(angle), angle rising [rad], lengths in m.

    Raises InputError for less than one turn.
    """
    refuse_unknown("circular test", angle=angle, position=position)
    if len(angle) < 8 or angle[-1] - angle[0] < 2 * math.pi * (1 - 1e-3):
        raise InputError("less than one turn at constant feed", "circular test", "make more turns")
    sine, cosine = np.sin(angle), np.cos(angle)
    basis = np.column_stack([np.ones_like(angle), sine, cosine])
    (centre, a, b), *_ = np.linalg.lstsq(basis, position, rcond=None)
    _refuse_another_circle(float(math.hypot(a, b)), radius)
    rest = position - centre - a * sine - b * cosine
    # second axis: the same gain and lag, a quarter of a turn ahead
    second = a * cosine - b * sine
    radial = np.hypot(position - centre, second) - radius
    reversals = [_glitch(angle, rest, math.atan2(b, a), side) for side in (1.0, -1.0)]
    return Circular(
        angle,
        radial,
        float(np.ptp(radial)),
        float(radial.max()),
        float(radial.min()),
        float(math.hypot(a, b) / radius),
        float(-math.atan2(b, a)),
        (reversals[0], reversals[1]),
    )


def _refuse_another_circle(measured: float, nominal: float) -> None:
    """Refuse a nominal radius that is not that of the circle: a loop may shrink it at speed, by less than a half."""
    if not 1 / ANOTHER < measured / nominal < ANOTHER:
        what = f"the circle has a radius of {1e3 * measured:.4g} mm, and {1e3 * nominal:.4g} mm is given"
        raise InputError(what, "radius", "write the nominal radius of this circle, with its unit")


def _glitch(angle: FloatArray, rest: FloatArray, lead: float, side: float) -> float:
    """Deviation of largest magnitude after the reversal at + (side 1) or - (-1), positive outwards."""
    after = np.mod(angle + lead - side * math.pi / 2, 2 * math.pi)
    within = side * rest[after < GLITCH_SPAN]
    return float(within[np.argmax(np.abs(within))]) if len(within) else 0.0


@dataclass(frozen=True)
class CircularPath:
    """Figures of a measured circular path of two axes, in one direction.

    Attributes:
        direction: +1 counter-clockwise, -1 clockwise.
        angle: of the points about the least-squares centre, (n,) [rad], in their order in time.
        radial: distance from that centre minus the nominal radius, (n,) [m].
        deviation: G, largest minus smallest radius [m].
        radial_maximum, radial_minimum: F max and F min [m].
        radius: of the least-squares circle [m].
        centre: of it [m].
        glitches: largest deviation from the smooth path within 30 degrees after the axes' reversals at 0, 90, 180 and
            270 degrees [m], positive outwards; not a number where no point lies there.
    """

    direction: int
    angle: FloatArray
    radial: FloatArray
    deviation: float
    radial_maximum: float
    radial_minimum: float
    radius: float
    centre: tuple[float, float]
    glitches: tuple[float, float, float, float]


CENTRING_STEPS = 8
"""Gauss-Newton steps for the least-squares circle; each squares the relative error of the centre."""


def whole_turns(x: FloatArray, y: FloatArray) -> tuple[FloatArray, FloatArray]:
    """The middle of a path (n,) [m] that is whole turns, as an instrument begins before and ends behind them.

    In the overshoot the axes start and stop, and points there would weigh twice.
    """
    refuse_unknown("circular test", x=x, y=y)
    centre, _ = least_squares_circle(x, y)
    angle = np.abs(np.unwrap(np.arctan2(y - centre[1], x - centre[0])) - math.atan2(y[0] - centre[1], x[0] - centre[0]))
    turned, gap = float(angle[-1]), float(angle[-1]) / max(1, len(angle) - 1)
    over = turned - 2 * math.pi * math.floor((turned + 2 * gap) / (2 * math.pi))
    if turned < 2 * math.pi or over <= 2 * gap:
        return x, y
    within = (angle >= 0.5 * (over - gap)) & (angle <= turned - 0.5 * (over - gap))
    return x[within], y[within]


def circular_path(x: FloatArray, y: FloatArray, nominal: float) -> CircularPath:
    """The figures of points (n,) along a circle, one whole turn at least, in their order in time; lengths in m.

    An overshoot before and behind is left out. Raises InputError: fewer than 36 points, or less than one turn.
    """
    x, y = whole_turns(x, y)
    centre, radius = least_squares_circle(x, y)
    if nominal:
        _refuse_another_circle(radius, nominal)
    angle = np.unwrap(np.arctan2(y - centre[1], x - centre[0]))
    turned = float(angle[-1] - angle[0])
    gap = abs(turned) / max(1, len(angle) - 1)
    if len(angle) < 36 or abs(turned) + 2 * gap < 2 * math.pi:
        what = f"{len(angle)} points over {math.degrees(abs(turned)):.0f} degrees"
        raise InputError(what, "circular test", "give one whole turn at least, a point every 10 degrees or closer")
    radial = np.hypot(x - centre[0], y - centre[1]) - nominal
    direction = 1 if turned > 0 else -1
    harmonics = [np.ones_like(angle), *(wave(k * angle) for k in (1, 2) for wave in (np.sin, np.cos))]
    basis = np.column_stack(harmonics)  # radius, centre, gains and squareness are no glitches
    rest = radial - basis @ np.linalg.lstsq(basis, radial, rcond=None)[0]
    way = [np.mod(direction * (angle - quarter * math.pi / 2), 2 * math.pi) for quarter in range(4)]
    after = [(0.5 * gap < one) & (one < GLITCH_SPAN) for one in way]  # a point at the reversal has not turned yet
    glitches = [float(rest[one][np.argmax(np.abs(rest[one]))]) if one.any() else math.nan for one in after]
    return CircularPath(
        direction,
        angle,
        radial,
        float(np.ptp(radial)),
        float(radial.max()),
        float(radial.min()),
        radius,
        centre,
        (glitches[0], glitches[1], glitches[2], glitches[3]),
    )


def least_squares_circle(x: FloatArray, y: FloatArray) -> tuple[tuple[float, float], float]:
    """Centre and radius with the least sum of squared distances from the circle."""
    algebraic = np.column_stack([x, y, np.ones_like(x)])
    (a, b, _), *_ = np.linalg.lstsq(algebraic, x**2 + y**2, rcond=None)
    centre = np.array([0.5 * a, 0.5 * b])
    for _ in range(CENTRING_STEPS):
        away = np.stack([x - centre[0], y - centre[1]])
        distance = np.hypot(*away)
        slopes = np.column_stack([*(away / distance), np.ones_like(x)])
        step, *_ = np.linalg.lstsq(slopes, distance, rcond=None)
        centre += step[:2]
    return (float(centre[0]), float(centre[1])), float(np.mean(np.hypot(x - centre[0], y - centre[1])))
