"""Beckhoff TwinCAT 3 Scope, text export (CSV or TXT), in all its variants.

One time column [ms] for each group of channels; groups that were sampled more slowly end earlier. The decimal sign of
the numbers is known by the numbers: that of the header follows the language of the computer. Layout: `twincat_header`.
"""

from __future__ import annotations

import re
from itertools import accumulate

import numpy as np

from feeddrive.errors import InputError
from feeddrive.recording.formats.twincat_header import Header, read_header
from feeddrive.recording.formats.twincat_scaling import scaled
from feeddrive.recording.traces.lines import Lines
from feeddrive.recording.traces.naming import axis_in
from feeddrive.recording.traces.trace import Signal, Trace, clean, unique_names, whole_rows
from feeddrive.typing import BoolArray, FloatArray

NAME = "TwinCAT 3 Scope export"
_CHUNK = 20_000  # rows that are held as text at a time
_MOST_HEADER = 1000  # lines among which the header ends; one has some thirty
_FILETIME = 1e15  # no time in ms is as large; 100 ns since 1601 is 1.3e17
_NO_NUMBERS = {"true": "1", "false": "0", "1.#qnan": "nan", "-1.#ind": "nan", "1.#inf": "inf", "-1.#inf": "-inf"}


def recognises(head: str) -> bool:
    """Tell by its first letters whether a text is such an export."""
    plain = head.removeprefix("\ufeff")
    plain = plain.replace('"', "") if plain.startswith('"Name"') else plain
    return (
        plain.startswith("Name")
        and plain[4:5] in "\t ;:,"
        and ("\nData-Type" in plain or "Starttime of export" in plain)
    )


def read(text: str, where: str) -> Trace:
    """Read an export.

    Raises:
        InputError: header and numbers that do not fit each other, or cannot be distinguished.
    """
    lines = _without_quotes(Lines(text))
    header = read_header(list(lines[:_MOST_HEADER]), where)
    table = _Table(header, where)
    table.fill(Lines(lines.text.replace(_QUOTED, ".")))  # "0,5" between commas
    names = unique_names([name.replace(_QUOTED, header.separator) for name in header.attributes["Name"]])
    signals: list[Signal] = []
    for group, first in enumerate([0, *accumulate(header.groups)][:-1]):
        time = _seconds(table.column(group, 0), header, where)
        _refuse_unordered(time, header.first_line + 1, names[first], where)
        signals.extend(
            _signal(header, names, first + i, time, table.column(group, 1 + i)) for i in range(header.groups[group])
        )
    signals, remarks = scaled(signals, header)
    return Trace(NAME, tuple(signals), (*header.notes, *table.notes, *remarks))


_QUOTED = "\ue000"
"""Letter of no language that stands for a separator between quotes."""


def _without_quotes(lines: Lines) -> Lines:
    """Return lines whose cells stand between quotes, as a table program writes them, as the Scope does."""
    separator = re.sub('"', "", lines[0])[4:5]
    if separator == " " or '"' not in lines.text:  # between blanks quotes hold words together
        return lines
    quoted = re.compile('"([^"\n]*)"')
    return Lines(quoted.sub(lambda cell: cell[1].replace(separator, _QUOTED), lines.text))


class _Table:
    """Cells of the numbers by group, as text; a group is whole in a row or absent, and once absent it stays so."""

    def __init__(self, header: Header, where: str) -> None:
        self._header, self._where = header, where
        ends = list(accumulate(width + 1 for width in header.groups))
        self._spans = [(end - width - 1, end) for end, width in zip(ends, header.groups, strict=True)]
        self._parts: list[list[list[FloatArray]]] = [[[] for _ in range(width + 1)] for width in header.groups]
        self._first: list[str] = []
        self._stamps: list[list[str]] = [[] for _ in header.groups]
        self._ended = [False] * len(header.groups)
        self._decimal_comma = False
        self.notes: list[str] = []

    def fill(self, lines: Lines) -> None:
        """Read all rows."""
        body, first = self._body(lines)
        self._decimal_comma = self._decides(body)
        for start in range(0, len(body), _CHUNK):
            self._take(body[start : start + _CHUNK], first + start, len(body) + first)
        for width, name in zip(self._parts, self._header.groups, strict=True):
            if not width[0] or not sum(part.size for part in width[0]):
                raise InputError(f"a group of {name} channels has no numbers", self._where, "export it again")

    def column(self, group: int, index: int) -> FloatArray:
        """Return the numbers of a column of a group, (n,), and give them up; 0 is the time."""
        parts, self._parts[group][index] = self._parts[group][index], []
        return np.concatenate(parts)

    def _body(self, lines: Lines) -> tuple[Lines, int]:
        """Return the rows of numbers and the row in the file of the first."""
        first = self._header.first_line
        last, blank = len(lines), self._header.separator + " "
        while last > first and not lines[last - 1].strip(blank):
            last -= 1
        if last > first and lines[last - 1].strip(blank) == "EOF":
            last -= 1
        body = lines[first:last]
        if not body:
            raise InputError("there is a header and no row of numbers", self._where, "export it again")
        return body, first + 1

    def _decides(self, body: Lines) -> bool:
        """Tell whether the comma is the decimal sign."""
        if self._header.separator == ",":
            return False
        comma, point = body.first_with(","), body.first_with(".")
        if comma is not None and point is not None:
            row = self._header.first_line + 1 + max(comma, point)
            raise InputError("both comma and point stand in numbers", f"{self._where}, row {row}", "export it again")
        if comma is not None:
            self.notes.append("the comma is read as the decimal sign")
        return comma is not None

    def _take(self, lines: Lines, first_row: int, end: int) -> None:
        """Take rows of text; `end` is the row behind the last of the file, which may be cut short."""
        if self._take_whole(lines):
            return
        kept: list[list[list[str]]] = [[] for _ in self._spans]
        for row, line in enumerate(lines, start=first_row):
            cells = self._cells_of(line, row)
            try:
                present = self._present(cells, row)
            except InputError:
                if row != end - 1:
                    raise
                self.notes.append("the last row is cut short and left out")
                continue
            for group, is_there in enumerate(present):
                if is_there:
                    a, b = self._spans[group]
                    kept[group].append(cells[a:b])
        for group, rows in enumerate(kept):
            if rows:
                numbers = self._numbers(rows, first_row, group)
                for index in range(numbers.shape[1]):
                    self._parts[group][index].append(np.ascontiguousarray(numbers[:, index]))

    def _take_whole(self, lines: Lines) -> bool:
        """Take rows in one go where each group is whole or absent, as in any undamaged file; tell whether they were."""
        separator = self._header.separator
        text = lines.block
        if "nan" in text.lower() or '"' in text or (separator == " " and "  " in text):
            return False
        text = text.replace(",", ".") if self._decimal_comma else text
        sign = re.escape(separator)
        if separator != " ":
            text = re.sub(rf"(?m)^ *(?={sign})", "nan", text)
            text = re.sub(rf"(?<={sign}) *(?={sign}|$)", "nan", text, flags=re.MULTILINE)
        rows = text.split("\n")
        counts = [line.count(separator) for line in rows]
        taken: list[tuple[int, FloatArray]] = []
        ended = list(self._ended)
        start = 0
        while start < len(rows):
            stop = start + 1
            while stop < len(rows) and counts[stop] == counts[start]:
                stop += 1
            numbers = whole_rows(rows[start:stop], separator, counts[start] + 1)
            if numbers is None or len(taken) > 40 * len(self._spans) or not self._fits(numbers, ended, taken):
                return False
            start = stop
        for group, columns in taken:
            for index in range(columns.shape[1]):
                self._parts[group][index].append(np.ascontiguousarray(columns[:, index]))
        self._ended = ended
        return True

    def _fits(self, numbers: FloatArray, ended: list[bool], taken: list[tuple[int, FloatArray]]) -> bool:
        """Add the groups of rows of one width to those taken; tell whether every group was whole, and then absent."""
        missing: BoolArray = np.isnan(numbers)
        for group, (a, b) in enumerate(self._spans):
            if a >= numbers.shape[1]:
                ended[group] = True
                continue
            if b > numbers.shape[1] and not missing[:, a:].all():
                return False
            absent: BoolArray = np.all(missing[:, a:b], axis=1)
            there: BoolArray = ~np.any(missing[:, a:b], axis=1)
            rows = int(np.sum(there))
            if not np.all(absent | there) or not there[:rows].all() or (rows and ended[group]):
                return False
            ended[group] = rows < there.size
            if rows:
                taken.append((group, numbers[:rows, a:b]))
        return bool(np.all(missing[:, self._spans[-1][1] :])) and not bool(missing.all(axis=1).any())

    def _present(self, cells: list[str], row: int) -> list[bool]:
        place = f"{self._where}, row {row}"
        width = self._spans[-1][1]
        if len(cells) > width:
            what = f"the row has {len(cells)} cells, the header names {width} columns"
            mend = "export it again with the tab as separator" if self._header.separator == "," else "correct the row"
            raise InputError(what, place, mend)
        found = []
        for group, (a, b) in enumerate(self._spans):
            filled = [bool(cell) for cell in cells[a:b]] + [False] * (b - max(a, len(cells)))
            if any(filled) and (not all(filled[: b - a]) or self._ended[group]):
                raise InputError("a cell is empty between filled ones", place, "complete the row or remove it")
            found.append(any(filled))
        if not any(found):
            raise InputError("the row is blank", place, "remove blank rows between rows of numbers")
        self._ended = [not is_there for is_there in found]
        return found

    def _cells_of(self, line: str, row: int) -> list[str]:
        separator = self._header.separator
        if separator != " ":
            cells = [cell.strip() for cell in line.split(separator)]
        else:
            cells = self._cells_between_blanks(line, row)
        while cells and not cells[-1]:
            cells.pop()
        return cells

    def _cells_between_blanks(self, line: str, row: int) -> list[str]:
        """Split a row where a cell without value is itself a blank: two blanks for each, or one if it is nothing."""
        raw = line.rstrip().split(" ")
        if all(raw):
            return raw
        once = raw
        twice: list[str] = []
        run = 0
        for cell in [*raw, "end"]:
            if cell:
                if run % 2:
                    return once
                twice.extend([""] * (run // 2) + [cell])
                run = 0
            else:
                run += 1
        edges = {a for a, _ in self._spans}
        fits = [cells for cells in (once, twice[:-1]) if next(i for i, cell in enumerate(cells) if cell) in edges]
        if len(fits) != 1:
            what = "the blanks of the row do not tell its columns"
            raise InputError(what, f"{self._where}, row {row}", "export it again with the tab as separator")
        return fits[0]

    def _numbers(self, rows: list[list[str]], first_row: int, group: int) -> FloatArray:
        if self._decimal_comma:
            rows = [[cell.replace(",", ".") for cell in cells] for cells in rows]
        try:
            return np.array(rows, dtype=np.float64)
        except ValueError:
            return np.array([[self._number(cell, first_row + i) for cell in cells] for i, cells in enumerate(rows)])

    def _number(self, cell: str, row: int) -> float:
        try:
            return float(_NO_NUMBERS.get(cell.lower(), cell))
        except ValueError:
            shown = clean(cell)
            place = f"{self._where}, row {row}"
            raise InputError(f'"{shown}" is not a number', place, "export it again, or correct the cell") from None


def _seconds(stamps: FloatArray, header: Header, where: str) -> FloatArray:
    """Return time stamps [s] since the start of the export, from ms or from 100 ns since 1601, (n,)."""
    if stamps.size and stamps[0] > _FILETIME:
        # A double holds 1.3e17 to 16 units, 1.6 µs; the difference is exact.
        return (stamps - (header.start or stamps[0])) * 1e-7
    return stamps / 1e3  # the nearest double to the decimal stamp in s, which times 1e-3 is not


def _refuse_unordered(time: FloatArray, first_row: int, name: str, where: str) -> None:
    bad = np.flatnonzero(~(np.diff(time) > 0.0))
    if bad.size:
        place = f'{where}, row {first_row + int(bad[0]) + 1}, time of "{name}"'
        raise InputError("the time does not increase", place, "export one recording to a file")


def _signal(header: Header, names: list[str], index: int, time: FloatArray, values: FloatArray) -> Signal:
    def cell(attribute: str) -> str:
        cells = header.attributes.get(attribute)
        return cells[index] if cells else ""

    unit = cell("Unit").split(" ")[0]
    symbol = cell("SymbolName")
    return Signal(names[index], time, values, "" if unit == "(None)" else unit, axis_in(symbol, names[index]), symbol)
