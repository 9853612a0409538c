"""What every reader of a trace file returns: signals with their own times, before anything is taken for a channel."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np

from feeddrive.errors import InputError
from feeddrive.typing import FloatArray

_LONGEST_NAME = 120  # of a name that is shown; a damaged file can hold a megabyte of it


@dataclass(frozen=True, eq=False)
class Signal:
    """One signal of a trace file.

    Attributes:
        name: as the file writes it, without control characters; unique in its trace.
        time: time stamps of its own, (n,) [s], increasing; the same array object for signals sampled together.
        values: (n,), in `unit`.
        unit: as the file says it; empty where it does not.
        axis: machine axis that it belongs to, as the file names it; empty if the file names none.
        about: description in the file; empty if there is none.
        kind: class of the unit where the file gives no more than that (`position`, `velocity`, `current`, ...).
        timed: whether the file holds its times; if not, `time` counts samples, or sample times once one is given.
        lacks: why not, where the file holds stamps that cannot be used; empty otherwise.
    """

    name: str
    time: FloatArray
    values: FloatArray
    unit: str = ""
    axis: str = ""
    about: str = ""
    kind: str = ""
    timed: bool = True
    lacks: str = ""

    @property
    def step(self) -> float:
        """Usual distance of its samples [s]; 0 for fewer than two."""
        return float(np.median(np.diff(self.time))) if self.time.size > 1 else 0.0


@dataclass(frozen=True, eq=False)
class Trace:
    """Signals of one file.

    Attributes:
        format: what the file is, for people.
        signals: in the order of the file.
        notes: what was found and assumed on reading.
    """

    format: str
    signals: tuple[Signal, ...]
    notes: tuple[str, ...] = field(default=())

    @property
    def axes(self) -> tuple[str, ...]:
        """Axes in the order in which they come, each once; without the empty one."""
        return tuple(dict.fromkeys(signal.axis for signal in self.signals if signal.axis))


def clean(text: str) -> str:
    """Return a name of a file fit for a terminal: no control characters, no line ends, no more than 120 letters."""
    kept = "".join(letter if letter.isprintable() else "?" for letter in text.strip())
    return kept if len(kept) <= _LONGEST_NAME else kept[: _LONGEST_NAME - 1] + "…"


def unique_names(names: Sequence[str]) -> list[str]:
    """Return cleaned names, each once: a name that comes again is numbered as in `speed (2)`."""
    taken: set[str] = set()
    found = []
    for number, given in enumerate(names, start=1):
        plain = clean(given) or f"signal {number}"
        name, count = plain, 2
        while name in taken:
            name, count = f"{plain} ({count})", count + 1
        taken.add(name)
        found.append(name)
    return found


_CHUNK = 20_000  # rows that are held as split text at a time


def number_rows(
    lines: Sequence[str],
    split: Callable[[str], list[str]],
    width: int,
    first_row: int,
    where: str,
    gaps: bool = False,
    separator: str | None = "",
) -> tuple[FloatArray, tuple[str, ...]]:
    """Return the numbers of lines, (rows, width), each column in one piece, and remarks.

    Args:
        lines: rows of numbers; blank ones at the end are passed over.
        split: a line into its cells.
        width: cells of a row.
        first_row: row in the file of lines[0], for messages.
        where: file name.
        gaps: whether an empty cell is allowed and read as NaN.
        separator: of the cells, None for blanks, where `split` does no more than divide by it and drop an empty last
            cell: such rows are read fast as long as they are whole.

    Raises:
        InputError: a row with other cells, or a cell that is no number; not for the last row, which is left out.
    """
    last = len(lines)
    while last and not lines[last - 1].strip():
        last -= 1
    if not last:
        raise InputError("there is no row of numbers", where, "record again or name another file")
    notes: tuple[str, ...] = ()
    numbers = np.empty((last, width), order="F")
    for start in range(0, last, _CHUNK):
        part = lines[start : min(start + _CHUNK, last)]
        whole = whole_rows(part, separator, width) if separator != "" else None
        if whole is None:
            rows = [split(line) for line in part]
            if start + _CHUNK >= last and last > 1 and _fault(rows[-1], width, gaps):
                rows.pop()
                notes = ("the last row is cut short and left out",)
            whole = _numbers(rows, width, first_row + start, where, gaps) if rows else np.empty((0, width))
        numbers[start : start + len(whole)] = whole
    return numbers[: last - len(notes)], notes


def whole_rows(lines: Sequence[str], separator: str | None, width: int) -> FloatArray | None:
    """Return the numbers of lines, (rows, width), in one go; None where a line is not whole, whatever the reason.

    Args:
        lines: rows of numbers with decimal points.
        separator: of the cells; None for blanks. One at the end of each line is passed over.
        width: cells of a row.
    """
    if not lines or not lines[0].strip():  # numpy warns where there is nothing but blank lines
        return None
    if separator is not None and lines[0].rstrip().endswith(separator):
        rows: Iterator[str] = (line.rstrip().removesuffix(separator) for line in lines)
    else:
        rows = iter(lines)
    try:
        numbers = np.loadtxt(rows, delimiter=separator, comments=None, ndmin=2, dtype=np.float64)
    except ValueError:
        return None
    return numbers if numbers.shape == (len(lines), width) else None  # it passes over blank lines


def _numbers(rows: list[list[str]], width: int, first_row: int, where: str, gaps: bool) -> FloatArray:
    try:
        numbers = np.array(rows, dtype=np.float64)
        if numbers.shape == (len(rows), width):
            return numbers
    except ValueError:
        pass
    for row, cells in enumerate(rows, start=first_row):
        fault = _fault(cells, width, gaps)
        if fault:
            raise InputError(fault, f"{where}, row {row}", "correct the row, remove it or export again")
    return np.array([[_number(cell) for cell in cells] for cells in rows])


def _fault(cells: list[str], width: int, gaps: bool) -> str:
    """Return what is wrong with a row; empty if nothing is."""
    if len(cells) != width:
        return f"the row has {len(cells)} cells, {width} are named"
    for cell in cells:
        try:
            _number(cell)
        except ValueError:
            shown = clean(cell)
            return f'"{shown}" is not a number'
        if not gaps and not cell.strip():
            return "a cell is empty"
    return ""


def _number(cell: str) -> float:
    return float(cell) if cell.strip() else float("nan")
