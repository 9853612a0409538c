"""Names under which drives and their books know the settings of a cascade.

Where a manufacturer fixes the unit of a parameter, a bare number is taken in it; a quantity with its unit may always be
written. A name without a fixed unit needs one. Sources: parameter manuals of the manufacturers named below.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from feeddrive.errors import InputError


@dataclass(frozen=True)
class Alias:
    """Another name of a setting.

    Attributes:
        key: ours.
        unit: of a bare number; empty where the name fixes none.
        maker: whose name it is.
    """

    key: str
    unit: str
    maker: str


ALIASES: dict[str, Alias] = {
    "K_v": Alias("position_gain", "", "literature"),
    "Kv": Alias("position_gain", "", "literature"),
    "POSCTRL_GAIN": Alias("position_gain", "(m/min)/mm", "Siemens SINUMERIK"),
    "MD32200": Alias("position_gain", "(m/min)/mm", "Siemens SINUMERIK"),
    "MP1510": Alias("position_gain", "(m/min)/mm", "Heidenhain"),
    "MP1810": Alias("position_gain", "(m/min)/mm", "Heidenhain"),
    "kvFactor": Alias("position_gain", "1/s", "Heidenhain"),
    "PL.KP": Alias("position_gain", "1/s", "Kollmorgen"),
    "K_p": Alias("velocity_gain", "", "literature"),
    "Kp": Alias("velocity_gain", "", "literature"),
    "p1460": Alias("velocity_gain", "N m s/rad", "Siemens SINAMICS"),
    "S-0-0100": Alias("velocity_gain", "", "Sercos, Beckhoff"),
    "T_n": Alias("reset_time", "", "literature"),
    "Tn": Alias("reset_time", "", "literature"),
    "p1462": Alias("reset_time", "ms", "Siemens SINAMICS"),
    "S-0-0101": Alias("reset_time", "", "Sercos, Beckhoff"),
    "EQUIV_SPEEDCTRL_TIME": Alias("balancing_time", "s", "Siemens SINUMERIK"),
    "MD32810": Alias("balancing_time", "s", "Siemens SINUMERIK"),
}
"""Name to what it means here."""


def with_own_names(entries: dict[str, Any], where: str) -> dict[str, Any]:
    """The entries of a controller under our names; a setting given twice, under two names, raises InputError."""
    result: dict[str, Any] = {}
    named: dict[str, str] = {}
    for name, value in entries.items():
        alias = ALIASES.get(name)
        key = alias.key if alias else name
        if key in named:
            raise InputError(f"{named[key]} and {name} both set {key}", where, "keep one of them")
        result[key] = f"{value} {alias.unit}" if alias and alias.unit and _bare(value) else value
        named[key] = name
    return result


def _bare(value: object) -> bool:
    """Whether a value is a number without unit, written as a number or as a text."""
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        return False
    try:
        float(value)
    except ValueError:
        return False
    return True
