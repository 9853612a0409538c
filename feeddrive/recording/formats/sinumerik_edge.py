"""SINUMERIK Edge / Analyze MyWorkpiece Capture: JSON, and the `*_hfdata.csv` tables made of it.

`CYCLE` counts the interpolator cycles and is the clock: rows are not, since a capture loses stretches without a sign.
Signals are called NAME|axis number; `Axis` gives the machine's name of the axis. There is no unit anywhere.
"""

from __future__ import annotations

import json
import re
from collections.abc import Mapping, Sequence
from datetime import datetime
from typing import Any

import numpy as np

from feeddrive.errors import InputError
from feeddrive.recording.traces.lines import Lines
from feeddrive.recording.traces.naming import known_unit
from feeddrive.recording.traces.trace import Signal, Trace, number_rows, unique_names
from feeddrive.typing import FloatArray

NAME = "SINUMERIK Edge capture"
CYCLE = 2e-3
"""Cycle [s] of captures that do not say theirs; Edge writes CycleTimeMs = 2."""
_CLOCK = "CYCLE"
_KINDS = {"DES_POS": "position", "ENC_POS": "position", "ENC1_POS": "position", "ENC2_POS": "position",
          "CTRL_POS": "position", "CTRL_DIFF": "position", "CTRL_DIFF2": "position", "CONT_DEV": "position",
          "TORQUE": "torque", "TORQUE_FFW": "torque", "CURRENT": "current", "POWER": "power"}  # fmt: skip


def recognises(head: str) -> bool:
    """Tell by its first letters whether a text is a capture in JSON."""
    return head.lstrip("\ufeff \n\t[").startswith("{") and any(
        mark in head for mark in ('"SignalListHFData"', '"HFData"', '"CycleTimeMs"', '"Header"')
    )


def recognises_table(head: str) -> bool:
    """Tell by its first letters whether a text is a table made of a capture."""
    return is_capture(_split(head.lstrip("\ufeff").split("\n", 1)[0]))


def read(text: str, where: str, sample_time: float | None = None) -> Trace:
    """Read a capture in JSON; a person may say the sample time of a cycle [s].

    Raises InputError: not whole JSON, no rows, rows that do not fit the list of signals, a clock that runs back.
    """
    try:
        tree = _parsed(text)
    except (ValueError, RecursionError) as error:
        place = f"{where}, line {error.lineno}" if isinstance(error, json.JSONDecodeError) else where
        raise InputError("is not whole JSON", place, "copy or record it again") from None
    if isinstance(tree, list) and len(tree) > 1 and all(isinstance(one, Mapping) and "Header" in one for one in tree):
        raise InputError(f"holds {len(tree)} captures", where, "save each in a file of its own")
    tree = tree[0] if isinstance(tree, list) and len(tree) == 1 else tree
    header = tree.get("Header") if isinstance(tree, Mapping) else None
    listed = header.get("SignalListHFData") if isinstance(header, Mapping) else None
    payload = tree.get("Payload") if isinstance(tree, Mapping) else None
    if not isinstance(listed, list) or not isinstance(payload, list) or not isinstance(header, Mapping):
        raise InputError(
            "is JSON, but not a capture: Header.SignalListHFData or Payload is missing",
            where,
            "name a file of SINUMERIK Edge, or save the table as CSV",
        )
    names, axes = zip(*map(_named, listed), strict=True) if listed else ((), ())
    tables = [item["HFData"] for item in payload if isinstance(item, Mapping) and "HFData" in item]
    values = _table(
        [_numbers(_list(one)) if not isinstance(one, np.ndarray) else one for one in tables], len(names), where
    )
    cycle, remarks = _cycle(_milliseconds(header.get("CycleTimeMs"), where), sample_time, where)
    trace = _trace(list(names), list(axes), values, cycle, remarks, where, "row of HFData")
    stamps = [item["HFTimestamp"] for item in payload if isinstance(item, Mapping) and "HFTimestamp" in item]
    return Trace(
        trace.format, trace.signals, (*trace.notes, *_adapter_clock(stamps, values[:, names.index(_CLOCK)], cycle))
    )


def _named(signal: Any) -> tuple[str, str]:
    """Return name, as NAME|number, and axis of a listed signal; some captures write it as the address alone."""
    listed = (
        {str(key).lower(): str(value or "") for key, value in signal.items()} if isinstance(signal, Mapping) else {}
    )
    name, address = listed.get("name", ""), listed.get("address", "")
    if address == _CLOCK or ("|" in address and "|" not in name):
        name = address
    number = name.rsplit("|", 1)[-1] if "|" in name else ""
    return name, listed.get("axis") or number


def _milliseconds(written: Any, where: str) -> float | None:
    """Return the cycle time [s] of a header, None where it holds none."""
    if written is None:
        return None
    try:
        return float(written) / 1e3
    except (TypeError, ValueError):
        raise InputError("CycleTimeMs is not a number", where, "give the cycle by --sample-time") from None


def is_capture(names: Sequence[str]) -> bool:
    """Tell by the names of its columns whether a table was made of a capture."""
    return _CLOCK in names and any("|" in name for name in names)


def capture_of(columns: Mapping[str, FloatArray], where: str, sample_time: float | None) -> Trace:
    """Return the trace of a table made of a capture: name -> (n,).

    Raises:
        InputError: as `read_table`.
    """
    names = [name for name in columns if name == _CLOCK or "|" in name]
    cycle, remarks = _cycle(None, sample_time, where)
    axes = [name.rsplit("|", 1)[-1] if "|" in name else "" for name in names]
    return _trace(names, axes, np.column_stack([columns[name] for name in names]), cycle, remarks, where, "row")


def read_table(text: str, where: str, sample_time: float | None = None) -> Trace:
    """Read a table made of a capture, as `read`.

    Raises:
        InputError: rows that do not fit the header, a clock that runs back.
    """
    lines = Lines(text.lstrip("\ufeff"))
    separator = _separator(lines[0])
    names = _split(lines[0])
    while names and not names[-1]:
        names.pop()
    written = [re.fullmatch(r"(.*?)\s*[\[(](.*)[\])]", name) for name in names]
    units = [match[2] if match else "" for match in written]
    names = [match[1] if match else name for name, match in zip(names, written, strict=True)]
    begin = 1
    below = _split(lines[1], separator) if len(lines) > 1 else []
    if len(below) >= len(names) and all(
        name != _CLOCK or _is_word(cell) for name, cell in zip(names, below, strict=False)
    ):
        units, begin = below, 2
    comma = separator == ";" and lines[begin:].first_with(",") is not None

    def split(line: str) -> list[str]:
        cells = [cell.strip().strip('"') for cell in (line.replace(",", ".") if comma else line).split(separator)]
        return cells[: len(names)] if len(cells) == len(names) + 1 and not cells[-1] else cells

    kept = [i for i, name in enumerate(names) if name == _CLOCK or "|" in name]

    def split_kept(line: str) -> list[str]:
        cells = split(line)
        return [cells[i] for i in kept] if len(cells) == len(names) else cells

    if len(kept) == len(names):
        fast = "" if comma else separator
        values, notes = number_rows(lines[begin:], split, len(names), begin + 1, where, gaps=True, separator=fast)
    else:
        # A row of another length is reported with all its cells: it does not reach the width of those that are kept.
        values, notes = number_rows(
            lines[begin:], lambda line: _as_wide(split_kept(line), len(kept)), len(kept), begin + 1, where, True
        )
        left = ", ".join(names[i] or f"column {i + 1}" for i in range(len(names)) if i not in kept)
        notes = (*notes, f"not signals of the capture and left out: {left}")
    cycle, remarks = _cycle(None, sample_time, where)
    chosen = [names[i] for i in kept]
    axes = [name.rsplit("|", 1)[-1] if "|" in name else "" for name in chosen]
    own = [units[i] if known_unit(units[i]) else "" for i in kept]
    return _trace(chosen, axes, values, cycle, (*remarks, *notes), where, "row", begin + 1, own)


def _is_word(cell: str) -> bool:
    """Tell whether a cell below the clock is no count: a row of units is laid under the names."""
    return re.fullmatch(r"[A-Za-z\[(]?[A-Za-z \])]*", cell) is not None


def _as_wide(cells: list[str], width: int) -> list[str]:
    return cells if len(cells) == width else [*cells, *[""] * (width + 1)]


def _separator(line: str) -> str:
    return max(",;\t", key=line.count)


def _split(line: str, separator: str = "") -> list[str]:
    return [cell.strip().strip('"') for cell in line.split(separator or _separator(line))]


def _list(value: Any) -> list[Any]:
    return value if isinstance(value, list) else []


_PAYLOAD, _SPACE = re.compile(r'"Payload"\s*:\s*\['), re.compile(r"\s*")
_Rows = FloatArray | list[Any]
"""Numbers, (n, k), or what stands there in place of them."""


def _parsed(text: str) -> Any:
    """The tree of a capture, its rows as numbers: the payload is read item by item, since objects take five times that.

    Raises:
        ValueError, RecursionError: not whole JSON.
    """
    found = _PAYLOAD.search(text)
    if found is None:
        return json.loads(text)
    items: list[Any] = []
    begin, at = found.end(), _behind(text, found.end())
    while text[at : at + 1] != "]" or items:
        item, at = json.JSONDecoder().raw_decode(text, at)
        if isinstance(item, dict):
            item["HFData"] = _numbers(_list(item.get("HFData")))
        items.append(item)
        at = _behind(text, at)
        if text[at : at + 1] == "]":
            break
        if text[at : at + 1] != ",":
            raise json.JSONDecodeError("Expecting ',' delimiter", text, at)
        at = _behind(text, at + 1)
    try:
        tree = json.loads(text[:begin] + text[at:])
    except json.JSONDecodeError as error:
        raise json.JSONDecodeError(error.msg, text, error.pos + (at - begin if error.pos >= begin else 0)) from None
    top = tree[0] if isinstance(tree, list) and len(tree) == 1 else tree
    if not isinstance(top, dict) or top.get("Payload") != []:  # the word stood elsewhere
        return json.loads(text)
    top["Payload"] = items
    return tree


def _behind(text: str, at: int) -> int:
    """The place behind blanks."""
    blanks = _SPACE.match(text, at)
    return at if blanks is None else blanks.end()


def _numbers(rows: list[Any]) -> _Rows:
    """Rows as numbers, where they are rows of one length that are."""
    if not rows or not all(isinstance(row, list) and len(row) == len(rows[0]) for row in rows):
        return rows
    try:
        return np.array([[np.nan if cell is None else cell for cell in row] for row in rows], dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        return rows


def _table(tables: Sequence[_Rows], width: int, where: str) -> FloatArray:
    number = 1
    for rows in tables:
        for row in rows if not isinstance(rows, np.ndarray) or rows.shape[1] != width else ():
            if isinstance(rows, np.ndarray) or not isinstance(row, list) or len(row) != width:
                count = len(row) if isinstance(row, list | np.ndarray) else 0
                what = f"the row has {count} values, the header names {width} signals"
                raise InputError(what, f"{where}, row {number} of HFData", "record again")
            number += 1
        if not isinstance(rows, np.ndarray) and rows:
            raise InputError("a value of HFData is not a number", where, "record again")
        number += len(rows) if isinstance(rows, np.ndarray) else 0
    known = [rows for rows in tables if isinstance(rows, np.ndarray)]
    if not known:
        raise InputError("the capture holds no row of HFData", where, "record again")
    return np.concatenate(known)


def _cycle(in_file: float | None, wanted: float | None, where: str) -> tuple[float, tuple[str, ...]]:
    """Return the cycle time [s], and how it is known."""
    if wanted is not None:
        return wanted, (f"a cycle of {wanted * 1e3:g} ms, as given",)
    if in_file is None:
        return CYCLE, (f"a cycle of {CYCLE * 1e3:g} ms assumed, as Edge writes it; another by --sample-time",)
    if not 1e-5 <= in_file <= 10.0:
        raise InputError(f"a cycle of {in_file * 1e3:g} ms is not possible", where, "give it by --sample-time")
    return in_file, ()


def _trace(
    names: list[str],
    axes: list[str],
    values: FloatArray,
    cycle: float,
    notes: tuple[str, ...],
    where: str,
    row: str,
    first_row: int = 1,
    units: Sequence[str] = (),
) -> Trace:
    if names.count(_CLOCK) != 1:
        raise InputError(f"there is no signal {_CLOCK}, which is the clock", where, f"record it with {_CLOCK}")
    clock = values[:, names.index(_CLOCK)]
    if not np.all(np.isfinite(clock)):
        bad = int(np.flatnonzero(~np.isfinite(clock))[0])
        raise InputError(f"{_CLOCK} is not a number", f"{where}, {row} {bad + first_row}", "remove the row")
    again = np.flatnonzero(np.diff(clock) == 0.0) + 1
    again = again[[np.array_equal(values[i], values[i - 1], equal_nan=True) for i in again]] if again.size else again
    if again.size:
        values, clock = np.delete(values, again, axis=0), np.delete(clock, again)
        notes = (*notes, f"{again.size} rows are there twice and used once")
    back = np.flatnonzero(np.diff(clock) <= 0.0)
    if back.size:
        place = f"{where}, {row} {int(back[0]) + 1 + first_row}"
        raise InputError(f"{_CLOCK} does not increase", place, "use one capture to a file")
    time: FloatArray = (clock - clock[0]) * cycle
    plain = unique_names(names)
    signals = []
    for index, name in enumerate(plain):
        if names[index] == _CLOCK:
            continue
        kind = _KINDS.get(names[index].split("|")[0], "")
        there = np.isfinite(values[:, index])
        if not there.all():
            notes = (*notes, f"{name} lacks {int(np.sum(~there))} values")
        own = time if there.all() else time[there]
        unit = units[index] if units else ""
        signals.append(Signal(name, own, values[there, index], unit, axes[index], "", kind))
    return Trace(NAME, tuple(signal for signal in signals if signal.values.size), notes)


def _adapter_clock(stamps: Sequence[Any], clock: FloatArray, cycle: float) -> tuple[str, ...]:
    """Say by how much the clock of the adapter runs beside that of the control, where its stamps resolve it.

    Across a lost stretch its stamps jump, so each stretch between them has its own zero.
    """
    pairs = []
    for stamp in stamps:
        try:
            at = datetime.fromisoformat(str(stamp["Time"]).replace("Z", "+00:00")).timestamp()
            pairs.append((float(stamp["HFProbeCounter"]), at))
        except (KeyError, TypeError, ValueError, OverflowError):
            continue
    if not pairs or not np.all(np.isfinite(pairs)):
        return ()
    counted, stated = np.array(pairs).T
    lost = clock[:-1][np.diff(clock) > 1.5]
    stretch = np.searchsorted(lost, counted)
    spread, late = counted * cycle, stated - stated[0]
    for part in np.unique(stretch):
        inside = stretch == part
        spread[inside] -= spread[inside].mean()
        late[inside] -= late[inside].mean()
    power, freedom = float(spread @ spread), counted.size - np.unique(stretch).size - 1
    if power == 0.0 or freedom < 8:
        return ()
    slope = float(spread @ late) / power
    rest = late - slope * spread
    deviation = float(np.sqrt(rest @ rest / freedom / power))
    if abs(slope - 1.0) <= 3.0 * deviation:  # not resolved: the stamps are those of a network, to 1 ms
        return ()
    return (
        f"the adapter's clock runs {1e6 * (slope - 1.0):+.0f} ± {2e6 * deviation:.0f} ppm beside the control's; "
        "the control's is used",
    )
