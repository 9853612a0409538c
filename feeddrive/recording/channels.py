"""Canonical channels, their SI units, and the column headings `name [unit]` that carry them."""

from __future__ import annotations

import difflib
import re
from dataclasses import dataclass

from feeddrive.errors import InputError
from feeddrive.units.quantity import Conversion, unit_conversion

CHANNEL_UNITS: dict[str, str] = {
    "time": "s",
    "setpoint": "m",
    "motor_torque": "N m",
    "motor_current": "A",
    "motor_torque_share": "1",
    "motor_angle": "rad",
    "motor_speed": "rad/s",
    "table_position": "m",
    "table_velocity": "m/s",
    "screw_speed": "rad/s",
    "cutting_force": "N",
    "injected_torque": "N m",
    "injected_speed": "rad/s",
}
"""Canonical channel -> SI unit; temperatures and growths have open names."""

INJECTED = ("injected_torque", "injected_speed")
"""What a test signal adds to the torque command, and to the set-point of the motor's speed behind the position loop;
commands as the torque is: each acts from its sample to the next."""

MOTION_AND_TORQUE = (
    "motor_torque",
    "motor_current",
    "motor_torque_share",
    "motor_angle",
    "motor_speed",
    "table_position",
    "table_velocity",
)
"""Channels that must change during a recording."""

_OPEN_NAMES = ((re.compile(r"[a-z0-9_]+_temperature"), "degC"), (re.compile(r"table_growth_[a-z0-9_]+"), "m"))
_HEADING = re.compile(r"(?P<name>[^\[\]]*?)\s*(?:\[(?P<unit>[^\[\]]*)\])?")
_COMMON_NAMES = {
    "t": "time",
    "torque": "motor_torque",
    "current": "motor_current",
    "position": "table_position",
    "angle": "motor_angle",
    "speed": "motor_speed",
    "velocity": "table_velocity",
    "force": "cutting_force",
    "excitation": "injected_torque",
    "injection": "injected_torque",
    "reference": "setpoint",
    "command": "setpoint",
    "scale": "table_position",
    "encoder": "motor_angle",
    "temperature": "nut_temperature",
    "growth": "table_growth_1",
}


@dataclass(frozen=True)
class Heading:
    """One column heading: canonical channel and the conversion of its unit to SI."""

    channel: str
    conversion: Conversion


def channel_unit(channel: str, where: str) -> str:
    """Return the SI unit of a canonical channel.

    Raises:
        InputError: unknown name; says the nearest canonical one.
    """
    if channel in CHANNEL_UNITS:
        return CHANNEL_UNITS[channel]
    for pattern, unit in _OPEN_NAMES:
        if pattern.fullmatch(channel):
            return unit
    raise InputError(f'unknown channel "{channel}"', where, f'did you mean "{nearest_channel(channel)}"?')


def nearest_channel(name: str) -> str:
    """Return the canonical name that comes nearest to a foreign one."""
    plain = re.sub(r"[^a-z0-9]+", "_", name.lower()).strip("_")
    if re.search(r"temp", plain):
        stem = re.sub(r"_?temp(erature)?_?", "", plain)
        return f"{stem or 'nut'}_temperature"
    if plain in _COMMON_NAMES:
        return _COMMON_NAMES[plain]
    near = difflib.get_close_matches(plain, [*CHANNEL_UNITS, "table_growth_1"], n=1, cutoff=0.0)
    return near[0]


def read_heading(text: str, where: str) -> Heading:
    """Read a column heading such as `motor_speed [rev/min]`.

    Raises:
        InputError: no unit, unknown channel, unknown unit or wrong dimension.
    """
    match = _HEADING.fullmatch(text.strip())
    if match is None or not match["name"]:
        raise InputError(f'"{text}" is not a column heading', where, 'write "name [unit]", e.g. "motor_torque [N m]"')
    name, unit = match["name"], match["unit"]
    if unit is None and (round_ones := re.fullmatch(r"(.+?)\s*\(([^()]+)\)", name)):
        mend = f'write "{nearest_channel(round_ones[1])} [{round_ones[2]}]" in the header'
        raise InputError(f'"{text.strip()}" has its unit in round brackets', where, mend)
    needed = channel_unit(name, where)
    if not unit or not unit.strip():
        raise InputError(f'column "{name}" has no unit', where, f'write "{name} [{needed}]" in the header')
    if name == "motor_torque" and unit.strip() == "%":
        raise InputError(f'column "{name}" is in %', where, 'call it "motor_torque_share [%]"')
    return Heading(name, unit_conversion(unit, needed, f'{where}, column "{name}"'))
