"""What happened to the machine: changes of quantities at the same time are one event, named by what they share.

Growth seen from a scale alone: offset and slope of the table against the motor settle, each with a time constant.

    growth(x, t) = o(t) + s(t) x,    fixed point: growth(x_f, end) = 0,  x_f = -o_end / s_end

Without an absolute scale the offset is the zero of a scale and says nothing; the slope alone is reported then.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import logsumexp

from feeddrive.trend.change_points import ASSERTED, Course, Found, most_likely
from feeddrive.trend.series_evidence import JUMP, ODD, SETTLING, SLOPE
from feeddrive.trend.watched_quantities import Quantity
from feeddrive.typing import FloatArray


@dataclass(frozen=True)
class Change:
    """A course of one quantity."""

    quantity: Quantity
    found: Found


@dataclass(frozen=True)
class Event:
    """Changes that began together.

    Attributes:
        kind: "jump", "slope" or "settling".
        changes: the surest first.
        dates: interval of days that holds the date with 95 %, by all of these quantities together.
        day: in the middle of its probability: as likely earlier as later.
        causes: effects that move all of these quantities, or what most of them share, the likeliest first.
    """

    kind: str
    changes: tuple[Change, ...]
    dates: tuple[float, float]
    day: float
    causes: tuple[str, ...]


def events_of(changes: Sequence[Change]) -> tuple[Event, ...]:
    """Group changes of a kind whose dates may be the same, by date; odd recordings are no events."""
    groups: list[list[Change]] = []
    reported = [one for one in changes if one.found.atom.kind != ODD]
    for one in sorted(reported, key=lambda change: change.found.dates[1] - change.found.dates[0]):
        group = next((group for group in groups if _together(group[0].found, one.found)), None)
        if group is None:
            groups.append([one])
        else:
            group.append(one)
    return tuple(sorted(map(_event, groups), key=lambda event: event.day))


def _together(one: Found, other: Found) -> bool:
    """Whether two changes of a kind (slow or sudden) may have begun together: two are reported at odds of 100 as well.

    Odds of one date against two: sum over d of p(d) q(d), times the dates that a second event could have.
    """
    if (one.atom.kind == JUMP) != (other.atom.kind == JUMP):
        return False
    dates = other.posterior[0]
    both = np.maximum(np.interp(dates, *one.posterior, left=LEAST, right=LEAST), LEAST) + other.posterior[1]
    return float(logsumexp(both)) + float(np.log(len(dates))) > -float(np.log(ASSERTED))


def _event(group: list[Change]) -> Event:
    ordered = tuple(sorted(group, key=lambda change: -change.found.odds))
    kind = JUMP
    if group[0].found.atom.kind != JUMP:  # one kind of wear or warming moves all of these quantities
        kind = SETTLING if sum(change.found.settles for change in group) > 0 else SLOPE
    dates, logs = _together_dated([change.found for change in group])
    since = np.min([np.interp(dates, one.found.posterior[0], one.found.since) for one in group], axis=0)
    return Event(
        kind,
        ordered,
        most_likely(dates, logs, np.minimum(since, dates) if kind == JUMP else dates),
        float(dates[int(np.searchsorted(np.cumsum(np.exp(logs)), 0.5))]),
        _causes(ordered, kind),
    )


LEAST = -20.0
"""Log probability of a date that a quantity leaves to others: its own law of change is never exactly the machine's."""


def _together_dated(found: Sequence[Found]) -> tuple[FloatArray, FloatArray]:
    """Possible dates of one beginning, and the log of their probability by all quantities that it shows in."""
    dates = np.unique(np.concatenate([one.posterior[0] for one in found]))
    logs = np.zeros(len(dates))
    for one in found:
        own = np.interp(dates, *one.posterior, left=LEAST, right=LEAST)
        logs += np.maximum(own, LEAST)
    return dates, logs - float(logsumexp(logs))


def _causes(changes: Sequence[Change], kind: str) -> tuple[str, ...]:
    """Effects by how many of the quantities they move; a sudden play is play and not a loss of preload."""
    count: dict[str, float] = {}
    for change in changes:
        for place, effect in enumerate(change.quantity.effects):
            weight = 1.0 - 0.01 * place
            if effect == "preload_loss":
                weight = _as_preload(change) if kind in (SLOPE, SETTLING) else 0.2
            count[effect] = count.get(effect, 0.0) + weight
    best = max(count.values(), default=0.0)
    return tuple(sorted((name for name, value in count.items() if value > 0.7 * best), key=lambda name: -count[name]))


def _as_preload(change: Change) -> float:
    """How a slow change speaks for a loss of preload: friction and stiffness fall with it, lost motion rises."""
    rises = change.found.size > 0
    expected = change.quantity.name == "play"
    return 1.05 if rises == expected else -1.0


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
