"""Heidenhain TNCscope, `.sco`: a header of `%KEY=value` lines, then rows divided by `;` with the time in µs first.

The time is column 1. `%CYCLETIME` of a curve is the cycle that the control computes it in, not that of its rows.
Layout measured on files of an iTNC 530 (TNCscopeNT, version 2.0).
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field

import numpy as np

from feeddrive.errors import InputError
from feeddrive.recording.traces.lines import Lines
from feeddrive.recording.traces.trace import Signal, Trace, clean, number_rows, unique_names
from feeddrive.typing import FloatArray

NAME = "TNCscope trace"


def recognises(head: str) -> bool:
    """Tell by its first letters whether a text is such a trace."""
    first = head.lstrip("\ufeff \n\t")[:400].upper()
    return first.startswith("%") and ("TNCSCOPE" in first or "%[GLOBAL]" in first or "%[CURVE" in first)


@dataclass
class _Curve:
    """What the header says of a curve."""

    number: int
    keys: dict[str, str] = field(default_factory=dict)


def read(text: str, where: str) -> Trace:
    """Read a trace.

    Raises:
        InputError: no curves, no data, rows that do not fit the curves, a time that does not increase.
    """
    lines = Lines(text)
    curves, first, keys = _header(lines, where)
    columns = [_column(curve, where) for curve in curves]
    if sorted(columns) == list(range(3, len(curves) + 3)):  # counted with the time
        columns = [column - 1 for column in columns]
    if len(set(columns)) < len(columns):
        raise InputError("two curves stand in one column", where, "export it again from TNCscope")
    width = max([len(curves) + 1, *(column for column in columns)])
    comma = any("," in line for line in lines[first : first + 20])

    def split(line: str) -> list[str]:
        cells = [cell.strip() for cell in (line.replace(",", ".") if comma else line).split(";")]
        if cells and not cells[-1]:  # rows end with a separator
            cells.pop()
        return cells

    separator = "" if comma else ";"
    values, notes = number_rows(lines[first:], split, width, first + 1, where, separator=separator)
    stamps = values[:, 0]
    bad = np.flatnonzero(~(np.diff(stamps) > 0.0))
    if bad.size:
        place = f"{where}, row {first + 2 + int(bad[0])}"
        raise InputError("the time, column 1, does not increase", place, "export one recording to a file")
    time = stamps / 1e6
    names = unique_names([_name(curve) for curve in curves])
    signals = tuple(
        Signal(name, time, np.ascontiguousarray(values[:, column - 1]), _unit(curve), _axis(curve),
               clean(f"{curve.keys.get('CHANNELTYPE', '')} {curve.keys.get('DIMENSION', '')}"))
        for name, curve, column in zip(names, curves, columns, strict=True)
    )  # fmt: skip
    notes = (*_control(keys), *notes, *_counts(curves, names, stamps.size), *_cycles(curves, names, time))
    return Trace(NAME, signals, notes)


def _header(lines: Lines, where: str) -> tuple[list[_Curve], int, dict[str, str]]:
    """Return the curves, the index of the first row of data, and the keys of the recording."""
    curves: list[_Curve] = []
    keys: dict[str, str] = {}
    section = ""
    for index, line in enumerate(lines):
        plain = line.strip()
        if plain.upper() == "%[DATA]":
            section = "DATA"
        elif section == "DATA" and plain and not plain.startswith("%"):
            if not curves:
                break
            return curves, index, keys
        elif match := re.fullmatch(r"%\[([A-Z_ ]+?)(\d*)\]", plain.upper()):
            section = match[1]
            if section == "CURVE":
                curves.append(_Curve(int(match[2] or len(curves) + 1)))
        elif match := re.fullmatch(r"%([A-Za-z_]+)\s*=\s*(.*)", plain):
            into = curves[-1].keys if section == "CURVE" else keys
            into.setdefault(match[1].upper(), match[2].strip())
    what = "the header names no curve" if not curves else "there is a header and no row of data"
    raise InputError(what, where, "export it again from TNCscope")


def _column(curve: _Curve, where: str) -> int:
    """Return the column of a curve, 1 for the first, which is the time; %COLUMN counts the curves from 1."""
    written = curve.keys.get("COLUMN", "")
    number = int(written) if written.isdigit() else curve.number
    if not 1 <= number <= 1000:
        raise InputError(f"column {written} of a curve is not possible", where, "export it again from TNCscope")
    return number + 1


def _name(curve: _Curve) -> str:
    return curve.keys.get("NAME") or curve.keys.get("CHANNELTYPE") or f"curve {curve.number}"


def _unit(curve: _Curve) -> str:
    """Return the dimension; `id(10)` is the number of a debug channel, not a unit."""
    written = curve.keys.get("DIMENSION", "").strip()
    return "" if re.fullmatch(r"id\(\d+\)", written) else written


def _axis(curve: _Curve) -> str:
    return curve.keys.get("AXISTYPE", "").strip()


def _control(keys: dict[str, str]) -> list[str]:
    control = " ".join(keys[key] for key in ("CONTROL", "NCVERSION") if keys.get(key))
    return [f"recorded by {control}"] if control else []


def _counts(curves: list[_Curve], names: list[str], rows: int) -> list[str]:
    """Say curves that declare another number of values than the file holds."""
    declared = [
        (name, int(curve.keys["COUNT"]))
        for name, curve in zip(names, curves, strict=True)
        if curve.keys.get("COUNT", "").isdigit()
    ]
    return [f"{name} declares {count} values, the file holds {rows}" for name, count in declared if count > rows][:1]


def _cycles(curves: list[_Curve], names: list[str], time: FloatArray) -> list[str]:
    """Say curves whose cycle is not the distance of the rows: the time stands in the rows."""
    if time.size < 2:
        return []
    step = float(np.median(np.diff(time))) * 1e6
    written = [(name, curve.keys.get("CYCLETIME", "")) for name, curve in zip(names, curves, strict=True)]
    other = [(name, cycle) for name, cycle in written if cycle.isdigit() and abs(int(cycle) - step) > 0.01 * step]
    return [f"{name} is computed every {cycle} µs and stands in rows every {step:g} µs" for name, cycle in other]
