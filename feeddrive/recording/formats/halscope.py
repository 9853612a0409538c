"""LinuxCNC halscope, both generations, and halsampler. None of them writes units; halsampler not even names or times.

| writer | first line | rows |
|---|---|---|
| halscope to 2.9 | `Sampling period is 100000 nSec` | `name value name value ...`, decimal sign of the locale |
| halscope later | `# Sampling period is 100000 ns` | `value;value;...`, names in the row above |
| halsampler | none | values divided by blanks; with -t the number of the sample first; `overrun` for a lost stretch |

Source: LinuxCNC, src/hal/utils/scope_files.c; docs/src/man/man1/halsampler.1.adoc.
"""

from __future__ import annotations

import re
from itertools import pairwise

import numpy as np

from feeddrive.errors import InputError
from feeddrive.recording.traces.lines import Lines
from feeddrive.recording.traces.naming import axis_in
from feeddrive.recording.traces.trace import Signal, Trace, clean, number_rows, unique_names
from feeddrive.typing import FloatArray, IntegerArray

NAME, SAMPLER = "halscope log", "halsampler output"
_PERIOD = re.compile(r"\s*(?:#\s*)?Sampling period is\s+(\d{1,12})\s*n", re.IGNORECASE)
_OVERRUN = "overrun"
_FEWEST = 3  # lines of numbers without any word by which halsampler's output is known


def recognises(head: str) -> bool:
    """Tell by its first letters whether a text was written by halscope."""
    return _PERIOD.match(head.lstrip("\ufeff")) is not None


def recognises_sampler(head: str) -> bool:
    """Tell by its first letters whether a text was written by halsampler: numbers between blanks, and nothing else."""
    if "\t" in head[:4000]:
        return False
    lines = [line.split() for line in head.split("\n")[:40] if line.strip()]
    lines = lines[:-1] if len(head) >= 60_000 else lines
    rows = [cells for cells in lines if " ".join(cells).lower() != _OVERRUN]
    if len(rows) < _FEWEST or (len(rows[0]) < 2 and [_OVERRUN] not in lines):
        return False
    return all(len(cells) == len(rows[0]) and all(map(_is_plain, cells)) for cells in rows[:_FEWEST])


def read(text: str, where: str) -> Trace:
    """Read a log of halscope.

    Raises:
        InputError: no names, rows that do not fit them.
    """
    lines = Lines(text.lstrip("\ufeff"))
    match = _PERIOD.match(lines[0])
    period = int(match[1]) * 1e-9 if match else 0.0
    if not period > 0.0:
        raise InputError("the sampling period is not above zero", f"{where}, row 1", "save the log again")
    if lines[0].lstrip().startswith("#"):
        names, values, notes = _new(lines, where)
    else:
        names, values, notes = _old(lines, where)
    if all("." not in name for name in names):
        notes = (*notes, "the names are no HAL pins or signals that tell a joint")
    time: FloatArray = np.arange(values.shape[0], dtype=np.float64) * period
    plain = unique_names(names)
    signals = tuple(
        Signal(name, time, np.ascontiguousarray(values[:, i]), "", axis_in(name)) for i, name in enumerate(plain)
    )
    return Trace(NAME, signals, notes)


def _new(lines: Lines, where: str) -> tuple[list[str], FloatArray, tuple[str, ...]]:
    """Read names and values divided by semicolons."""
    at = next((i for i, line in enumerate(lines) if line.strip() and not line.lstrip().startswith("#")), None)
    if at is None:
        raise InputError("the log holds no names", where, "save it again")
    mark = next((one for one in ";\t," if one in lines[at]), ";")  # a table program may have written it again
    names = [name.strip() for name in lines[at].split(mark)]
    while names and not names[-1]:
        names.pop()
    if not names or all(map(_is_plain, names)):
        raise InputError("the row of names is missing", f"{where}, row {at + 1}", "save the log again")

    def split(line: str) -> list[str]:
        cells = [cell.strip().replace(",", ".") for cell in line.split(mark)]
        return cells[:-1] if len(cells) == len(names) + 1 and not cells[-1] else cells

    first = at + 1
    while first < len(lines) and lines[first].lstrip().startswith("#"):  # how it was drawn: # Position, # Scale
        first += 1
    separator = "" if mark != "," and any("," in line for line in lines[first : first + 20]) else mark
    values, notes = number_rows(lines[first:], split, len(names), first + 1, where, separator=separator)
    return names, values, notes


def _old(lines: Lines, where: str) -> tuple[list[str], FloatArray, tuple[str, ...]]:
    """Read rows in which names and values alternate; a name may come twice, and the decimal sign is the locale's."""
    at = next((i for i in range(1, len(lines)) if lines[i].strip()), None)
    if at is None:
        raise InputError("the log holds no rows", where, "save it again")
    names = lines[at].split()[0::2]
    comma = "," in lines[at]

    def split(line: str) -> list[str]:
        words = line.split()
        if words[0::2] != names or len(words) != 2 * len(names):
            return words  # of another number than the values, which is reported
        return [word.replace(",", ".") for word in words[1::2]]

    if len(lines[at].split()) != 2 * len(names) or any(map(_is_plain, names)):
        raise InputError("names and values do not alternate", f"{where}, row {at + 1}", "save the log again")
    values, notes = number_rows(lines[at:], lambda line: _wide(split(line), len(names)), len(names), at + 1, where)
    if comma:
        notes = (*notes, "the comma is read as the decimal sign")
    if _jumps_at_the_end(values):
        values = values[:-1]
        notes = (*notes, "the last row is no sample: halscope writes one row behind the end of its memory; left out")
    return names, values, notes


def _jumps_at_the_end(values: FloatArray) -> bool:
    """Tell whether the last step of any column is larger than twice all others together with their range."""
    if values.shape[0] < 10:
        return False
    steps = np.abs(np.diff(values, axis=0))
    return bool(np.any(steps[-1] > 2.0 * np.max(steps[:-1], axis=0) + np.ptp(values[:-1], axis=0)))


def _wide(cells: list[str], width: int) -> list[str]:
    """Make cells that are no values fail by their number, also where there are as many by chance."""
    return [*cells, ""] if len(cells) == width and not all(map(_is_plain, cells)) else cells


def read_sampler(text: str, where: str, sample_time: float | None, columns: tuple[str, ...]) -> Trace:
    """Read the output of halsampler.

    Args:
        text: content of the file.
        where: file name.
        sample_time: [s]; None where the person did not say it.
        columns: names of the columns; numbered where there are none.

    Raises:
        InputError: rows of different lengths, columns that do not fit, sample numbers that run back.
    """
    lines = Lines(text.lstrip("\ufeff"))
    losses: list[int] = []
    odd: list[int] = []  # lines that hold no numbers
    for number, line in enumerate(lines):
        word = line.strip().lower()
        losses += [number - len(odd)] if word == _OVERRUN else []
        odd += [number] if word in ("", _OVERRUN) else []
    first = odd[0] if odd else len(lines)
    at_end = first + len(odd) == len(lines)  # blank lines alone, as any file has
    kept = lines[:first] if at_end else [line for line in lines if line.strip().lower() not in ("", _OVERRUN)]
    rows = np.setdiff1d(np.arange(len(lines)), odd) + 1
    cells = kept[0].replace(",", ".").split()
    values, notes = number_rows(
        kept,
        lambda line: [cell.replace(",", ".") for cell in line.split()],
        len(cells),
        1,
        where,
        separator="" if "," in kept[0] else None,
    )
    count = values[:, 0]
    numbered = len(cells) > 1 and bool(
        np.all(count == np.round(count)) and np.all(np.diff(count) >= 1) and np.mean(np.diff(count) == 1) > 0.5
    )
    data = values[:, 1:] if numbered else values
    names = _columns(columns, data.shape[1], numbered, where)
    place: FloatArray = count - count[0] if numbered else np.arange(values.shape[0], dtype=np.float64)
    notes = (*notes, *_losses(losses, place, rows, numbered))
    if losses and not numbered:
        data, place, note = _longest(data, place, losses)
        notes = (*notes, note)
    time = place * (sample_time or 1.0)
    timed = sample_time is not None
    signals = tuple(
        Signal(name, time, np.ascontiguousarray(data[:, i]), "", axis_in(name), timed=timed)
        for i, name in enumerate(names)
    )
    return Trace(SAMPLER, signals, notes)


def _columns(columns: tuple[str, ...], width: int, numbered: bool, where: str) -> list[str]:
    if not columns:
        return [f"column {i + 1 + numbered}" for i in range(width)]
    if len(columns) != width:
        what = f"{len(columns)} names for {width} columns of values"
        behind = " behind the number of the sample" if numbered else ""
        raise InputError(what, where, f"name every column{behind} by --columns")
    return unique_names([clean(name) for name in columns])


def _losses(losses: list[int], place: FloatArray, rows: IntegerArray, numbered: bool) -> tuple[str, ...]:
    if not losses:
        return ()
    row = rows[losses[0]] if losses[0] < len(rows) else rows[-1]
    how = "its length is told by the sample numbers" if numbered else "its length is not known"
    return (f"{len(losses)} overruns: a stretch was lost before row {row}; {how}",)


def _longest(data: FloatArray, place: FloatArray, losses: list[int]) -> tuple[FloatArray, FloatArray, str]:
    """Return the longest stretch between overruns of unknown length."""
    edges = sorted({0, *losses, data.shape[0]})
    first, last = max(pairwise(edges), key=lambda pair: pair[1] - pair[0])
    note = f"rows {first + 1} to {last} of the numbers, the longest stretch without an overrun, are read"
    return data[first:last], place[first:last] - place[first], note


def _is_plain(cell: str) -> bool:
    return re.fullmatch(r"[+-]?(?:nan|inf|\d+[.,]?\d*|[.,]\d+)(?:[eE][+-]?\d+)?", cell) is not None
