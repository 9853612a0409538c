"""The coupling of heat and drive in a plant file that declares both.

    [thermal.coupling]
    nut_at_zero = "225 mm"                     # nut's centre from the fixed end, table at 0
    nut_stiffness = "400 N/µm"                 # axial, whole nut at its preload
    group_distance = "60 mm"                   # of the two ball groups
    contact_angle = "45 deg"
    spacer = "oversize"                        # or "undersize": nuts pushed apart, or pulled together
    rear_share = 0.5                           # may be left out: of the bearings' friction
    motor_constant = "1.1 N m/W^0.5"           # may be left out: torque per root of the winding's heat
    guide_heat_to = "table"                    # may be left out: a [[thermal.body]]; else the bed takes it
    [thermal.coupling.nut_oil]
    viscosity_40 = "100 mm^2/s"
    viscosity_100 = "11 mm^2/s"
    [thermal.coupling.bearing_oil]             # may be left out: as the nut's

The temperature for which friction and preload are declared is `ambient`, the preload that of the thermal section.
"""

from __future__ import annotations

from typing import Any

from feeddrive.errors import InputError
from feeddrive.parts.lubricant import Lubricant
from feeddrive.plant.file.entries import Table
from feeddrive.thermal.laws.nut_preload import Spacer
from feeddrive.thermal.thermal_coupling import Coupling

_KEYS = (
    "nut_at_zero", "nut_stiffness", "group_distance", "contact_angle", "spacer", "rear_share", "motor_constant",
    "guide_heat_to", "nut_oil", "bearing_oil", "source",
)  # fmt: skip
_SPACERS = {spacer.name.lower(): spacer for spacer in Spacer}


def read_coupling(top: Table) -> Coupling | None:
    """The coupling that a whole plant file declares; None where it declares none.

    Args:
        top: the whole file.

    Raises:
        InputError: unknown key, a value that is missing, without unit or impossible.
    """
    thermal = top.table("thermal")
    if "coupling" not in thermal.entries:
        return None
    table = thermal.table("coupling")
    table.refuse_unknown(_KEYS)
    oil = _oil(table, "nut_oil")
    try:
        return Coupling(
            nut_oil=oil,
            bearing_oil=_oil(table, "bearing_oil") if "bearing_oil" in table.entries else oil,
            spacer=_SPACERS[table.choice("spacer", _SPACERS)],
            guide_heat_to=table.text("guide_heat_to", ""),
            **_numbers(table),
        )
    except InputError as error:
        inside = error.where.startswith(top.where)
        raise error if inside else InputError(error.what, f"{top.where}, {error.where}", error.mend) from None


def _numbers(table: Table) -> dict[str, Any]:
    needed = {"nut_at_zero": "m", "nut_stiffness": "N/m", "group_distance": "m", "contact_angle": "rad"}
    optional = {"rear_share": "1", "motor_constant": "N m/W^0.5"}
    kept = needed | {key: unit for key, unit in optional.items() if key in table.entries}
    return {key: table.quantity(key, unit, f"thermal.coupling.{key}") for key, unit in kept.items()}


def _oil(table: Table, key: str) -> Lubricant:
    inner = table.table(key)
    inner.refuse_unknown(("viscosity_40", "viscosity_100", "source"))
    values = [inner.quantity(f"viscosity_{at}", "m^2/s", f"thermal.coupling.{key}.{at}") for at in (40, 100)]
    return Lubricant(*values)
