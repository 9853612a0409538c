"""The sensors of heat of a plant file: its `[[sensor]]` tables."""

from __future__ import annotations

from feeddrive.errors import InputError
from feeddrive.plant.file.entries import Table
from feeddrive.recording.channels import channel_unit
from feeddrive.thermal.sensors import PLACES, SCALE, THERMOMETER, HeatSensor
from feeddrive.units.quantity import parse

_KEYS = ("channel", "kind", "at", "noise", "source")


def read_heat_sensors(top: Table) -> tuple[HeatSensor, ...]:
    """The sensors for temperature and growth; sensors of motion, in a file that declares it, are passed over.

    Raises:
        InputError: unknown key, channel, kind or place, a channel declared twice, two sensors of one place.
    """
    tables = top.tables("sensor")
    if "structure" in top.entries:
        tables = [table for table in tables if _of_heat(str(table.entries.get("channel")))]
    sensors: list[HeatSensor] = []
    for table in tables:
        sensor = _sensor(table)
        for other in sensors:
            if sensor.channel == other.channel or sensor.output == other.output:
                what = f"{sensor.channel} and {other.channel} are the same channel or the same place"
                raise InputError(what, table.where, "keep one of them")
        sensors.append(sensor)
    return tuple(sensors)


def _of_heat(channel: str) -> bool:
    return channel.endswith("_temperature") or channel.startswith("table_growth_")


def _sensor(table: Table) -> HeatSensor:
    table.refuse_unknown(_KEYS)
    channel, kind = table.text("channel"), table.choice("kind", (THERMOMETER, SCALE))
    unit = channel_unit(channel, table.place("channel"))
    if unit != ("m" if kind == SCALE else "degC") or not _of_heat(channel):
        mend = "a thermometer reads NAME_temperature, a scale table_growth_NAME"
        raise InputError(f"{channel} is no channel of a {kind}", table.place("channel"), mend)
    at = table.choice("at", PLACES) if kind == THERMOMETER else parse(table.text("at"), "m", table.place("at"))
    noise = (
        table.quantity("noise", "m" if kind == SCALE else "K", f"{channel}.noise") if "noise" in table.entries else 0.0
    )
    if noise < 0:
        raise InputError("the noise is negative", table.place("noise"), "write it positive")
    return HeatSensor(channel, kind, at, noise)
