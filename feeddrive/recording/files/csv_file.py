"""Text tables: separator, decimal sign, header and numbers, and the place of the first cell that is none."""

from __future__ import annotations

import io
import re
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import chain

import numpy as np

from feeddrive.errors import InputError
from feeddrive.recording.traces.naming import known_unit
from feeddrive.typing import FloatArray


def locate_fault(body: str, separator: str, names: tuple[str, ...], first_row: int, where: str) -> InputError:
    """Return the error of the first row of a body that cannot be read; it begins in row `first_row` of the file."""
    for number, line in enumerate(body.split("\n"), start=first_row):
        fault = _fault_of_row(line, separator, names, f"{where}, row {number}")
        if fault is not None:
            return fault
    return InputError("the numbers cannot be read", where, "write plain decimal numbers")


def _fault_of_row(line: str, separator: str, names: tuple[str, ...], where: str) -> InputError | None:
    if not line.strip():
        return InputError("the row is blank", where, "remove blank rows between rows of numbers")
    cells = line.split(separator)
    if len(cells) != len(names):
        what = f"the row has {len(cells)} cells, the header names {len(names)} columns"
        return InputError(what, where, "complete the row or remove it")
    for name, cell in zip(names, cells, strict=True):
        fault = _fault_of_cell(cell.strip(), f'{where}, column "{name}"')
        if fault is not None:
            return fault
    return None


def _fault_of_cell(cell: str, where: str) -> InputError | None:
    if not cell:
        return InputError("the cell is empty", where, "fill the cell or remove the row")
    if not is_number(cell):
        shown = cell if len(cell) <= 40 else cell[:37] + "..."
        return InputError(f'"{shown}" is not a number', where, "write a plain decimal number")
    return None


def is_number(cell: str) -> bool:
    """Tell whether a cell with a decimal point is a number, NaN and infinity among them."""
    try:
        float(cell)
    except ValueError:
        return False
    return True


MOST_HEAD = 16_000_000
"""Letters within which a header, and a row, must end."""

MOST_ABOVE = 10_000
"""Blank and # lines above a header at most."""

MOST_COLUMNS = 10_000
"""Columns of a table at most; a trace of every axis of a large control has some hundred."""

_NOT_A_TABLE = "name a table of numbers, one row to a sample"
_SEPARATOR_NAMES = {"\t": "tab", ";": "semicolon", ",": "comma"}


@dataclass(frozen=True)
class Layout:
    """Where a table stands in its file; None where it is found in the file.

    Attributes:
        header_row: row of the column names, 1 for the first; 0 if there is none (columns are then named 1, 2, ...).
        first_row: first row of numbers.
        separator: one of `,` `;` tab.
        decimal: `.` or `,`.
    """

    header_row: int | None = None
    first_row: int | None = None
    separator: str | None = None
    decimal: str | None = None


@dataclass(frozen=True)
class Table:
    """Numbers of a text table.

    Attributes:
        names: column headings as written.
        columns: numbers of each, (rows,), in the file's units.
        first_row: row in the file of the first number, 1 for the first.
        notes: what was assumed.
    """

    names: tuple[str, ...]
    columns: tuple[FloatArray, ...]
    first_row: int
    notes: tuple[str, ...]


@dataclass(frozen=True)
class TextTable:
    """A text table whose header is understood and whose numbers are still text.

    Attributes:
        names: column headings as written.
        blocks: text from the first row of numbers on, read once; lines ended by \\n.
        separator: one of `,` `;` tab.
        first_row: row in the file of the first row of numbers, 1 for the first.
        where: file name for messages.
        spare: empty headings behind the last that has a name, as a table program leaves them.
    """

    names: tuple[str, ...]
    blocks: Iterator[str]
    separator: str
    first_row: int
    where: str
    spare: int = 0

    def numbers(self, decimal: str | None) -> Table:
        """Return the table with its numbers; decimal is `.` or `,`, None to find it in the file.

        Raises:
            InputError: no rows, undecidable decimal sign, blank row, row of another length, a cell that is no number.
        """
        reader = _RowReader(self, decimal)
        columns = _Columns(len(self.names))
        for text in _whole_rows(self.blocks, f"{self.where}, row {self.first_row}"):
            columns.add(reader.numbers(text))
        if not columns.rows:
            raise InputError("there is a header and no row of numbers", self.where, "record again or name another file")
        notes = reader.notes
        if self.separator != ",":
            notes = (f"columns are separated by {_SEPARATOR_NAMES[self.separator]}", *notes)
        return Table(self.names, columns.whole(), self.first_row, notes)


def find_table(blocks: Iterator[str], layout: Layout, where: str) -> TextTable:
    """Find header, separator and rows of a text table.

    Args:
        blocks: content of the file in pieces, lines ended by \\n.
        layout: what is known beforehand.
        where: file name for messages.
    """
    text = ""
    for block in blocks:
        text += block
        header = _header_index(text, layout)
        needed = max(header or 0, (layout.first_row or 0) - 1) + 2
        if header is not None and text.count("\n") >= needed:
            break
        if len(text) > MOST_HEAD or (header is None and text.count("\n") > MOST_ABOVE):
            raise InputError("there is no header at the beginning", where, _NOT_A_TABLE)
    header = _header_index(text, layout) or 0
    first = layout.first_row - 1 if layout.first_row is not None else header + 1
    lines = text.split("\n", max(header, first) + 1)
    body = "\n".join(lines[first:])
    sample = lines[header] if 0 <= header < len(lines) else body.split("\n", 1)[0]
    separator = layout.separator or _separator(sample)
    written = _names(sample, separator, header >= 0, where)
    names = tuple(written[: next((i for i in range(len(written), 1, -1) if written[i - 1]), 1)])
    if header >= 0 and layout.first_row is None:
        with_units = _with_units(names, body.split("\n", 1)[0], separator)
        if with_units is not None:
            names, body, first = with_units, body.partition("\n")[2], first + 1
    return TextTable(names, chain((body,), blocks), separator, first + 1, where, len(written) - len(names))


def _with_units(names: tuple[str, ...], below: str, separator: str) -> tuple[str, ...] | None:
    """Return names with the units that stand in a row of their own below them; None where that row is none of units."""
    cells = [cell.strip() for cell in below.replace('"', "").split(separator)]
    units = [re.sub(r"^[\[(](.*)[\])]$", r"\1", cell) for cell in cells]
    plain = ("", "-", "1")
    if len(units) < len(names) or any("[" in name for name in names) or all(unit in plain for unit in units):
        return None
    if any(unit not in plain and (is_number(unit.replace(",", ".")) or not known_unit(unit)) for unit in units):
        return None
    return tuple(
        f"{name} [{unit}]" if unit not in ("", "-") else name for name, unit in zip(names, units, strict=False)
    )


def _header_index(text: str, layout: Layout) -> int | None:
    """Return the index of the header line, -1 if there is none, None where it is not yet seen.

    Blank and # lines above it are skipped.
    """
    if layout.header_row is not None:
        return layout.header_row - 1
    start = 0
    for index in range(min(text.count("\n") + 1, MOST_ABOVE)):
        end = text.find("\n", start)
        line = text[start : end if end >= 0 else len(text)]
        if line.strip() and not line.lstrip().startswith("#"):
            return index
        start = end + 1
    return None


def _separator(header: str) -> str:
    """Return the separator that a header uses outside its unit brackets."""
    outside = re.sub(r"\[[^\]\[]*\]", "", header)
    return next((separator for separator in ("\t", ";", ",") if separator in outside), ",")


def _names(sample: str, separator: str, is_header: bool, where: str) -> list[str]:
    """Return the column names; empty last ones stand for separators at the end of each line."""
    if sample.count(separator) > MOST_COLUMNS:
        raise InputError(f"a row of {sample.count(separator) + 1} columns", where, _NOT_A_TABLE)
    cells = _cells_outside_brackets(sample.replace('"', ""), separator)
    return [cell.strip() for cell in cells] if is_header else [str(i + 1) for i in range(len(cells))]


def _cells_outside_brackets(line: str, separator: str) -> list[str]:
    """Split a line at the separators that do not stand in a unit's brackets: those that no ] follows before a [."""
    cells: list[str] = []
    closes = False
    for piece in reversed(line.split(separator)):
        if cells and closes:
            cells[-1] = f"{piece}{separator}{cells[-1]}"
        else:
            cells.append(piece)
        bracket = re.search(r"[\[\]]", piece)
        closes = bracket[0] == "]" if bracket else closes
    return cells[::-1]


def _whole_rows(blocks: Iterator[str], where: str) -> Iterator[str]:
    """Give text in pieces that end with a row; blank rows at the end of the file are left away."""
    held = ""
    for block in blocks:
        held += block
        if len(held) - held.rfind("\n") > MOST_HEAD:
            raise InputError(f"a row of more than {MOST_HEAD // 10**6} million letters", where, _NOT_A_TABLE)
        whole = held[: held.rfind("\n") + 1].rstrip()
        if whole:
            end = held.find("\n", len(whole)) + 1
            yield held[: end - 1]
            held = held[end:]
    held = held.rstrip().rstrip("\x1a").rstrip()  # the letter that ends some DOS files
    if held:
        yield held


class _Columns:
    """Columns that grow; memory that is not yet written to is only promised."""

    def __init__(self, count: int) -> None:
        self.rows, self.arrays = 0, [np.empty(0) for _ in range(count)]

    def add(self, values: FloatArray) -> None:
        """Add rows, (k, columns)."""
        rows = self.rows + values.shape[0]
        if rows > self.arrays[0].size:
            self._resize(max(rows, self.arrays[0].size * 3 // 2))
        for index, array in enumerate(self.arrays):
            array[self.rows : rows] = values[:, index]
        self.rows = rows

    def whole(self) -> tuple[FloatArray, ...]:
        """Return the columns, (rows,) each."""
        self._resize(self.rows)
        return tuple(self.arrays)

    def _resize(self, size: int) -> None:
        for array in self.arrays:
            array.resize(size, refcheck=False)  # nobody else holds it yet


class _RowReader:
    """Reads rows piece by piece, and knows what the pieces before have shown of the decimal sign."""

    def __init__(self, table: TextTable, decimal: str | None) -> None:
        self.table, self.decimal = table, decimal
        self.row = table.first_row
        self.first = True
        self.ended = False
        self.commas = self.points = 0  # the first row that holds one
        self.notes: tuple[str, ...] = ()

    def numbers(self, text: str) -> FloatArray:
        """Return the numbers of some rows, (rows, columns)."""
        text, separator = text.replace('"', ""), self.table.separator
        body = self._points_between_commas(text) if separator == "," else self._with_points(text)
        if self.first:
            self.ended = re.search(re.escape(separator) + "$", body.split("\n", 1)[0]) is not None
        if self.ended:
            most = max(1, self.table.spare)
            body = re.sub(rf"(?:{re.escape(separator)}[ ]*){{1,{most}}}$", "", body, flags=re.MULTILINE)
        values = _numbers(body, separator, self.table.names, self.row, self.table.where)
        self.row, self.first = self.row + values.shape[0], False
        return values

    def _with_points(self, body: str) -> str:
        """Return the rows with decimal points where the comma is free to be one."""
        if "," in body and not self.commas:
            self.commas = _row_of(",", body, self.row)
        if "." in body and not self.points:
            self.points = _row_of(".", body, self.row)
        if not self.commas or self.decimal == ".":
            return body
        if self.points:
            if self.decimal == ",":
                what = "a decimal point stands where the comma is the decimal sign"
                raise InputError(what, f"{self.table.where}, row {self.points}", "write one decimal sign everywhere")
            raise _undecidable(f"{self.table.where}, row {self.commas}", "both comma and point stand in numbers")
        self.notes = ("the comma is read as the decimal sign",)
        return body.replace(",", ".")

    def _points_between_commas(self, body: str) -> str:
        """Tell columns from decimals where the comma may be both."""
        columns, where = len(self.table.names), self.table.where
        if self.decimal != ",":
            line = body.split("\n", 1)[0]
            cells = line.rstrip(",").count(",") + 1
            if self.first and self.decimal is None and cells > columns and "." not in line:
                raise _undecidable(f"{where}, row {self.row}", f"{cells} cells under {columns} columns")
            return body
        for number, line in enumerate(body.split("\n")):
            if line.count(",") + 1 != 2 * columns:
                what = f"{line.count(',') + 1} cells do not make {columns} numbers with a decimal comma"
                raise InputError(what, f"{where}, row {self.row + number}", "separate the columns by ;")
        self.notes = ("the comma is read as the decimal sign and as the separator",)
        return re.sub(r"([^,\n]*),([^,\n]*)(,|$)", r"\1.\2\3", body, flags=re.MULTILINE)


def _undecidable(where: str, reason: str) -> InputError:
    mend = 'say which by --decimal , or --decimal . (in Python: decimal="," or decimal=".")'
    return InputError(f"the decimal sign cannot be decided: {reason}", where, mend)


def _row_of(sign: str, body: str, first_row: int) -> int:
    return first_row + body[: body.index(sign)].count("\n")


def _numbers(body: str, separator: str, names: tuple[str, ...], first_row: int, where: str) -> FloatArray:
    """Return the numbers of a body, (rows, columns)."""
    rows = body.count("\n") + 1
    try:
        values = np.loadtxt(io.StringIO(body), delimiter=separator, comments=None, ndmin=2, dtype=np.float64)
    except ValueError:
        raise locate_fault(body, separator, names, first_row, where) from None
    if values.shape != (rows, len(names)):  # loadtxt passes over blank lines
        raise locate_fault(body, separator, names, first_row, where)
    return values
