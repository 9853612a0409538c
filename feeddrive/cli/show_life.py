"""The life of the ball screw as `feeddrive show` tells it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

from rich.table import Table

from feeddrive.cli.output import table
from feeddrive.parts.life.life import MILLION
from feeddrive.plant.analysis.rated_life import LifeRow
from feeddrive.units.quantity import format_quantity

_HOUR = 3600.0
_KILOMETRE = 1e3


def life_content(rows: Sequence[LifeRow]) -> list[dict[str, Any]]:
    """Rows as plain values, SI."""
    return [asdict(row) for row in rows]


def life_table(rows: Sequence[LifeRow]) -> Table:
    """The same for people; without rows where no dynamic rating is declared."""
    headings = ("axial force", "load of nut +", "of nut −", "10⁶ rev", "travel", "at greatest velocity")
    return table("Rated life of the ball screw, survived by 90 %", headings, [_cells(row) for row in rows])


def _cells(row: LifeRow) -> list[str]:
    loads = [format_quantity(load, "N") for load in row.nut_loads]
    time = f"{_digits(row.time / _HOUR)} h" if row.time is not None else ""
    force = format_quantity(row.force, "N") if row.force else "preload alone"
    return [force, *loads, _digits(row.revolutions / MILLION), f"{_digits(row.travel / _KILOMETRE)} km", time]


def _digits(value: float) -> str:
    """Three digits and no power of ten, which nobody reads in hours and kilometres."""
    return f"{float(f'{value:.3g}'):.15g}"
