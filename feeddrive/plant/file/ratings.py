"""What a plant file says of a machine that enters no equation of motion: limits and ratings, for plausibility rules."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from feeddrive.errors import InputError
from feeddrive.parts.values import PartValue, check_values, part_values
from feeddrive.plant.file.drive_sections import BEARING_RATING, BEARING_VALUES, PART_VALUES, given_values
from feeddrive.plant.plant import Datum
from feeddrive.schema.table import Table

RATINGS: dict[str, tuple[PartValue, ...]] = {
    "motor": part_values("""
max_speed | rad/s | (0, 100000) usual 10 to 3000 | | greatest speed of the motor
"""),
    "ball_screw": part_values("""
static_rating | N | (0, 1e8) usual 500 to 5e6 | | static load rating C0
dynamic_rating | N | (0, 1e8) usual 200 to 2e6 | | dynamic load rating C of one nut
ball_circle | m | (0.001, 0.5) usual 0.004 to 0.2 | | diameter of the circle of ball centres
dn_limit | m rad/s | (0, 1000) usual 1 to 40 | | greatest product of ball circle and speed
"""),
    "table": part_values("""
max_velocity | m/s | (0, 50) usual 0.01 to 4 | | greatest velocity of the table
max_acceleration | m/s^2 | (0, 10000) usual 0.1 to 100 | | greatest acceleration of the table
axial_load | N | (0, 1e7) usual 1 to 1e6 | | process force along the axis
"""),
}
"""Limits and ratings by section: greatest speeds and acceleration, C0 and C of the ball screw, process force."""


def read_data(top: Table) -> dict[str, Datum]:
    """Every value of parts and ratings that the file gives, by `section.key`.

    Raises:
        InputError: a value without unit, of another dimension or not possible.

    Warns:
        ValidityWarning: unusual rating.
    """
    found: dict[str, Datum] = {}
    for section, known in PART_VALUES.items():
        found |= _given(top.table(section), section, known)
    for end in ("near", "far"):
        table = top.table("bearing").table(end)
        found |= _checked(table, f"bearing.{end}", BEARING_VALUES, (BEARING_RATING,))
    for section, known in RATINGS.items():
        found |= _checked(top.table(section), section, known, known)
    return found


def _checked(
    table: Table, section: str, known: tuple[PartValue, ...], ratings: tuple[PartValue, ...]
) -> dict[str, Datum]:
    """The values that a section gives; those that are ratings are checked here, others where the part is made."""
    found = _given(table, section, known)
    given = tuple(value for value in ratings if f"{section}.{value.key}" in found)
    check_values(table.where, given, {value.key: found[f"{section}.{value.key}"].value for value in given})
    return found


def _given(table: Table, section: str, known: tuple[PartValue, ...]) -> dict[str, Datum]:
    units = {value.key: value.unit for value in known}
    values = given_values(table, section, known)
    return {f"{section}.{key}": Datum(value, units[key]) for key, value in values.items()}


def read_stroke(top: Table) -> tuple[float, float] | None:
    """Least and greatest table position [m] from `stroke = ["0 mm", "500 mm"]`; None where it is not given.

    Raises:
        InputError: not two positions in ascending order.
    """
    table = top.table("table")
    if "stroke" not in table.entries:
        return None
    stroke = table.quantities("stroke", "m", "table.stroke")
    if not isinstance(stroke, tuple) or len(stroke) != 2 or stroke[1] <= stroke[0]:
        mend = 'write the least and the greatest table position, e.g. stroke = ["0 mm", "500 mm"]'
        raise InputError("is not two ascending positions", table.place("stroke"), mend)
    return stroke


def first_nut_position(top: Table) -> float:
    """Nut from the near bearing where the table is at 0 [m]; 0 where it is not given."""
    table = top.table("table")
    if "first_nut_position" not in table.entries:
        return 0.0
    return table.quantity("first_nut_position", "m", "first_nut_position")


def declares_heat_alone(entries: Mapping[str, Any]) -> bool:
    """Whether a plant file has a thermal section and no structure: no chain can be made of it."""
    return "thermal" in entries and "structure" not in entries
