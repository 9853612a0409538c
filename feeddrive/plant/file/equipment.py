"""What a plant file declares around the mechanics: sensors of motion and of heat, the controller."""

from __future__ import annotations

from feeddrive.errors import InputError
from feeddrive.plant.file.ratings import declares_heat_alone
from feeddrive.plant.plant import DeclaredCascade, PositionVelocityController, Sensor
from feeddrive.recording.channels import channel_unit
from feeddrive.schema.table import Table
from feeddrive.thermal.machine_heat import PLACES, SCALE, THERMOMETER, HeatSensor
from feeddrive.units.quantity import parse

SENSOR_KINDS = ("encoder", "scale", "tachometer", "current")
SENSOR_PLACES = ("motor", "screw", "table")
_SENSOR_KEYS = ("channel", "kind", "at", "resolution", "absolute", "model_error", "source")


def read_sensors(top: Table) -> tuple[Sensor, ...]:
    """The declared sensors of motion of a plant file, resolutions in the SI unit of their channel.

    Raises:
        InputError: unknown key, channel, kind or place, a negative resolution, or a channel declared twice.
    """
    sensors: list[Sensor] = []
    for table in () if declares_heat_alone(top.entries) else top.tables("sensor"):
        if "thermal" in top.entries and _of_heat(str(table.entries.get("channel"))):
            continue  # `read_heat_sensors` reads it
        sensor = _sensor(table)
        if any(sensor.channel == other.channel for other in sensors):
            raise InputError(f"{sensor.channel} is declared twice", table.where, "keep one of them")
        sensors.append(sensor)
    return tuple(sensors)


def _sensor(table: Table) -> Sensor:
    table.refuse_unknown(_SENSOR_KEYS)
    channel = table.text("channel")
    unit = channel_unit(channel, table.place("channel"))
    sizes = dict.fromkeys(("resolution", "model_error"), 0.0)
    for key in sizes:
        if key in table.entries:
            sizes[key] = table.quantity(key, unit, f"{channel}.{key}")
        if sizes[key] < 0:
            raise InputError(f"the {key} is negative", table.place(key), "write it positive")
    absolute = table.switch("absolute")
    kind, at = table.choice("kind", SENSOR_KINDS), table.choice("at", SENSOR_PLACES)
    return Sensor(channel, kind, at, sizes["resolution"], absolute, sizes["model_error"])


def read_controller(top: Table) -> PositionVelocityController | DeclaredCascade | None:
    """The declared controller of a plant file, SI; None where there is none.

    Raises:
        InputError: unknown key or kind, a value missing, without unit, or not above zero.
    """
    if "controller" not in top.entries:
        return None
    table = top.table("controller")
    if table.choice("kind") == "cascade":
        return DeclaredCascade({key: value for key, value in table.entries.items() if key != "kind"}, table.where)
    table = table.of_kind("position_velocity")
    table.refuse_undeclared()
    keys = ("position_gain", "velocity_gain", "output_limit", "torque_per_output")
    values = {key: table.positive(key, origin=f"controller.{key}") for key in keys}
    return PositionVelocityController(**values, velocity_samples=table.whole("velocity_samples"))


_HEAT_SENSOR_KEYS = ("channel", "kind", "at", "noise", "source")


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
        sensor = _heat_sensor(table)
        for other in sensors:
            if sensor.channel == other.channel or sensor.output == other.output:
                what = f"{sensor.channel} and {other.channel} are the same channel or the same place"
                raise InputError(what, table.where, "keep one of them")
        sensors.append(sensor)
    return tuple(sensors)


def _of_heat(channel: str) -> bool:
    return channel.endswith("_temperature") or channel.startswith("table_growth_")


def _heat_sensor(table: Table) -> HeatSensor:
    table.refuse_unknown(_HEAT_SENSOR_KEYS)
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
