"""Summary of the heat of a machine: geometry, films, heats, time constants, sensors."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from feeddrive.interface.shown import Listing, Shown, write_json
from feeddrive.thermal.machine_heat import Heat, HeatSensor
from feeddrive.thermal.run.heat_figures import HeatRow, heat_rows
from feeddrive.units.quantity import format_quantity


@dataclass(frozen=True, repr=False, eq=False)
class HeatSummary(Shown):
    """Values with their sources, films, heats, time constants and sensors of the heat of a machine.

    Attributes:
        heat: of the machine.
    """

    heat: Heat

    def listing(self) -> Listing:
        """The declared values."""
        return self.tables()[0]

    def tables(self) -> tuple[Listing, ...]:
        """Every table; those without rows are left out."""
        heat, found = self.heat, heat_rows(self.heat)
        values = [[key, format_quantity(value, unit), source] for key, value, unit, source in self._values()]
        records = [{"value": key, "quantity": v, "unit": unit, "source": s} for key, v, unit, s in self._values()]
        tables = (
            Listing(f"{heat.name}, heat", ("quantity", "value", "source"), values, records),
            Listing(
                "Films, contact and heats, effects not counted",
                ("speed", "film of screw", "of nut", "contact", "heat of nut", "front bearing", "rear"),
                [_heats(row) for row in found],
            ),
            Listing(
                "Settled, and slowest time constants",
                ("speed", "rise of nut", "of front end", "growth", *(f"τ{i}" for i in (1, 2, 3))),
                [_settled(row) for row in found],
            ),
            Listing("Sensors", ("channel", "kind", "at", "noise"), [_sensor(sensor) for sensor in heat.sensors]),
        )
        return tuple(one for one in tables if one.rows)

    def record(self) -> dict[str, Any]:
        """Everything as plain values, SI, of a machine that declares heat alone."""
        named = {"format": "feeddrive-show/1", "name": self.heat.name, "structure": "heat alone"}
        return {**named, **self.declared()}

    not_drawn = ()
    """Heat alone has no figure to draw."""

    def save(self, folder: str | Path) -> Path:
        """Write `show.json`.

        Raises:
            InputError: the folder cannot be written.
        """
        write_json(self.record(), Path(folder) / "show.json")
        return Path(folder)

    def declared(self) -> dict[str, Any]:
        """The heat as plain values, SI."""
        heat = self.heat
        return {
            "values": {key: {"value": v, "unit": unit, "source": source} for key, v, unit, source in self._values()},
            "speeds": [asdict(row) for row in heat_rows(heat)],
            "bodies": [asdict(body) for body in heat.bodies],
            "sensors": [asdict(sensor) for sensor in heat.sensors],
        }

    def _values(self) -> list[tuple[str, float, str, str]]:
        """Key, SI value, unit and source."""
        heat, rig, steel = self.heat, self.heat.rig, self.heat.rig.steel
        found = {
            "shaft_radius": (rig.radius, "m"),
            "shaft_length": (rig.length, "m"),
            "nut_outer_radius": (rig.nut.outer_radius, "m"),
            "nut_length": (rig.nut.length, "m"),
            "travel.low": (rig.travel.low, "m"),
            "travel.high": (rig.travel.high, "m"),
            "conductivity": (steel.conductivity, "W/(m K)"),
            "heat_capacity": (steel.heat_capacity, "J/(m^3 K)"),
            "expansion": (steel.expansion, "1/K"),
            "contact_conductance": (heat.contact, "W/(m^2 K)"),
            "preload": (heat.preload, "N"),
            "lead": (2 * math.pi * heat.lead, "m"),
            "highest_speed": (heat.highest_speed, "rad/s"),
            "nut.load_torque": (heat.nut.load_torque, "N m"),
            "nut.heat_share": (heat.nut.heat_share, "1"),
        }
        rows = [(f"thermal.{key}", v, unit, heat.origins.get(_origin(key), "")) for key, (v, unit) in found.items()]
        for effect in heat.effects:
            for parameter in effect.parameters:
                value = effect.values.get(parameter.key)
                if isinstance(value, float):
                    key = f"{effect.label}.{parameter.key}"
                    rows.append((key, value, parameter.unit, heat.origins.get(key, effect.place)))
        return rows


def _origin(key: str) -> str:
    """Key under which the reading of the file notes the source."""
    first, _, second = key.partition(".")
    return f"thermal.{second if first == 'nut' else first}"


def _heats(row: HeatRow) -> list[str]:
    films = [format_quantity(value, "W/(m^2 K)") for value in (row.screw_film, row.nut_film, row.contact)]
    heats = [format_quantity(value, "W") for value in (row.nut_heat, row.front_heat, row.rear_heat)]
    return [format_quantity(row.speed, "rad/s"), *films, *heats]


def _settled(row: HeatRow) -> list[str]:
    rises = [f"{value:.2f} K" for value in (row.nut_rise, row.end_rise)]
    times = [f"{value / 60:.1f} min" for value in row.time_constants]
    return [format_quantity(row.speed, "rad/s"), *rises, f"{row.growth * 1e6:.1f} µm", *times]


def _sensor(sensor: HeatSensor) -> list[str]:
    at = format_quantity(sensor.at, "m") if isinstance(sensor.at, float) else sensor.at
    unit = "m" if isinstance(sensor.at, float) else "K"
    return [sensor.channel, sensor.kind, at, format_quantity(sensor.noise, unit) if sensor.noise else "read off"]
