"""Growth seen from a scale alone: offset and slope of the table against the motor settle, each with a time constant.

    growth(x, t) = o(t) + s(t) x,    fixed point: growth(x_f, end) = 0,  x_f = -o_end / s_end

Without an absolute scale the offset is the zero of a scale and says nothing; the slope alone is told then.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from feeddrive.trend.atoms import SETTLING
from feeddrive.trend.change_points import Course, Found


@dataclass(frozen=True)
class Settles:
    """How one of offset and slope settles.

    Attributes:
        growth, deviation: what it grows by in the end, with its standard deviation.
        time_constant: [days].
        interval: of the time constant, 95 %.
    """

    growth: float
    deviation: float
    time_constant: float
    interval: tuple[float, float]


@dataclass(frozen=True)
class Growth:
    """Growth of the table's reading.

    Attributes:
        offset, slope: how they settle [m, m/m]; None where one does not, or is not known.
        fixed_point: where nothing grows at the end [m], with its standard deviation; None where it is not known.
    """

    offset: Settles | None
    slope: Settles | None
    fixed_point: tuple[float, float] | None


def growth_of(offset: Course | None, slope: Course | None) -> Growth | None:
    """Growth from the courses of offset and slope; None where neither settles."""
    parts = [None if course is None else _settles(course) for course in (offset, slope)]
    if parts == [None, None]:
        return None
    fixed = None
    if offset is not None and slope is not None:
        o, s = (float(course.fitted[-1] - course.fitted[0]) for course in (offset, slope))
        spread_o, spread_s = (math.hypot(*(float(course.band[i]) for i in (0, -1))) for course in (offset, slope))
        if abs(s) > 3 * spread_s:
            place = -o / s
            fixed = (place, math.hypot(spread_o / s, place * spread_s / s))
    return Growth(parts[0], parts[1], fixed)


def _settles(course: Course) -> Settles | None:
    found: list[Found] = [one for one in course.found if one.atom.kind == SETTLING]
    if not found:
        return None
    main = max(found, key=lambda one: abs(one.size))
    return Settles(main.size, main.deviation, main.atom.time_constant, main.time_constants)
