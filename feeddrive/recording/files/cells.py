"""Cells of a text table that are no numbers and mean one: dates in a column of times, words in one of directions."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from dataclasses import replace
from datetime import date
from itertools import chain

from feeddrive.errors import InputError, quoted
from feeddrive.recording.files.csv_file import TextTable, is_number

_STAMP = re.compile(
    r"(?:(?:(?P<y>\d{4})[-./](?P<m>\d\d?)[-./](?P<d>\d\d?)|(?P<d2>\d\d?)\.(?P<m2>\d\d?)\.(?P<y2>\d{4}))(?:[T ]+|$))?"
    r"(?:(?P<h>\d{1,2}):(?P<min>\d\d):(?P<s>\d\d)(?:[.,](?P<part>\d{1,9}))?)?"
    r"(?P<zone>Z|[+-]\d\d:?\d\d)?"
)


def with_numbers(table: TextTable, column: int, number: Callable[[str, str], str]) -> TextTable:
    """Return a table whose cells of one column are written as numbers.

    Args:
        table: whose rows are still text.
        column: 0 for the first.
        number: makes a number of a cell; the second argument is its place, for errors.
    """

    def blocks() -> Iterator[str]:
        row, held = table.first_row, ""
        for block in chain(table.blocks, ("\n",)):
            *whole, held = (held + block).split("\n")
            for index, line in enumerate(whole):
                cells = line.split(table.separator)
                if line.strip() and column < len(cells):
                    place = f'{table.where}, row {row + index}, column "{table.names[column]}"'
                    cells[column] = number(cells[column].strip().strip('"'), place)
                    whole[index] = table.separator.join(cells)
            row += len(whole)
            yield "\n".join([*whole, ""])

    return replace(table, blocks=blocks())


def with_dates(table: TextTable) -> tuple[TextTable, tuple[str, ...]]:
    """Return a table whose column `time` counts seconds where dates stand in it, and what was done.

    Raises:
        InputError: while it is read: a cell that is no such date.
    """
    names = [name.strip().lower() for name in table.names]  # one with a unit counts in it
    if "time" not in names:
        return table, ()
    column = names.index("time")
    first = next((block for block in table.blocks if block.strip()), "")
    table = replace(table, blocks=chain((first,), table.blocks))
    cells = first.lstrip().split("\n", 1)[0].split(table.separator)
    cell = cells[column].strip().strip('"') if column < len(cells) else ""
    match = _STAMP.fullmatch(cell)
    if match is None or is_number(cell.replace(",", ".")) or not (match["h"] or match["y"] or match["y2"]):
        return table, ()
    begin: list[int] = []  # nanoseconds of the first

    def seconds(written: str, place: str) -> str:
        stamp = _nanoseconds(written, place)
        begin[:] = begin or [stamp]
        return f"{(stamp - begin[0]) // 10**9}.{(stamp - begin[0]) % 10**9:09d}" if stamp >= begin[0] else "-1"

    renamed = tuple("time [s]" if index == column else name for index, name in enumerate(table.names))
    done = with_numbers(replace(table, names=renamed), column, seconds)
    return done, ("the dates of the time are counted in s from the first",)


def _nanoseconds(written: str, place: str) -> int:
    """Return a date as ns since the year 1, in its own zone."""
    match = _STAMP.fullmatch(written)
    try:
        if match is None or not written:
            raise ValueError
        day = 0
        if match["y"] or match["y2"]:
            year, month = int(match["y"] or match["y2"]), int(match["m"] or match["m2"])
            day = date(year, month, int(match["d"] or match["d2"])).toordinal()
        clock = (int(match["h"] or 0) * 60 + int(match["min"] or 0)) * 60 + int(match["s"] or 0)
    except ValueError:
        mend = "write 2026-01-31 14:30:00.001, or seconds under time [s]"
        raise InputError(f'"{quoted(written, 40)}" is not a date', place, mend) from None
    zone = match["zone"] or "Z"
    ahead = 0 if zone == "Z" else int(f"{zone[0]}1") * (int(zone[1:3]) * 60 + int(zone[-2:])) * 60
    return (day * 86400 + clock - ahead) * 10**9 + int((match["part"] or "0").ljust(9, "0"))
