"""Following an axis over months: a folder of recordings, and what it says of the machine."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from datetime import timedelta
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from feeddrive.errors import InputError
from feeddrive.interface.axis import Axis, axis_of
from feeddrive.interface.quantities import Quantity, positive
from feeddrive.interface.shown import Listing, Shown, finite
from feeddrive.output_folder import output_folder, refuse_unusable
from feeddrive.trend.change_searches import searched_events
from feeddrive.trend.checkpoint import USED, save_checkpoint
from feeddrive.trend.events import Event
from feeddrive.trend.folder import read_moment
from feeddrive.trend.limits import Limit, refuse_no_allowance
from feeddrive.trend.new_files import Options
from feeddrive.trend.watch import Trend, follow

if TYPE_CHECKING:
    from feeddrive.report.figures.drawing import ReportFigure

PLACE = "_watch"
"""Results are kept beside the folder, under its name and this."""

ABSOLUTE = ("table_position", "motor_angle", "setpoint")


@dataclass(frozen=True, repr=False, eq=False)
class Watched(Shown):
    """What a folder of recordings says of an axis.

    Attributes:
        axis: as declared.
        trend: everything, plain values, SI; days count from the first recording.
        out: folder of the results.
        searched: what the full search says at a change, by the number of the event.
    """

    axis: Axis
    trend: Trend
    out: Path
    searched: Mapping[int, str] = field(default_factory=dict)

    @property
    def verdict(self) -> str:
        """What changed, when, at what odds; or that nothing did."""
        from feeddrive.report.words.trend_words import verdict_lines

        return " ".join(verdict_lines(self.trend, self.searched))

    def __repr__(self) -> str:
        """The verdict."""
        return self.verdict

    def values(self, name: str) -> tuple[np.ndarray, np.ndarray]:
        """Days since the first recording and values of a quantity, (n,), SI; not a number where it is not shown.

        Raises:
            InputError: no such quantity; names those there are.
        """
        found = next((one for one in self.trend.quantities if one.name == name), None)
        if found is None:
            held = ", ".join(one.name for one in self.trend.quantities)
            raise InputError(f'no quantity "{name}"', self.axis.name, f"it has {held}")
        return self.trend.days, found.values

    def listing(self) -> Listing:
        """One row per quantity: value at the end with its band, what it did, its limits."""
        from feeddrive.report.words.trend_words import quantity_rows, shown_quantities

        headings = ("quantity", "at first", "at last", "± one file", "what it did", "limits")
        records = [_record(self.trend, one.name) for one in shown_quantities(self.trend)]
        return Listing(self._title, headings, quantity_rows(self.trend), records)

    @property
    def _title(self) -> str:
        from feeddrive.report.words.trend_words import date_words

        first, last = (date_words(self.trend, float(self.trend.days[i])) for i in (0, -1))
        return f"{self.axis.name}: {len(self.trend.used)} recordings from {first} to {last}"

    def record(self) -> dict[str, Any]:
        """Plain values for JSON, SI."""
        trend = self.trend
        return {
            "format": "feeddrive-watch/1",
            "plant": trend.plant,
            "title": self._title,
            "recordings": [
                {"file": one.key, "date": trend.when(float(day)).isoformat()}
                for one, day in zip(trend.used, trend.days, strict=True)
            ],
            "not_used": [
                {"file": one.key, "status": one.status, "reason": one.reason}
                for one in trend.entries
                if one.status != USED
            ],
            "quantities": [_record(trend, one.name) for one in trend.quantities],
            "events": [_event(trend, event, self.searched.get(i, "")) for i, event in enumerate(trend.events)],
            "odd": [{"quantity": name, "file": trend.used[i].key} for name, i in trend.odd],
            "growth": _growth(trend),
            "notes": list(trend.notes),
            "seconds": {
                "reading": round(trend.seconds[0], 3),
                "all": round(trend.seconds[1], 3),
                "new_files": trend.fresh,
            },
        }

    def save(self) -> Path:
        """Write `trend.html`, `trend.json`, `trend.csv` and the figures beside the checkpoint.

        Raises:
            InputError: the folder cannot be written.
        """
        from feeddrive.report.pages.trend_page import write_trend

        with output_folder(self.out) as folder:
            write_trend(self.trend, self.searched, self._title, self.record(), folder)
        return self.out

    def _figures(self) -> list[ReportFigure]:
        from feeddrive.report.figures.figure_trend import trend_figures

        return trend_figures(self.trend)


def watch(
    folder: str | Path,
    plant: Axis | str | Path,
    *,
    out: str | Path | None = None,
    map: str | Path | None = None,
    decimal: str | None = None,
    stamp: str = "",
    every: Quantity | None = None,
    first: str = "",
    absolute: str | tuple[str, ...] | list[str] = (),
    limits: Mapping[str, str] | None = None,
    search: bool = False,
    progress: Callable[[str], None] | None = None,
) -> Watched:
    """Follow an axis over a folder of recordings.

    Args:
        folder: recordings, in sub-folders and zip archives too; what was read before is not read again.
        plant: the axis as declared.
        out: folder of the results and the checkpoint; beside `folder`, with "_watch" behind its name, if left out.
        map: mapping file for recordings in a foreign format.
        decimal: "." or ",", where files leave it open.
        stamp: pattern of `strptime` that a part of each name meets, such as "%Y%m%d_%H%M".
        every: distance of the recordings in the order of names, "1 day", where neither name nor content holds a date.
        first: date of the first one, then.
        absolute: channels whose zero is kept from recording to recording, such as "table_position": an offset of the
            table against the motor that moves is growth then. A plant's `[[sensor]]` may say `absolute = true` instead.
        limits: quantity to what it may move by, {"play": "10 µm", "coulomb": "20 %"}.
        search: diagnose the recordings before and after each change, which takes minutes; kept for the next time.
        progress: called with a word for what is being done.

    Raises:
        InputError: no folder, no recording that can be used, or an option that is none.
    """
    plant, report = axis_of(plant), progress or (lambda _: None)
    place = Path(folder)
    if plant.values or plant.added:
        raise InputError("the axis was changed after it was loaded", plant.name, "save it, and load the file")
    if not plant.has_motion:
        raise InputError("the plant declares heat alone", plant.name, "declare the motion of the axis")
    target = Path(out) if out is not None else place.parent / f"{place.name or 'folder'}{PLACE}"
    refuse_unusable(target)
    options = Options(
        None if map is None else Path(map),
        decimal,
        stamp,
        read_moment(first, "first") if first else None,
        None if every is None else timedelta(seconds=positive(every, "s", "every", "1 day")),
        _absolute(absolute, plant),
        dict(limits or {}),
    )
    trend, kept = follow(plant.plant, plant.text, plant.entries, place, target, options, report)
    given = options.limits or {}
    unknown = set(given) - {one.name for one in trend.quantities if one.watched}
    if unknown:
        held = ", ".join(one.name for one in trend.quantities if one.watched)
        raise InputError(f'no quantity "{sorted(unknown)[0]}" is watched', "limits", f"it has {held}")
    for one in trend.quantities:
        if one.name in given:
            refuse_no_allowance(one, given[one.name])
    if not search:
        return Watched(plant, trend, target)
    found, kept = searched_events(plant.plant, trend, kept, place, target, options, report)
    save_checkpoint(target, kept)
    return Watched(plant, trend, target, found)


def _absolute(channels: str | tuple[str, ...] | list[str], plant: Axis) -> bool:
    """Whether the scale keeps its zero, by what is asked for or by what the plant's sensors declare."""
    given = [channels] if isinstance(channels, str) else list(channels)
    for one in given:
        if one not in ABSOLUTE:
            raise InputError(f'"{one}" has no zero to keep', "absolute", f"name {' or '.join(ABSOLUTE)}")
    declared = [sensor.channel for sensor in plant.plant.sensors if sensor.absolute]
    return "table_position" in (*given, *declared)


def _record(trend: Trend, name: str) -> dict[str, Any]:
    """One quantity for JSON."""
    quantity = next(one for one in trend.quantities if one.name == name)
    course, limit = trend.courses.get(name), trend.limits.get(name)
    record: dict[str, Any] = {
        "name": name,
        "words": quantity.words,
        "unit": quantity.unit,
        "values": [finite(value) for value in quantity.values],
    }
    if course is not None:
        here = np.isfinite(quantity.values)
        record |= {
            "scatter": course.scatter,
            "course": [float(v) for v in course.fitted],
            "course_sd": [float(v) for v in course.band],
            "shown": int(here.sum()),
        }
        record["changes"] = [
            {
                "kind": one.atom.kind,
                "date": trend.when(one.atom.date).isoformat(),
                "dates95": [trend.when(day).isoformat() for day in one.dates],
                "odds": one.odds,
                "size": one.size,
                "size_sd": one.deviation,
                "size_per": "day" if one.atom.kind == "slope" else "",
                "power": one.atom.power,
                "time_constant_s": 86400 * one.atom.time_constant or None,
                "time_constant95_s": [86400 * edge for edge in one.time_constants] if one.atom.time_constant else None,
            }
            for one in course.found
        ]
    if limit is not None:
        record["limit"] = _limit(trend, limit)
    return record


def _limit(trend: Trend, limit: Limit) -> dict[str, Any]:
    return {
        "low": finite(limit.low),
        "high": finite(limit.high),
        "origin": limit.origin,
        "left_at": None if limit.left is None else trend.used[limit.left].key,
        "reached": None if limit.reached is None else trend.when(limit.reached).isoformat(),
    }


def _event(trend: Trend, event: Event, searched: str) -> dict[str, Any]:
    return {
        "kind": event.kind,
        "date": trend.when(event.day).isoformat(),
        "dates95": [trend.when(day).isoformat() for day in event.dates],
        "causes": list(event.causes),
        "quantities": [change.quantity.name for change in event.changes],
        "odds": max(change.found.odds for change in event.changes),
        "searched": searched or None,
    }


def _growth(trend: Trend) -> dict[str, Any] | None:
    growth = trend.growth
    if growth is None:
        return None
    content: dict[str, Any] = {}
    for name, one in (("offset", growth.offset), ("slope", growth.slope)):
        if one is not None:
            content[name] = {
                "growth": one.growth,
                "sd": one.deviation,
                "unit": "m" if name == "offset" else "m/m",
                "time_constant_s": 86400 * one.time_constant,
                "time_constant95_s": [86400 * edge for edge in one.interval],
            }
    if growth.fixed_point is not None:
        content["fixed_point"] = {"value": growth.fixed_point[0], "sd": growth.fixed_point[1], "unit": "m"}
    return content
