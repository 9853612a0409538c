"""Paper 001 (life of ball screws): its numbers and claims beside what the program computes."""

from __future__ import annotations

from feeddrive.reproduce.paper_001_equations import equation_rows, unmodelled_rows
from feeddrive.reproduce.paper_001_law import law_rows
from feeddrive.reproduce.paper_001_nut import nut_rows
from feeddrive.reproduce.paper_001_specimens import specimen_rows
from feeddrive.reproduce.row import Row


def rows() -> tuple[Row, ...]:
    """Rows in the order of the paper: life test, shear and life law, then cycles, load distribution and rating."""
    return (*specimen_rows(), *unmodelled_rows(), *equation_rows(), *law_rows(), *nut_rows())
