"""The place and the mend of what makes a text table unreadable; slow, and only run on a table that failed."""

from __future__ import annotations

from feeddrive.errors import InputError


def locate_fault(body: str, separator: str, names: tuple[str, ...], first_row: int, where: str) -> InputError:
    """Return the error of the first row that cannot be read.

    Args:
        body: rows of numbers with decimal points.
        separator: separator of the columns.
        names: column headings.
        first_row: row in the file of the first row of the body.
        where: file name.
    """
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
