"""All rows of the comparison with the source papers, as objects, JSON and CSV."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Sequence
from functools import cache
from importlib import import_module
from importlib.util import find_spec
from typing import Any

from feeddrive.errors import InputError
from feeddrive.reproduce.row import Paper, Row, Status

FIELDS = ("paper", "place", "quantity", "unit", "printed", "computed", "deviation", "status", "reason", "law")
"""Keys of a row in JSON and CSV."""


def find_papers(number: str | None) -> tuple[Paper, ...]:
    """The paper of a number, with or without leading zeros; all papers if None.

    Raises:
        InputError: no such paper; names all.
    """
    if number is None:
        return tuple(Paper)
    wanted = number.strip() and number.strip().zfill(3)
    found = tuple(paper for paper in Paper if paper.number == wanted)
    if not found:
        known = ", ".join(paper.number for paper in Paper)
        raise InputError(f'no source paper "{number}"', "--paper", f"the papers are {known}")
    return found


@cache
def rows_of(paper: Paper) -> tuple[Row, ...]:
    """Rows of a paper in its own order, computed once; none where it has not been compared yet."""
    name = f"feeddrive.reproduce.paper_{paper.number}"
    if find_spec(name) is None:
        return ()
    rows: tuple[Row, ...] = tuple(import_module(name).rows())
    return rows


def counts(rows: Iterable[Row]) -> dict[Status, int]:
    """How many rows have each status, in the order of `Status`."""
    statuses = [row.status for row in rows]
    return {status: statuses.count(status) for status in Status}


def record(row: Row) -> dict[str, Any]:
    """A row as plain values under `FIELDS`; deviation None where there is none."""
    fields = (
        row.paper.number, row.place, row.quantity, row.unit, row.printed, row.computed, row.deviation,
        str(row.status), row.reason, row.law,
    )  # fmt: skip
    return dict(zip(FIELDS, fields, strict=True))


def as_csv(rows: Sequence[Row]) -> str:
    """Rows as CSV with a header; an empty cell where there is nothing."""
    text = io.StringIO()
    writer = csv.DictWriter(text, FIELDS, lineterminator="\n")
    writer.writeheader()
    writer.writerows(record(row) for row in rows)
    return text.getvalue()
