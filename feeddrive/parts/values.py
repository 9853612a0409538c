"""What a part is made of: values with unit, possible and usual range, checked when the part is made.

Outside its possible range a value is refused; outside the usual one a warning gives the usual range, since a slip of
the unit (N/m for N/µm, metres for millimetres) is then the likeliest cause.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Mapping
from dataclasses import dataclass

from feeddrive.errors import InputError, ValidityWarning
from feeddrive.schema.key import bounds, table_rows
from feeddrive.units.quantity import format_quantity


@dataclass(frozen=True)
class PartValue:
    """One value of a part.

    Attributes:
        key: name of the field and in plant files.
        unit: SI unit; "1" for none.
        minimum, maximum: possible range, ends excluded where `open_ends` [unit].
        usual: range in which catalogues lie [unit]; None where anything possible is usual.
        default: value where none is given; None if it must be given.
        open_ends: whether the ends of the possible range are impossible themselves.
        meaning: in a few words, for the reference of plant files and for errors.
    """

    key: str
    unit: str
    minimum: float = -math.inf
    maximum: float = math.inf
    usual: tuple[float, float] | None = None
    default: float | None = None
    open_ends: bool = True
    meaning: str = ""


def part_values(table: str) -> tuple[PartValue, ...]:
    """Values declared in a table, one a line: key | SI unit | range | = default, or nothing | meaning.

    Ranges are written as in `feeddrive.schema.key`: (0.1, 1e9) usual 10 to 5e6.
    """
    return tuple(_part_value(*cells) for cells in table_rows(table))


def _part_value(key: str, unit: str, ends: str, default: str, meaning: str) -> PartValue:
    found = bounds(ends)
    assert found is not None, ends
    open_ends = found.open_ends or math.isinf(found.minimum)
    given = float(default.removeprefix("=")) if default else None
    return PartValue(key, unit, found.minimum, found.maximum, found.usual, given, open_ends, meaning)


def check_values(part: str, known: tuple[PartValue, ...], values: Mapping[str, float]) -> None:
    """Refuse values of a part, key to SI, that are not finite or possible, and warn of unusual ones."""
    for value in known:
        number = values[value.key]
        where = f"{part}.{value.key}"
        if not math.isfinite(number) or not _possible(value, number):
            what = f"{format_quantity(number, value.unit)} is not possible"
            raise InputError(what, where, f"write a value {_possible_range(value)}")
        if value.usual is not None and not value.usual[0] <= number <= value.usual[1]:
            low, high = (format_quantity(end, value.unit) for end in value.usual)
            shown = format_quantity(number, value.unit)
            warnings.warn(
                f"{where}: {shown} is unusual, {low} to {high} is usual; check its unit", ValidityWarning, stacklevel=3
            )


def _possible(value: PartValue, number: float) -> bool:
    if value.open_ends:
        return value.minimum < number < value.maximum
    return value.minimum <= number <= value.maximum


def _possible_range(value: PartValue) -> str:
    if math.isinf(value.maximum):
        return f"above {format_quantity(value.minimum, value.unit)}"
    return f"between {format_quantity(value.minimum, value.unit)} and {format_quantity(value.maximum, value.unit)}"
