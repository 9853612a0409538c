"""Text tables: separator, decimal sign, header and numbers, and the place of the first cell that is none."""

from __future__ import annotations

import io
import re
from dataclasses import dataclass

import numpy as np

from feeddrive.errors import InputError
from feeddrive.recording.csv_faults import locate_fault
from feeddrive.typing import FloatArray

_SEPARATOR_NAMES = {"\t": "tab", ";": "semicolon", ",": "comma"}


@dataclass(frozen=True)
class Layout:
    """Where a table stands in its file; None where the file itself tells.

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
        values: numbers, (rows, columns), in the file's units.
        first_row: row in the file of values[0], 1 for the first.
        notes: what was assumed.
    """

    names: tuple[str, ...]
    values: FloatArray
    first_row: int
    notes: tuple[str, ...]


@dataclass(frozen=True)
class TextTable:
    """A text table whose header is understood and whose numbers are still text.

    Attributes:
        names: column headings as written.
        body: rows of numbers, lines ended by \\n.
        separator: one of `,` `;` tab.
        first_row: row in the file of the first row of the body, 1 for the first.
        where: file name for messages.
    """

    names: tuple[str, ...]
    body: str
    separator: str
    first_row: int
    where: str

    def numbers(self, decimal: str | None) -> Table:
        """Return the table with its numbers; decimal is `.` or `,`, None to let the file tell.

        Raises:
            InputError: no rows, undecidable decimal sign, blank row, row of another length, a cell that is no number.
        """
        if not self.body:
            raise InputError("there is a header and no row of numbers", self.where, "record again or name another file")
        columns = len(self.names)
        body, notes = _with_decimal_points(self.body, self.separator, columns, decimal, self.first_row, self.where)
        values = _numbers(body, self.separator, self.names, self.first_row, self.where)
        if self.separator != ",":
            notes = (f"columns are separated by {_SEPARATOR_NAMES[self.separator]}", *notes)
        return Table(self.names, values, self.first_row, notes)


def find_table(text: str, layout: Layout, where: str) -> TextTable:
    """Find header, separator and rows of a text table.

    Args:
        text: content of the file, lines ended by \\n.
        layout: what is known beforehand.
        where: file name for messages.
    """
    lines = text.split("\n")
    header = _header_index(lines, layout)
    first = layout.first_row - 1 if layout.first_row is not None else header + 1
    body = "\n".join(lines[first:]).rstrip().replace('"', "")
    sample = lines[header] if 0 <= header < len(lines) else body.split("\n", 1)[0]
    separator = layout.separator or _separator(sample)
    return TextTable(_names(sample, separator, header >= 0), body, separator, first + 1, where)


def _header_index(lines: list[str], layout: Layout) -> int:
    """Return the index of the header line, -1 if there is none; blank and # lines above it are skipped."""
    if layout.header_row is not None:
        return layout.header_row - 1
    return next((index for index, line in enumerate(lines) if line.strip() and not line.lstrip().startswith("#")), 0)


def _separator(header: str) -> str:
    """Return the separator that a header uses outside its unit brackets."""
    outside = re.sub(r"\[[^\]]*\]", "", header)
    return next((separator for separator in ("\t", ";", ",") if separator in outside), ",")


def _names(sample: str, separator: str, is_header: bool) -> tuple[str, ...]:
    """Return the column names; an empty last one stands for a separator at the end of each line."""
    cells = re.split(re.escape(separator) + r"(?![^\[]*\])", sample.replace('"', "").rstrip("\n"))
    names = [cell.strip() for cell in cells] if is_header else [str(i + 1) for i in range(len(cells))]
    return tuple(names[:-1] if len(names) > 1 and not names[-1] else names)


def _with_decimal_points(
    body: str, separator: str, columns: int, decimal: str | None, row: int, where: str
) -> tuple[str, tuple[str, ...]]:
    """Return the body with decimal points, and a note if it had commas."""
    if separator == ",":
        return _points_between_commas(body, columns, decimal, row, where)
    if "," not in body or decimal == ".":
        return body, ()
    if "." in body:
        if decimal == ",":
            what = "a decimal point stands where the comma is the decimal sign"
            raise InputError(what, f"{where}, row {_row_of('.', body, row)}", "write one decimal sign everywhere")
        raise _undecidable(f"{where}, row {_row_of(',', body, row)}", "both comma and point stand in numbers")
    return body.replace(",", "."), ("the comma is read as the decimal sign",)


def _points_between_commas(
    body: str, columns: int, decimal: str | None, row: int, where: str
) -> tuple[str, tuple[str, ...]]:
    """Tell columns from decimals where the comma may be both."""
    cells = body.split("\n", 1)[0].rstrip(",").count(",") + 1
    if decimal != ",":
        if decimal is None and cells > columns and "." not in body.split("\n", 1)[0]:
            raise _undecidable(f"{where}, row {row}", f"{cells} cells under {columns} columns")
        return body, ()
    pairs = re.compile(r"([^,\n]*),([^,\n]*)(,|$)", re.MULTILINE)
    for number, line in enumerate(body.split("\n")):
        if line.count(",") + 1 != 2 * columns:
            what = f"{line.count(',') + 1} cells do not make {columns} numbers with a decimal comma"
            raise InputError(what, f"{where}, row {row + number}", "separate the columns by ;")
    return pairs.sub(r"\1.\2\3", body), ("the comma is read as the decimal sign and as the separator",)


def _undecidable(where: str, reason: str) -> InputError:
    mend = 'say which by --decimal , or --decimal . (in Python: decimal="," or decimal=".")'
    return InputError(f"the decimal sign cannot be decided: {reason}", where, mend)


def _row_of(sign: str, body: str, first_row: int) -> int:
    return first_row + body[: body.index(sign)].count("\n")


def _numbers(body: str, separator: str, names: tuple[str, ...], first_row: int, where: str) -> FloatArray:
    """Return the numbers of a body, (rows, columns)."""
    if re.search(re.escape(separator) + r"$", body.split("\n", 1)[0]):
        body = re.sub(re.escape(separator) + r"[ ]*$", "", body, flags=re.MULTILINE)
    rows = body.count("\n") + 1
    try:
        values = np.loadtxt(io.StringIO(body), delimiter=separator, comments=None, ndmin=2, dtype=np.float64)
    except ValueError:
        raise locate_fault(body, separator, names, first_row, where) from None
    if values.shape != (rows, len(names)):  # loadtxt passes over blank lines
        raise locate_fault(body, separator, names, first_row, where)
    return values
