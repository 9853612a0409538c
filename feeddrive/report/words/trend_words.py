"""What a folder of recordings says, in sentences and rows."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from feeddrive.trend.change_points import FEWEST, Found
from feeddrive.trend.events import Change, Event, Settles
from feeddrive.trend.limits import Limit
from feeddrive.trend.series_evidence import JUMP, ODD, SETTLING, SLOPE
from feeddrive.trend.watch import Trend
from feeddrive.trend.watched_quantities import Quantity
from feeddrive.units.quantity import format_quantity

_CLOCK = 3.0
"""Days of recordings up to which dates are printed with the time of day."""


def verdict_lines(trend: Trend, searched: Mapping[int, str]) -> list[str]:
    """The findings, the first one the main one."""
    changes = [event_sentence(trend, event) for event in trend.events if not _is_growth(trend, event)]
    growth = growth_lines(trend)
    lines = [*growth, *changes]
    if not lines:
        count = len(trend.used)
        few = f"{count} recordings are too few to tell a change, which takes {FEWEST}."
        lines = [few if count < FEWEST else f"Nothing changed in {count} recordings."]
    lines += [f"Full search: {text}." for _, text in sorted(searched.items())]
    left = [name for name, limit in trend.limits.items() if limit.left is not None]
    if left:
        lines.append(f"Beyond its limits: {', '.join(name.replace('_', ' ') for name in left)}.")
    return lines


def _is_growth(trend: Trend, event: Event) -> bool:
    """Whether an event is reported as growth already."""
    named = {change.quantity.name for change in event.changes}
    return trend.growth is not None and event.kind == SETTLING and named <= {"offset", "slope"}


def event_sentence(trend: Trend, event: Event) -> str:
    """An event: what, when, at what odds, which effects move these quantities."""
    first = event.changes[0]
    what = " and ".join(_change_words(change) for change in event.changes[:3])
    causes = " or ".join(name.replace("_", " ") for name in event.causes[:2])
    named = f"; as {causes} would" if causes else ""
    odds = odds_words(max(change.found.odds for change in event.changes))
    low, high = (date_words(trend, day) for day in event.dates)
    when = date_words(trend, event.day) if low == high else f"{date_words(trend, event.day)} ({low} to {high})"
    begins = "On" if first.found.atom.kind == JUMP else "Since"
    if begins == "On" and low != high:
        begins, when = "Between", f"{low} and {high}"
    return f"{begins} {when} {what}, odds {odds}{named}."


def _change_words(change: Change) -> str:
    return f"{change.quantity.name.replace('_', ' ')} {course_words(change.quantity, change.found)}"


def course_words(quantity: Quantity, found: Found) -> str:
    """One course: how much, how fast."""
    size = signed(found.size, quantity.unit)
    if found.atom.kind == JUMP:
        return f"jumps by {size}"
    if found.atom.kind == SLOPE:
        return f"changes by {signed(30 * found.size, quantity.unit)} in 30 days on average"
    if found.atom.kind == ODD:
        return f"is {size} off in one recording"
    return f"settles by {size} with a time constant of {span_words(found.atom.time_constant)}"


def growth_lines(trend: Trend) -> list[str]:
    """Growth seen from the scale."""
    growth = trend.growth
    if growth is None:
        return []
    lines = []
    for name, one, unit in (("offset", growth.offset, "m"), ("slope", growth.slope, "m/m")):
        if one is not None:
            lines.append(f"The {name} of the table against the motor {_settles(one, unit)}.")
    if growth.fixed_point is not None:
        place, spread = growth.fixed_point
        lines.append(f"The fixed point lies at {format_quantity(place, 'm')} ± {format_quantity(1.96 * spread, 'm')}.")
    return lines


def _settles(one: Settles, unit: str) -> str:
    low, high = (span_words(edge) for edge in one.interval)
    grown = f"{signed(one.growth, unit)} ± {size_words(1.96 * one.deviation, unit)}"
    return f"grows by {grown} with a time constant of {span_words(one.time_constant)} ({low} to {high})"


def shown_quantities(trend: Trend) -> list[Quantity]:
    """Those that a recording shows."""
    return [one for one in trend.quantities if np.isfinite(one.values).any()]


def quantity_rows(trend: Trend) -> list[list[str]]:
    """One row per quantity: first, last, scatter of a file, what it did, limits."""
    rows = []
    for quantity in shown_quantities(trend):
        here = quantity.values[np.isfinite(quantity.values)]
        course, limit = trend.courses.get(quantity.name), trend.limits.get(quantity.name)
        if course is None or len(here) < FEWEST:  # no course is told from so few: what was measured
            first, last, scatter, did = here[0], here[-1], "", "too few to tell" if course else ""
        else:
            first, last = course.fitted[0], course.fitted[-1]
            scatter = f"± {size_words(1.96 * course.scatter, quantity.unit)}"
            did = "; ".join(_dated(trend, quantity, one) for one in course.found) or "steady"
        rows.append(
            [
                quantity.words,
                size_words(float(first), quantity.unit),
                size_words(float(last), quantity.unit),
                scatter,
                did,
                limit_words(trend, quantity, limit),
            ]
        )
    return rows


def _dated(trend: Trend, quantity: Quantity, found: Found) -> str:
    since = "on" if found.atom.kind in (JUMP, ODD) else "since"
    low, high = (date_words(trend, day) for day in found.dates)
    if found.atom.kind == JUMP and low != high:
        return f"between {low} and {high} {course_words(quantity, found)}"
    return f"{since} {date_words(trend, found.atom.date)} {course_words(quantity, found)}"


def limit_words(trend: Trend, quantity: Quantity, limit: Limit | None) -> str:
    """Limits, and whether they are left or will be reached."""
    if limit is None:
        return ""
    words = f"{size_words(limit.low, quantity.unit)} to {size_words(limit.high, quantity.unit)} ({limit.origin})"
    if limit.left is not None:
        here = np.flatnonzero(np.isfinite(quantity.values))
        return f"{words}: left on {date_words(trend, float(trend.days[here[limit.left]]))}"
    if limit.reached is not None:
        return f"{words}: reached on {date_words(trend, limit.reached)} if it goes on"
    return words


def date_words(trend: Trend, day: float) -> str:
    """A date, with the time of day where recordings come by the hour."""
    short = float(trend.days[-1] - trend.days[0]) <= _CLOCK
    return f"{trend.when(day):%Y-%m-%d %H:%M}" if short else f"{trend.when(day):%Y-%m-%d}"


def span_words(days: float) -> str:
    """A span of time in the unit that a person would take."""
    seconds = 86400 * days
    if seconds < 5400:
        return f"{seconds / 60:.3g} min"
    return f"{seconds / 3600:.3g} h" if seconds < 2 * 86400 else f"{days:.3g} days"


def odds_words(odds: float) -> str:
    """Odds that are beyond counting are printed as that."""
    return f"{odds:.0f} : 1" if odds < 1e4 else "more than 10 000 : 1"


def size_words(value: float, unit: str) -> str:
    """A value for people; slopes per length in µm/m."""
    if not math.isfinite(value):
        return "none"
    return f"{1e6 * value:.4g} µm/m" if unit == "m/m" else format_quantity(value, unit)


def signed(value: float, unit: str) -> str:
    """A difference with its sign; of temperatures in K."""
    plain = size_words(abs(value), "K" if unit == "degC" else unit)
    return f"{'−' if value < 0 else '+'}{plain}"
