"""Time stamps of a table or container: which vector is the clock of which signal, and what its numbers count.

A clock belongs to the signals of its own group first: two groups of one length may be sampled at two rates. Where no
unit is given, dates are known by their size, since a number of 1.7e12 counts nothing but ms since 1970:

| counts | 2000 | 2100 |
|---|---|---|
| s, ms, µs, ns since 1970 | 946 684 800 s | 4 102 444 800 s |
| 100 ns since 1601 (Windows), since year 1 (.NET) | 1.2591e17, 6.3082e17 | 1.5747e17, 6.6238e17 |
| days since year 0 (MATLAB), since 1899-12-30 (tables) | 730 486, 36 526 | 767 011, 73 051 |
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from feeddrive.recording.traces.naming import UNIT_BEHIND, conversion, known_unit, leaf, plain_words
from feeddrive.recording.traces.trace import clean
from feeddrive.typing import FloatArray

_TIME = re.compile(
    r"(?:t|time ?stamps?|(?:elapsed |x |relative )?(?:time|zeit|tempo|tiempo|时间)(?: ?(?:axis|vector|vec))?)"
)
_TIME_UNIT = re.compile(r"(.*\S)[ _](s|sec|secs|seconds?|sek|ms|msec|us|µs|usec|ns)")
_DATES = (
    (1.0, 9.46e8, 4.11e9, "s since 1970"),
    (1e-3, 9.46e11, 4.11e12, "ms since 1970"),
    (1e-6, 9.46e14, 4.11e15, "µs since 1970"),
    (1e-9, 9.46e17, 4.11e18, "ns since 1970"),
    (1e-7, 1.259e17, 1.575e17, "100 ns since 1601"),
    (1e-7, 6.308e17, 6.624e17, "100 ns since the year 1"),
)
"""Seconds of a count, its numbers of 2000 and of 2100, and what it counts."""
_DAYS = ((7.3e5, 7.68e5, "days since the year 0"), (3.65e4, 7.31e4, "days since 1899-12-30"))
_LONGEST_DAY_STEP = 2e-6
"""Steps of a count of days below which it is one: 0.17 s between rows. As a count of s they would be of 500 kHz."""


@dataclass(frozen=True, eq=False)
class Clock:
    """A vector of time stamps.

    Attributes:
        name: of the vector.
        time: (n,) [s]; empty where it cannot be used.
        kept: rows that have a stamp, (n,) of all rows, bool.
        fault: why it cannot be used; empty if it can.
        note: what was assumed; empty if nothing was.
    """

    name: str
    time: FloatArray
    kept: Any
    fault: str = ""
    note: str = ""


def is_time(name: str) -> bool:
    """Tell whether a vector is called as time stamps are."""
    last = leaf(name)
    match = UNIT_BEHIND.match(last) or _TIME_UNIT.fullmatch(last)
    words = re.sub(r"[^\w]+|_", " ", re.sub(r"([a-z])([A-Z])", r"\1 \2", match[1] if match else last)).lower().strip()
    return _TIME.fullmatch(words) is not None or _TIME.fullmatch(plain_words(words)) is not None


def unit_of(name: str, given: str) -> tuple[str, str]:
    """Return a name without the unit in brackets behind it, and the unit."""
    match = UNIT_BEHIND.match(name)
    if match and known_unit(match[2]) and not given:
        return match[1], match[2]
    return name, given


def clocks_of(arrays: Mapping[str, Any], units: Mapping[str, str], sample_time: float | None) -> list[Clock]:
    """Return the clocks among named vectors; dates begin at zero together.

    Args:
        arrays: name -> (n,), numbers or dates.
        units: name -> unit, where the file says one.
        sample_time: [s], of what counts without a unit, where the person says it.
    """
    stamps = {name: values for name, values in arrays.items() if values.dtype.kind in "Mm" or is_time(name)}
    found = {}
    for name, values in stamps.items():
        found[name] = _counted(name, values, units.get(name, ""))
    zeros: dict[str, Any] = {}
    for name, (_, since, _) in found.items():
        if since:
            first = stamps[name][_there(stamps[name])][:1].min()
            zeros[since] = min(first, zeros.get(since, first))
    return [_clock(name, stamps[name], *found[name], zeros, sample_time) for name in stamps]


def clock_for(name: str, size: int, clocks: list[Clock]) -> Clock | None:
    """Return the clock of a signal: of its length, and of its group before any other; None if there is none."""
    same = [clock for clock in clocks if clock.kept.size == size]
    own = re.split(r"[/.]", name)[:-1]

    def shared(clock: Clock) -> int:
        path = re.split(r"[/.]", clock.name)[:-1]
        alike = [a == b for a, b in zip(own, path, strict=False)]
        return (alike.index(False) if False in alike else len(alike)) * 1000 - len(path)

    return max(same, key=lambda clock: (shared(clock), not clock.fault), default=None)


def _there(values: Any) -> Any:
    """Tell which rows have a stamp, (n,)."""
    if values.dtype.kind in "Mm":
        return ~np.isnat(values)
    return np.isfinite(values) if values.dtype.kind == "f" else np.ones(values.size, bool)


def _counted(name: str, values: Any, unit: str) -> tuple[float, str, str]:
    """Return the seconds of a count, 0 where it cannot be told, what a date counts since, and what to say of it."""
    if values.dtype.kind in "Mm":
        return 1e-9, "date" if values.dtype.kind == "M" else "", ""
    last = leaf(name)
    _, written = unit_of(last, unit)
    suffix = _TIME_UNIT.fullmatch(last)
    written = written or (suffix[2] if suffix else "")
    kept = values[_there(values)]
    first = float(kept[0]) if kept.size else 0.0
    step = float(np.median(np.diff(kept))) if kept.size > 1 else 0.0
    if written:
        to_si = conversion(known_unit(written) or written, "s")
        if to_si is None:
            return 0.0, "", f"the time {clean(name)} is in {clean(written)}, which is no unit of time"
        dated = next((what for size, low, high, what in _DATES if size == to_si.factor and low < first < high), "")
        return to_si.factor, dated, ""
    for size, low, high, what in _DATES:
        if low < first < high:
            return size, what, f"the time {clean(name)} has no unit; {what} by its size"
    for low, high, what in _DAYS:
        if low < first < high and 0.0 < step < _LONGEST_DAY_STEP:
            return 86400.0, what, f"the time {clean(name)} has no unit; {what} by its size"
    if kept.size and step >= 1.0 and bool(np.all(kept == np.round(kept))):
        return 0.0, "", f"the time {clean(name)} counts in whole numbers and has no unit"
    return 1.0, "", f"the time {clean(name)} has no unit; s assumed, another by a mapping"


def _clock(
    name: str, values: Any, size: float, since: str, said: str, zeros: Mapping[str, Any], sample_time: float | None
) -> Clock:
    kept = _there(values)
    stamps = values[kept]
    if values.dtype.kind in "Mm":
        stamps = stamps.astype(f"{values.dtype.kind}8[ns]")
        begin = zeros[since].astype(stamps.dtype) if since else np.timedelta64(0, "ns")
        time: FloatArray = (stamps - begin).astype(np.int64) / 1e9
    elif size:
        exact = stamps - zeros[since] if since else stamps  # whole numbers of 64 bits are exact to their difference
        time = exact / round(1.0 / size) if size < 1.0 else exact * size  # the nearest double to a decimal stamp
    else:
        steps = np.diff(stamps)
        usual = float(np.median(steps)) if steps.size else 0.0
        if sample_time is None or usual <= 0.0:
            return Clock(name, np.empty(0), kept, said)
        time, said = (stamps - stamps[0]) / usual * sample_time, ""
    time = np.ascontiguousarray(time, dtype=np.float64)
    back = np.flatnonzero(~(np.diff(time) > 0.0))
    if back.size or not time.size:
        row = int(np.flatnonzero(kept)[back[0] + 1]) + 1 if back.size else 1
        return Clock(name, np.empty(0), kept, f"the time {clean(name)} does not increase at row {row}")
    lost = int(np.sum(~kept))
    more = [f"{lost} rows have no time in {clean(name)} and are left out"] if lost else []
    return Clock(name, time, kept, "", "; ".join([said, *more] if said else more))
