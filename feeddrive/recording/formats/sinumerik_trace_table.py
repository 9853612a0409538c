"""SINUMERIK Operate trace saved as a table: `time` [s], then a column for each signal by its address.

The list separator of the table stands in the addresses too (`[u1, 1]`), so it is written there as `;` or a blank, and a
`+` may stand before them. Layout read off scripts that load such tables (columns `time`, `+/Nck/!SD/... [u1; 4]`).
Cells of a signal that was not sampled in a row are empty.
"""

from __future__ import annotations

import re

import numpy as np

from feeddrive.errors import InputError
from feeddrive.recording.formats.sinumerik_trace import NAME
from feeddrive.recording.traces.lines import Lines
from feeddrive.recording.traces.trace import Signal, Trace, number_rows, unique_names
from feeddrive.typing import FloatArray

_ADDRESS = re.compile(r"\+?/(?:Nck|Channel|Bag|Drive|Plc)/!?\w+/")
_MOST_ABOVE = 200  # lines above the names: one of its own for each signal in some exports
_KINDS = (("vel", "velocity"), ("pos", "position"), ("curr", "current"), ("torq", "torque"))


def recognises(head: str) -> bool:
    """Tell by its first letters whether a text is such a table."""
    if head.lstrip("\ufeff \n").startswith("<"):
        return False
    return any(_is_header(line) for line in head.split("\n")[:_MOST_ABOVE])


def read(text: str, where: str) -> Trace:
    """Read such a table.

    Raises:
        InputError: rows that do not fit the names, a time that does not increase.
    """
    lines = Lines(text.lstrip("\ufeff"))
    at = next(i for i in range(len(lines)) if _is_header(lines[i]))
    separator = _separator(lines[at])
    names = [name.strip().strip('"') for name in _cells(lines[at], separator)]
    while not names[-1]:
        names.pop()
    comma = separator != "," and lines[at + 1 :].first_with(",") is not None

    def split(line: str) -> list[str]:
        cells = [cell.strip().strip('"') for cell in (line.replace(",", ".") if comma else line).split(separator)]
        return cells[: len(names)] if len(cells) == len(names) + 1 and not cells[-1] else cells

    rows = lines[at + 1 :]
    values, notes = number_rows(rows, split, len(names), at + 2, where, gaps=True, separator="" if comma else separator)
    time: FloatArray = np.ascontiguousarray(values[:, 0])
    bad = np.flatnonzero(~(np.diff(time) > 0.0))
    if bad.size:
        place = f"{where}, row {at + 3 + int(bad[0])}"
        raise InputError("the time does not increase", place, "save one trace to a file")
    signals = []
    shared: dict[bytes, FloatArray] = {}
    for index, name in enumerate(unique_names([name.lstrip("+") for name in names])[1:], start=1):
        there = ~np.isnan(values[:, index])
        if np.sum(there) < 2:
            notes = (*notes, f"{name} has no values and is left out")
            continue
        stamps = time if there.all() else shared.setdefault(there.tobytes(), time[there])
        axis = re.search(r"\[\s*u?\d+\s*[,;]?\s*(\d+)\s*\]", name)
        kind = next((kind for word, kind in _KINDS if word in name.lower()), "")
        signals.append(Signal(name, stamps, values[there, index], "", axis[1] if axis else "", "", kind))
    return Trace(f"{NAME}, table", tuple(signals), notes)


def _is_header(line: str) -> bool:
    separator = _separator(line)
    cells = [cell.strip().strip('"') for cell in _cells(line, separator)]
    return len(cells) > 1 and cells[0].lower() in ("time", "time [s]", "zeit", "t") and any(map(_ADDRESS.match, cells))


def _separator(line: str) -> str:
    outside = re.sub(r"\[[^\]]*\]", "", line)
    return max(",;\t", key=outside.count)


def _cells(line: str, separator: str) -> list[str]:
    """Split a line at the separators that do not stand in brackets."""
    return re.split(rf"{re.escape(separator)}(?![^\[]*\])", line)
