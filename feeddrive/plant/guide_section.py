"""The [guide] of a plant file: which carriages, how many, what loads them, and the friction that follows.

[guide]
carriage = "HSR-30R"            # a known one, or its geometry in place of the name:
ball_diameter = "5.556 mm"
rail_conformity = 0.52          # groove radius over ball diameter
carriage_conformity = 0.52
contact_angle = "45 deg"
preload_oversize = "5 µm"       # ball oversize; 0 for none
balls_per_row = 12              # under load
carriages = 4
seal_drag = "6 N"               # of one carriage; may be left out
load = "500 N"                  # vertical load of one carriage; may be left out: the table's weight, shared evenly
coefficients = "A"              # of rolling and slip: set A or B; may be left out
smoothing_velocity = "0.5 mm/s" # may be left out
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from feeddrive.effects.base import Effect
from feeddrive.effects.guide_friction import GuideFriction, guide_effect
from feeddrive.errors import InputError
from feeddrive.parts.guide_coefficients import SET_A, SET_B
from feeddrive.parts.guide_geometry import GUIDE_VALUES, HSR_20R, HSR_30R, BallGuide
from feeddrive.plant.drive_sections import placed
from feeddrive.plant.entries import Table
from feeddrive.quantity import format_quantity

CARRIAGES = {"HSR-20R": HSR_20R, "HSR-30R": HSR_30R}
COEFFICIENTS = {"A": SET_A, "B": SET_B}
_GEOMETRY = tuple(value.key for value in GUIDE_VALUES)
_OTHERS = ("carriage", "carriages", "seal_drag", "smoothing_velocity", "load", "coefficients", "source")

_TURNING = 5e-4  # where tanh of the guide friction turns unless it is said [m/s]


def guide_friction_of(top: Table, gravity: float, before: Sequence[Effect]) -> list[tuple[Effect, str]]:
    """The guide friction of a plant file and where it comes from; none without a [guide].

    Args:
        top: the file.
        gravity: acceleration of fall [m/s^2].
        before: effects that it declares itself.

    Raises:
        InputError: a value that is missing, without unit or not possible, or friction declared twice.
    """
    if "guide" not in top.entries:
        return []
    table = top.table("guide")
    table.refuse_unknown((*_OTHERS, *_GEOMETRY))
    if any(isinstance(effect, GuideFriction) for effect in before):
        raise InputError("guide and guide_friction are both declared", table.where, "keep one of them")
    name, guide = _carriage(table)
    coefficients = COEFFICIENTS[table.choice("coefficients", COEFFICIENTS, "A")]
    count = _whole(table, "carriages", "carriages = 4")
    seal = table.quantity("seal_drag", "N", "guide.seal_drag") if "seal_drag" in table.entries else 0.0
    load, turning = _load(top, gravity, count), _TURNING
    if "smoothing_velocity" in table.entries:
        turning = table.quantity("smoothing_velocity", "m/s", "guide.smoothing_velocity")
    effect = placed(table.where, lambda: guide_effect(guide, coefficients, count, load, seal, turning))
    origin = f"computed from {count} carriages {name} with {format_quantity(load, 'N')} and seals of"
    return [(effect, f"{origin} {format_quantity(seal, 'N')} each")]


def _carriage(table: Table) -> tuple[str, BallGuide]:
    """Name and geometry: a known carriage, or one whose geometry is written."""
    written = [key for key in _GEOMETRY if key in table.entries]
    if "carriage" in table.entries and written:
        mend = "keep the name of a known carriage, or its geometry"
        raise InputError(f"carriage and {written[0]} are both given", table.where, mend)
    if not written:
        name = table.choice("carriage", CARRIAGES)
        return name, CARRIAGES[name]
    balls = _whole(table, "balls_per_row", "balls_per_row = 12")
    size = {v.key: table.quantity(v.key, v.unit, f"guide.{v.key}") for v in GUIDE_VALUES if v.key != "balls_per_row"}
    return "as written", placed(
        table.where,
        lambda: BallGuide(
            size["ball_diameter"], size["rail_conformity"], size["carriage_conformity"], size["contact_angle"],
            size["preload_oversize"], balls,
        ),
    )  # fmt: skip


def _whole(table: Table, key: str, example: str) -> int:
    count = table.entries.get(key)
    if not isinstance(count, int) or isinstance(count, bool) or not 1 <= count <= 1000:
        raise InputError(f"{count!r} is not a whole number above 0", table.place(key), f"write e.g. {example}")
    return count


def _load(top: Table, gravity: float, count: int) -> float:
    """Vertical load of one carriage [N]: written, or the table's weight across the guide, shared evenly."""
    guide, table = top.table("guide"), top.table("table")
    if "load" in guide.entries:
        return guide.quantity("load", "N", "guide.load")
    angle = table.quantity("inclination", "rad", "table.inclination") if "inclination" in table.entries else 0.0
    return table.quantity("mass", "kg", "table_mass") * gravity * math.cos(angle) / count
