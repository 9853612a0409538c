"""Limits of what is watched: given by a person, set by a plant file's tolerance, or shown by the first weeks."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.special import stdtrit

from feeddrive.errors import InputError
from feeddrive.trend.change_points import Course
from feeddrive.trend.series_evidence import ODD
from feeddrive.trend.watched_quantities import Quantity
from feeddrive.typing import FloatArray
from feeddrive.units.quantity import parse

FIRST = 20
"""Recordings at the beginning that a limit is taken from at most: the first weeks of daily ones."""

FEWEST_FIRST = 8
"""Recordings that tell a scatter to a quarter."""

A_YEAR = 250
FALSE_YEARS = 0.01
"""A limit from the first weeks is left by chance in one of a hundred steady years of so many recordings."""


@dataclass(frozen=True)
class Limit:
    """Limits of one quantity, SI.

    Attributes:
        low, high: infinite where there is none.
        origin: "given", "declared tolerance", "first recordings".
        left: number of the first recording beyond it whose successors stay there too, or None.
        reached: day at which it is reached if what goes on goes on, or None.
    """

    low: float
    high: float
    origin: str
    left: int | None = None
    reached: float | None = None


def limit_of(
    quantity: Quantity,
    course: Course,
    days: FloatArray,
    given: Mapping[str, str],
    entries: Mapping[str, Any],
    watched: int,
) -> Limit | None:
    """The limits of a quantity, for its course at days, ascending, (k,); None where nothing sets any.

    `given` is quantity to what a person allows, "10 µm" or "20 %", about its first level; `watched` counts the
    quantities that are watched together. Raises InputError for an allowance that is none.
    """
    values = quantity.values[np.isfinite(quantity.values)]
    level = course.level[0]
    allowed, origin = _allowed(quantity, level, given, entries)
    low, high = level - allowed, level + allowed
    if not math.isfinite(allowed):
        early = [found.atom.date for found in course.found if found.atom.kind != ODD]
        first = values[(days < min(early, default=math.inf)) & (np.arange(len(days)) < FIRST)]
        if len(first) < FEWEST_FIRST:
            return None
        share = FALSE_YEARS / (2 * A_YEAR * max(watched, 1))
        reach = -float(stdtrit(len(first) - 1, share)) * float(np.std(first, ddof=1)) * math.sqrt(1 + 1 / len(first))
        low, high, origin = float(np.mean(first)) - reach, float(np.mean(first)) + reach, "first recordings"
    outside = (course.fitted < low) | (course.fitted > high)
    left = int(np.argmax(outside)) if outside.any() and outside[-1] else None
    return Limit(low, high, origin, left, None if left is not None else _reached(course, days, low, high))


def _allowed(
    quantity: Quantity, level: float, given: Mapping[str, str], entries: Mapping[str, Any]
) -> tuple[float, str]:
    """What a quantity may move by, and who says so; infinite where nobody does."""
    if quantity.name in given:
        return _share(given[quantity.name], level, quantity.unit, f"limit {quantity.name}"), "given"
    written = _tolerance(quantity.declared, entries)
    if written:
        return _share(written, level, quantity.unit, quantity.declared), "declared tolerance"
    return math.inf, ""


def refuse_no_allowance(quantity: Quantity, text: str) -> None:
    """Refuse what is given as a limit of a quantity and is none, before anything is searched for it.

    Raises:
        InputError: a bare number, another unit, or nothing.
    """
    _share(text, 1.0, quantity.unit, f"limit {quantity.name}")


def _share(text: str, level: float, unit: str, where: str) -> float:
    plain = text.removeprefix("±").strip()
    if plain.endswith("%"):
        try:
            found = float(plain.removesuffix("%")) / 100 * abs(level)
        except ValueError:
            raise InputError(f'"{text}" is no share', where, 'write "20 %", or a quantity') from None
    else:
        found = parse(plain, unit, where, may_vanish=True)
    if not found > 0:
        raise InputError(f'"{text}" allows nothing', where, "write it above zero")
    return found


def _tolerance(key: str, entries: Mapping[str, Any]) -> str:
    """The tolerance that a plant file declares for a key `section.key` or `effect.name.key`; empty if none."""
    parts = key.split(".")
    table: Any = entries.get(parts[0]) if key else None
    if parts[0] == "effect" and isinstance(table, Sequence):
        table = next((one for one in table if isinstance(one, Mapping) and one.get("name") == parts[1]), None)
    value = table.get(parts[-1]) if isinstance(table, Mapping) else None
    return str(value.get("tolerance", "")) if isinstance(value, Mapping) else ""


def _reached(course: Course, days: FloatArray, low: float, high: float) -> float | None:
    """Day at which the present slope reaches a limit, within as long again as was watched."""
    if len(days) < 2 or not any(found.atom.kind == "slope" for found in course.found):
        return None
    rate = float((course.fitted[-1] - course.fitted[-2]) / (days[-1] - days[-2]))
    if rate == 0:
        return None
    left = ((high if rate > 0 else low) - float(course.fitted[-1])) / rate
    return float(days[-1]) + left if left <= float(days[-1] - days[0]) else None
