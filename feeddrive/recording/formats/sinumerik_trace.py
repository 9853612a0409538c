"""SINUMERIK Operate trace, XML (`traceSession`): a value is written only when it changes.

Each signal has a grid of its own: from its first value on, one point every `interval`, the last value held. The points
of the interpolator cycle (4 ms, say) lie between those of the servo cycle, so channels keep their own times. Units are
known by class alone (`unitsType`). The present points alone, joined by lines, would make ramps of steps.
"""

from __future__ import annotations

import math
import re
from array import array
from dataclasses import dataclass
from xml.etree.ElementTree import Element

import numpy as np

from feeddrive.errors import InputError
from feeddrive.recording.traces.trace import Signal, Trace, clean, unique_names
from feeddrive.recording.traces.xml_tree import parse_xml
from feeddrive.typing import FloatArray

NAME = "SINUMERIK Operate trace"
_KINDS = {"posn": "position", "velo": "velocity", "velorot": "speed", "accel": "acceleration", "current": "current",
          "torque": "torque", "force": "force", "power": "power"}  # fmt: skip
_MOST_POINTS = 20_000_000  # a day at 4 ms; more is a damaged time
_NOTHING = 9.2188684e18  # bits of a double that is no number, written as a whole number where there was no value yet
_OFF_GRID = 0.01  # of the interval: stamps are written in whole µs


def recognises(head: str) -> bool:
    """Tell by its first letters whether a text is such a trace."""
    return "<traceSession" in head or (
        "SINUMERIK" in head and "trace" in head.lower() and head.lstrip("\ufeff \n").startswith("<")
    )


@dataclass(frozen=True)
class _Declared:
    """What the file says of a signal: id, name, interval [s], number of points, class of unit."""

    id: str
    name: str
    about: str
    interval: float
    points: int
    kind: str


def read(text: str, where: str) -> Trace:
    """Read a trace.

    Raises:
        InputError: not whole XML, no data, values that are no numbers or do not lie on the signal's grid.
    """
    records = _Records(where)
    root = parse_xml(text, where, records.takes)
    frames = [element for element in root.iter() if _tag(element) == "dataFrame"]
    if not frames:
        raise InputError("the trace holds no data", where, "save it with its data at the control")
    notes: list[str] = []
    if len(frames) > 1:
        notes.append(f"{len(frames)} frames of data; the first is read")
    frame = frames[0]
    for header in (one for one in frame.iter() if _tag(one) == "frameHeader"):
        lost = header.get("dropOuts", "0").strip()
        if lost not in ("", "0"):
            notes.append(f"the control reports {lost} drop-outs: samples are missing and were held")
    declared = [_declared(element, where) for element in frame.iter() if _tag(element) == "dataSignal"]
    if len({one.id for one in declared}) < len(declared):
        raise InputError("two signals have one id", where, "save the trace again at the control")
    if not declared:
        raise InputError("the trace names no signal", where, "save it with its data at the control")
    times, values = records.present({one.id for one in declared})
    if not any(map(len, times.values())):
        raise InputError("no signal of the trace has a value", where, "save it with its data at the control")
    end = max(stamps[-1] for stamps in times.values() if len(stamps))
    for header in (one for one in frame.iter() if _tag(one) == "frameHeader"):
        stop = _number(header.get("stopInc", "0"), f"{where}, frameHeader")
        end = max(end, stop) if math.isfinite(stop) else end
    signals, held = [], 0
    finest = sorted({one.interval for one in declared if one.interval > 0.0})[:1]
    names = unique_names([one.name for one in declared])
    for name, one in zip(names, declared, strict=True):
        if not len(times[one.id]):
            notes.append(f"{name} has no value in the file and is left out")
            continue
        stamps = times[one.id]
        index, step = _grid(stamps, [one.interval, *finest])
        if index is None:
            notes.append(f"values of {name} do not lie on its grid of {one.interval * 1e3:g} ms; it is left out")
            continue
        if step != one.interval:
            notes.append(f"values of {name} lie on a grid of {step * 1e3:g} ms, not of {one.interval * 1e3:g} ms")
        signal, present = _on_its_grid(name, one, stamps[0] + step * index, step, values[one.id], end, where)
        signals.append(signal)
        held += signal.values.size - present
        if one.points and signal.values.size != one.points:
            notes.append(f"{name} declares {one.points} points, the file gives {signal.values.size}")
    if not signals:
        raise InputError(notes[-1], where, "save the trace again at the control")
    if held:
        notes.append(f"{held} values are not written because they did not change, and are held")
    return Trace(NAME, tuple(signals), tuple(notes))


def _tag(element: Element) -> str:
    return element.tag.rsplit("}", 1)[-1]


def _declared(element: Element, where: str) -> _Declared:
    id_, name = element.get("id", ""), element.get("name", "")
    place = f"{where}, signal {name or id_}"
    interval = _number(element.get("interval", "0"), place)
    points = element.get("datapointCount", "")
    if not id_ or id_ == "time":
        raise InputError("a signal has no id", where, "save the trace again at the control")
    if not (math.isfinite(interval) and interval >= 0.0):
        raise InputError(f"the interval {interval:g} s is not possible", place, "save the trace again at the control")
    kind = _KINDS.get(element.get("unitsType", "").lower(), "")
    return _Declared(id_, name or id_, element.get("description", ""), interval,
                     int(points) if points.isdigit() and len(points) < 12 else 0, kind)  # fmt: skip


class _Records:
    """Times and values that the records of the first frame hold, by the id of their signal.

    A record is taken as it is parsed, sixteen bytes a value. Faults are kept until it is known which ids are signals.
    """

    def __init__(self, where: str) -> None:
        self._where = where
        self._frame = 0  # of which number it is, and how deep in it
        self._inside = False
        self._number, self._before = 0, -math.inf
        self._first: dict[str, int] = {}
        self._times: dict[str, array[float]] = {}
        self._values: dict[str, array[float]] = {}
        self._faults: dict[str, tuple[int, InputError]] = {}

    def takes(self, event: str, tag: str, attributes: dict[str, str]) -> bool:
        """Take a record of the first frame."""
        plain = tag.rsplit("}", 1)[-1]
        if plain == "dataFrame":
            self._frame += event == "start"
            self._inside = event == "start" and self._frame == 1
        if plain != "rec" or event == "end":
            return False
        if self._inside and "time" not in self._faults:
            self._take(attributes)
        return True

    def _take(self, attributes: dict[str, str]) -> None:
        self._number += 1
        place = f"{self._where}, record {self._number}"
        try:
            at = _number(attributes.get("time", ""), place)
            if not at >= self._before or not math.isfinite(at):
                raise InputError("the time does not increase", place, "save the trace again at the control")
        except InputError as error:
            self._faults["time"] = self._number, error
            return
        self._before = at
        for key, written in attributes.items():
            if key == "time" or key in self._faults:
                continue
            if key not in self._first:
                self._first[key] = self._number
                self._times[key], self._values[key] = array("d"), array("d")
            try:
                value = _number(written, place)
                if self._times[key] and self._times[key][-1] == at:
                    raise InputError(
                        f'"{key}" has two values at one time', place, "save the trace again at the control"
                    )
            except InputError as error:
                self._faults[key] = self._number, error
                continue
            if value < _NOTHING:
                self._times[key].append(at)
                self._values[key].append(value)

    def present(self, ids: set[str]) -> tuple[dict[str, FloatArray], dict[str, FloatArray]]:
        """Return times [s] and values of the signals of these ids, (n,) each.

        Raises:
            InputError: a time that runs back, a value that is no number or of no signal; the first of them.
        """
        faults = [fault for key, fault in self._faults.items() if key in ids or key == "time"]
        kinds = {id_.rstrip("0123456789") for id_ in ids}
        for key, number in self._first.items():
            if key not in ids and key.rstrip("0123456789") in kinds:
                what, place = f'a value of the unknown signal "{key}"', f"{self._where}, record {number}"
                faults.append((number, InputError(what, place, "save the trace again at the control")))
        if faults:
            raise min(faults, key=lambda fault: fault[0])[1]
        if not self._number:
            raise InputError("the trace holds no record", self._where, "save it with its data at the control")
        of_id = [
            {key: np.array(one.pop(key, ()), dtype=np.float64) for key in ids} for one in (self._times, self._values)
        ]
        return of_id[0], of_id[1]


def _number(written: str, place: str) -> float:
    plain = written.strip().lower()
    if plain in ("true", "false"):
        return float(plain == "true")
    try:
        return float(plain.replace(",", "."))
    except ValueError:
        shown = clean(written)
        raise InputError(f'"{shown}" is not a number', place, "save the trace again at the control") from None


def _grid(stamps: FloatArray, steps: list[float]) -> tuple[FloatArray | None, float]:
    """Return the places of stamps, (n,), on the first grid that they lie on, and its step [s]; None if on no grid.

    A bit of the PLC is written when it changes, in a cycle that may be finer than the one that is declared for it.
    """
    for step in steps:
        if step > 0.0:
            places = (stamps - stamps[0]) / step
            index = np.round(places)
            if np.max(np.abs(places - index)) <= _OFF_GRID * max(1.0, 1e-3 / step) and np.all(np.diff(index) >= 1):
                return index, step
    return None, 0.0


def _on_its_grid(
    name: str, one: _Declared, stamps: FloatArray, step: float, values: FloatArray, end: float, where: str
) -> tuple[Signal, int]:
    """Return a signal on its own grid, the last value held, and how many of its points are written."""
    index = np.round((stamps - stamps[0]) / step)
    until_end = (end - stamps[0]) / step + _OFF_GRID + 1.0
    if until_end > _MOST_POINTS:
        raise InputError(f"{name} would have {until_end:.3g} points", where, "save a shorter trace")
    # The last points are not written either where nothing changes any more; the count and the end tell of them.
    count = max(int(index[-1]) + 1, min(one.points or int(until_end), int(until_end)))
    last = np.searchsorted(index, np.arange(count), side="right") - 1
    time: FloatArray = np.round((stamps[0] + step * np.arange(count)) * 1e9) / 1e9
    axis = re.search(r"\[\s*u?\d+\s*,\s*(\d+)\s*\]", one.name)
    held = values[last]
    return Signal(name, time, held, "", axis[1] if axis else "", one.about, one.kind), len(values)
