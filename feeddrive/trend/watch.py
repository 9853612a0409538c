"""Following an axis over a folder of recordings: read what is new, pool, and say what changed.

Every recording is read once and passed linearly (`regressors`); all passes are pooled over equal positions (`pooling`);
the series of every quantity is searched for courses (`change_points`); courses that began together are one event.
"""

from __future__ import annotations

import hashlib
import time
from collections.abc import Mapping
from dataclasses import dataclass, replace
from datetime import datetime, timedelta
from pathlib import Path
from typing import Any

import numpy as np

from feeddrive.blas_threads import one_thread
from feeddrive.errors import InputError
from feeddrive.plant.plant import Plant
from feeddrive.trend.change_points import Course, course_of
from feeddrive.trend.checkpoint import USED, Checkpoint, Entry, load_checkpoint
from feeddrive.trend.events import Change, Event, Growth, events_of, growth_of
from feeddrive.trend.limits import Limit, limit_of
from feeddrive.trend.new_files import Options, Progress, read_new
from feeddrive.trend.pooling import Pooled, pool
from feeddrive.trend.regressors import TERMS
from feeddrive.trend.series_evidence import JUMP, Series, Timeline
from feeddrive.trend.watched_quantities import Quantity, means_of, prior_widths, quantities_of
from feeddrive.typing import FloatArray

LONGEST_SEARCHED = 500
"""Values of a series that are searched at a time; more are averaged to so many, and dates are as coarse as that."""


@dataclass(frozen=True, eq=False)
class Trend:
    """What a folder says of an axis.

    Attributes:
        plant: name.
        entries: what became of every file, used ones by date.
        days: of the recordings since the first, (n,).
        begin: date of the first.
        quantities: with their values.
        courses: of the quantities that were searched, by name.
        limits: by name.
        events: changes that began together, by date.
        odd: quantity and number of a recording that stands alone.
        growth: seen by a scale; None where nothing settles.
        pooled: maps and rests by channel.
        notes: remarks.
        seconds: reading and passing the new files, and all of it.
        fresh: how many were new.
    """

    plant: str
    entries: tuple[Entry, ...]
    days: FloatArray
    begin: datetime
    quantities: tuple[Quantity, ...]
    courses: Mapping[str, Course]
    limits: Mapping[str, Limit]
    events: tuple[Event, ...]
    odd: tuple[tuple[str, int], ...]
    growth: Growth | None
    pooled: Mapping[str, Pooled]
    notes: tuple[str, ...]
    seconds: tuple[float, float]
    fresh: int

    def when(self, day: float) -> datetime:
        """The date of a day since the first recording."""
        return self.begin + timedelta(days=float(day))

    @property
    def used(self) -> tuple[Entry, ...]:
        """The recordings that count, by date."""
        return tuple(one for one in self.entries if one.status == USED)


@one_thread()
def follow(
    plant: Plant, text: str, entries: Mapping[str, Any], folder: Path, out: Path, options: Options, progress: Progress
) -> tuple[Trend, Checkpoint]:
    """Read what is new in a folder of recordings and say what all of it says; `out` holds the checkpoint.

    The text that the plant was made from shows another plant, its entries give tolerances; `progress` is called with a
    line that says what is going on. Raises InputError: no folder, or no recording in it that can be used.
    """
    begun = time.monotonic()
    identity = _identity(text, options)
    kept, remark = load_checkpoint(out, identity)
    kept, fresh, notes = read_new(plant, folder, out, options, kept, progress)
    reading = time.monotonic() - begun
    progress("comparing at equal positions")
    trend = trend_of(plant, entries, options, kept, (remark, *notes))
    return replace(trend, seconds=(reading, time.monotonic() - begun), fresh=fresh), kept


def _identity(text: str, options: Options) -> str:
    """Checksum of all that decides what is kept of a file."""
    of_dates = (options.stamp, options.every is None)
    return hashlib.sha256(repr((text, str(options.mapping), options.decimal, of_dates)).encode()).hexdigest()


def _dated(kept: Checkpoint, options: Options) -> list[tuple[datetime, Entry]]:
    """The recordings that count with their dates, the first one first."""
    used = sorted((one for one in kept.entries.values() if one.status == USED), key=lambda one: one.key)
    if options.every is not None:
        first = options.first or datetime(2000, 1, 1)
        moments = [first + number * options.every for number in range(len(used))]
        return list(zip(moments, used, strict=True))
    found = [(datetime.fromisoformat(one.moment), one) for one in used if one.moment]
    return sorted(found, key=lambda pair: (pair[0], pair[1].key))


def trend_of(
    plant: Plant, declared: Mapping[str, Any], options: Options, kept: Checkpoint, notes: tuple[str, ...]
) -> Trend:
    """What all recordings that were passed say; the entries of the plant file give tolerances.

    Raises InputError where no recording can be used.
    """
    dated = _dated(kept, options)
    if not dated:
        reasons = sorted({one.reason for one in kept.entries.values()})
        why = reasons[0] if reasons else "the folder holds no file of one"
        raise InputError(f"no recording can be used ({why})", plant.name, "add recordings of the motion of this axis")
    begin = dated[0][0]
    days = np.array([(moment - begin).total_seconds() / 86400 for moment, _ in dated])
    used = [entry for _, entry in dated]
    pooled: dict[str, tuple[Pooled, FloatArray]] = {}
    widths = prior_widths(plant)
    for channel in TERMS:
        here = [(i, one) for i, entry in enumerate(used) for one in entry.passes if one.channel == channel]
        if here and kept.grid is not None:
            numbers = np.array([i for i, _ in here])
            pooled[channel] = pool([one for _, one in here], kept.grid, widths), numbers
    quantities: tuple[Quantity, ...] = ()
    if kept.grid is not None:
        quantities = quantities_of(pooled, plant, kept.grid, len(used), options.absolute)
    quantities += means_of([entry.means for entry in used])
    notes = (*notes, *_remarks(quantities, options, days))
    courses, limits, changes, odd = _searched(quantities, days, options, declared)
    others = tuple(one for one in kept.entries.values() if one.status != USED)
    return Trend(
        plant.name, (*used, *others), days, begin, quantities, courses, limits, events_of(changes), tuple(odd),
        growth_of(courses.get("offset"), courses.get("slope")), {name: one for name, (one, _) in pooled.items()},
        tuple(one for one in notes if one), (0.0, 0.0), 0,
    )  # fmt: skip


def _searched(
    quantities: tuple[Quantity, ...], days: FloatArray, options: Options, declared: Mapping[str, Any]
) -> tuple[dict[str, Course], dict[str, Limit], list[Change], list[tuple[str, int]]]:
    """Courses and limits of the quantities that are watched, what changed, and which recordings stand alone."""
    courses: dict[str, Course] = {}
    limits: dict[str, Limit] = {}
    changes: list[Change] = []
    odd: list[tuple[str, int]] = []
    watched = [one for one in quantities if one.watched]
    lines: dict[bytes, Timeline] = {}
    for quantity in watched:
        here = np.flatnonzero(np.isfinite(quantity.values))
        times, values = days[here], quantity.values[here]
        apart = np.concatenate([[True], np.diff(times) > 0])  # two of the same moment cannot be ordered in time
        here, times, values = here[apart], times[apart], values[apart]
        if len(times) < 3 or not np.ptp(values) > 0:
            continue
        course = _course(times, values, quantity.variance[here], len(watched), lines)
        courses[quantity.name] = course
        limit = limit_of(replace(quantity, values=values), course, times, options.limits or {}, declared, len(watched))
        if limit is not None:
            limits[quantity.name] = limit
        for found in course.found:
            if found.atom.kind == "odd":
                odd.append((quantity.name, int(here[int(np.argmin(np.abs(times - found.atom.date)))])))
            else:
                changes.append(Change(quantity, found))
    return courses, limits, changes, odd


def _course(
    times: FloatArray, values: FloatArray, variance: FloatArray, watched: int, lines: dict[bytes, Timeline]
) -> Course:
    """The course of a series, in its own units, at its own times."""
    size, middle = float(np.std(values)), float(np.mean(values))
    t, y, v = times, (values - middle) / size, np.minimum(variance, 100.0)
    if len(t) > LONGEST_SEARCHED:
        t, y, v = _averaged(t, y, v)
    line = lines.setdefault(t.tobytes() + v.tobytes(), Timeline(t, v))
    found = course_of(Series(line, y), watched)
    jumps = [one for one in found.found if one.atom.kind == JUMP]  # no ramps where neighbours were averaged

    def jumped(at: FloatArray) -> FloatArray:
        return np.sum([one.size * one.atom.course(at) for one in jumps], axis=0) if jumps else np.zeros(len(at))

    fitted = np.interp(times, t, found.fitted - jumped(t)) + jumped(times)
    band = np.interp(times, t, found.band)
    return Course(
        (middle + size * found.level[0], size * found.level[1]),
        size * found.scatter,
        tuple(replace(one, size=size * one.size, deviation=size * one.deviation) for one in found.found),
        middle + size * fitted,
        size * band,
    )


def _averaged(t: FloatArray, y: FloatArray, v: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Neighbours averaged to as many values as are searched at a time, each dated as its first."""
    groups = np.array_split(np.arange(len(t)), LONGEST_SEARCHED)
    return (
        np.array([t[group[0]] for group in groups]),
        np.array([np.mean(y[group]) for group in groups]),
        np.array([np.mean(v[group]) for group in groups]),
    )


def _remarks(quantities: tuple[Quantity, ...], options: Options, days: FloatArray) -> list[str]:
    """Remarks on what is shown."""
    names = {one.name: one for one in quantities}
    found = []
    if "slope" in names and not options.absolute:
        found.append(
            "The zero of the scale is taken to be free: an offset that moves is not called growth. "
            "Say --absolute where scale and motor keep their zeros."
        )
    if "offset" in names and np.nanstd(np.diff(names["offset"].values)) > 1e-3:
        found.append(
            "The table's zero against the motor scatters by more than 1 mm from recording to recording: "
            "the motor's zero is not kept, and growth cannot be told from it."
        )
    if len(days) > 1 and np.any(np.diff(days) == 0):
        found.append("Some recordings have the same date and time; the first of each is followed.")
    if len(days) > LONGEST_SEARCHED:
        found.append(f"More than {LONGEST_SEARCHED} recordings: neighbours are averaged where changes are looked for.")
    return found
