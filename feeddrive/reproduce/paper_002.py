"""Every number and checkable claim of paper 002 beside what the program computes."""

from __future__ import annotations

from feeddrive.reproduce.paper_002_results import result_rows, scheme_rows
from feeddrive.reproduce.paper_002_tables import missing_rows, table_rows
from feeddrive.reproduce.row import Row


def rows() -> tuple[Row, ...]:
    """The comparison: tables 3 to 5, equations, figures 5 to 7 with the conclusions, what is missing."""
    return (*table_rows(), *result_rows(), *scheme_rows(), *missing_rows())
