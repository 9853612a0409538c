"""The point at which a plant is exported: where the table stands and how fast it moves."""

from __future__ import annotations

import re
from dataclasses import dataclass

from feeddrive.errors import InputError
from feeddrive.plant.analysis.steady import MOVING
from feeddrive.plant.plant import Plant
from feeddrive.units.quantity import parse

_UNITS = {"x": "m", "v": "m/s"}
_SEPARATOR = re.compile(r",(?!\d)")  # a comma before a digit is a decimal one, which is refused by its name
_MEND = 'write e.g. --at "x=200 mm,v=3 m/min"'


@dataclass(frozen=True)
class Point:
    """An operating point.

    Attributes:
        position: of the table [m].
        velocity: of the table [m/s]; None where none was asked for: `MOVING` for a linear model, rest for the start of
            a nonlinear one.
    """

    position: float
    velocity: float | None = None

    @property
    def linearised_at(self) -> float:
        """Velocity of the table about which is linearised [m/s]."""
        return MOVING if self.velocity is None else self.velocity

    @property
    def starts_at(self) -> float:
        """Velocity of the table at which a nonlinear model starts [m/s]."""
        return 0.0 if self.velocity is None else self.velocity


def export_point(plant: Plant, text: str = "", where: str = "--at") -> Point:
    """Read a point such as "x=200 mm,v=3 m/min"; without x the middle of the stroke, or 0 where there is none.

    Raises InputError: unknown or repeated key, a number without unit, or a position outside the stroke or off the
    screw.
    """
    written = written_point(text, where)
    point = Point(written.get("x", plant.middle), written.get("v"))
    plant.refuse_off_stroke(point.position, where)
    return point


def written_point(text: str, where: str = "--at") -> dict[str, float]:
    """What a point such as "x=200 mm,v=3 m/min" gives: x [m] and v [m/s]; either may be left out.

    Raises:
        InputError: unknown or repeated key, or a number without unit.
    """
    written: dict[str, float] = {}
    for part in _SEPARATOR.split(text) if text.strip() else []:
        key, equals, value = (piece.strip() for piece in part.partition("="))
        if not equals or key not in _UNITS or key in written:
            what = f"{key} is given twice" if key in written else f'"{part.strip()}" is neither x=... nor v=...'
            raise InputError(what, where, _MEND)
        written[key] = parse(value, _UNITS[key], f"{where} {key}")
    return written
