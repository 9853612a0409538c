"""Where the table goes and where its nut stands then, as a plant file tells it in [table]."""

from __future__ import annotations

from feeddrive.errors import InputError
from feeddrive.plant.file.entries import Table


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
