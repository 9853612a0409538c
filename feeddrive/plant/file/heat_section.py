"""The thermal section of a plant file.

    [thermal]
    shaft_radius = "8 mm"                      # half the pitch circle's diameter, or the nominal radius
    shaft_length = "500 mm"
    nut_outer_radius = "20 mm"
    nut_length = "100 mm"
    travel = ["200 mm", "300 mm"]              # of the nut's centre, from the motor-side end, which is fixed
    growth_positions = ["200 mm", "250 mm"]    # where the growth of the table position is wanted
    conductivity = "50 W/(m K)"
    heat_capacity = "3.926e6 J/(m^3 K)"        # of volume
    expansion = "11.7e-6 1/K"
    contact_conductance = "1250 W/(m^2 K)"     # shaft to nut, at the preload
    preload = "1300 N"
    lead = "5 mm"                              # may be left out where [ball_screw] declares it
    ambient = "23 degC"
    highest_speed = "1500 rev/min"             # may be left out
    nut_heat_share = "1"                       # may be left out: share of the heat on the nut's side of the contact
    nut_end_share = "0"                        # may be left out: share of the nut's end faces that convects
    [thermal.film]
    screw = "11.52 W/(m^2 K)"                  # at 250 rev/min, growing with speed to the power 2/3
    screw_least = "5 W/(m^2 K)"
    nut_free = "4.857 W/(m^2 K)"
    nut_forced = "5.024 W/(m^2 K)"             # at 250 rev/min
    [thermal.nut]                              # also [thermal.front_bearing], [thermal.rear_bearing], with seat_length,
    load_torque = "96.2 mN m"                  # film W/(m^2 K) and end_share. Friction may be left out where the file
                                               # declares it as effects of its motion, and [thermal.coupling]
    viscous_factor = "10"                      # f0, of a nut times number of nuts and turns
    viscosity = "170 mm^2/s"
    mean_diameter = "16.75 mm"
    heat_share = "0.609"
    [[thermal.body]]                           # may be left out: motor, housing, table
    name = "motor"
    port = "front"                             # or "rear", "nut"
    capacity = "900 J/K"
    conductance = "0.5 W/K"                    # to the surface at the port
    to_air = "0.2 W/K"                         # may be left out
    [[sensor]]                                 # may be left out: all outputs under their default names
    channel = "nut_temperature"
    kind = "thermometer"                       # or "scale": growth of the table's position
    at = "nut"                                 # "front", "rear", "shaft"; of a scale the position of the nut, "200 mm"
    noise = "0.03 K"                           # may be left out: rms, else read off the recording
    [[effect]]                                 # any number, of the thermal effects that `feeddrive list` shows
    name = "motor_heat"
    power = "1.8 W"
    at_speed = "750 rev/min"

A file with `[thermal]` and no `structure` declares heat alone, no chain. Nothing in it is evaluated.

The coupling of heat and drive in a plant file that declares both.

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

import math
from collections.abc import Sequence
from dataclasses import fields
from typing import Any

from feeddrive.effects.base import Effect
from feeddrive.errors import InputError
from feeddrive.parts.lubricant import Lubricant
from feeddrive.plant.file.entries import Table, declares_heat_alone
from feeddrive.plant.file.equipment import read_heat_sensors
from feeddrive.thermal.laws.films import Films
from feeddrive.thermal.laws.friction import Friction, bearings_of, nut_of
from feeddrive.thermal.machine_heat import Heat
from feeddrive.thermal.rig import Body, Nut, Rig, Seat, Steel, Travel, refuse_unless
from feeddrive.thermal.thermal_coupling import Coupling, Spacer

SECTION = "thermal"
_LENGTHS = ("shaft_radius", "shaft_length", "nut_outer_radius", "nut_length")
_STEEL = {"conductivity": "W/(m K)", "heat_capacity": "J/(m^3 K)", "expansion": "1/K", "elasticity": "Pa"}
_OTHER = (
    "travel", "growth_positions", "contact_conductance", "preload", "lead", "ambient", "highest_speed",
    "nut_heat_share", "nut_end_share", "film", "nut", "front_bearing", "rear_bearing", "body", "coupling", "source",
)  # fmt: skip
_FRICTION = {"load_torque": "N m", "viscous_factor": "1", "viscosity": "m^2/s", "mean_diameter": "m", "heat_share": "1"}
_BODY = {"capacity": "J/K", "conductance": "W/K", "to_air": "W/K"}
_SEAT = {"seat_length": "m", "film": "W/(m^2 K)", "end_share": "1"}


def read_heat(top: Table, name: str, effects: Sequence[Effect], joint: Coupling | None) -> Heat | None:
    """What a plant file declares about heat; None where it declares nothing.

    Args:
        top: the whole file.
        name: where the file gives none.
        effects: that it declares; friction of a motion that is joined to the heat is declared by them.
        joint: how the two are joined, where they are.

    Raises:
        InputError: unknown key, a value that is missing, without unit, of another dimension or impossible.
    """
    if SECTION not in top.entries:
        return None
    table = top.table(SECTION)
    table.refuse_unknown((*_LENGTHS, *_STEEL, *_OTHER))
    sensors = read_heat_sensors(top)
    try:
        declared = _declared(top, table, effects, joint)
        return Heat(
            name=top.text("name", name),
            rig=_rig(table, tuple(sensor.at for sensor in sensors if isinstance(sensor.at, float))),
            films=Films(*(_value(table.table("film"), f.name, "W/(m^2 K)") for f in fields(Films))),
            contact=_value(table, "contact_conductance", "W/(m^2 K)"),
            preload=_value(table, "preload", "N"),
            lead=_lead(top, table),
            nut=_friction(table, "nut", ()) if "nut" in table.entries else declared[0] or _friction(table, "nut", ()),
            front=_bearing(table, "front_bearing") or declared[1],
            rear=_bearing(table, "rear_bearing") or declared[2],
            ambient=_value(table, "ambient", "degC"),
            highest_speed=_optional(table, "highest_speed", "rad/s", 1500 * math.pi / 30),
            bodies=tuple(_body(inner) for inner in table.tables("body")),
            sensors=sensors,
            origins=top.origins.found,
        )
    except InputError as error:
        # What the rig refuses is reported with the file and the section in front.
        inside = error.where.startswith(table.where)
        raise error if inside else InputError(error.what, f"{table.where}, {error.where}", error.mend) from None


def _declared(
    top: Table, table: Table, effects: Sequence[Effect], joint: Coupling | None
) -> tuple[Friction | None, Friction | None, Friction | None]:
    """Friction of nut, front and rear bearing that the file's own motion declares, where the two are coupled."""
    if joint is None or declares_heat_alone(top.entries):
        return None, None, None
    ambient = _value(table, "ambient", "degC")
    diameter = 2 * _value(table, "shaft_radius", "m")
    nut = nut_of(effects, joint, ambient, diameter, _lead(top, table))
    return nut, *bearings_of(effects, joint, ambient, diameter)


def _rig(table: Table, scales: tuple[float, ...]) -> Rig:
    lengths = {key: _value(table, key, "m") for key in _LENGTHS}
    steel = Steel(**{key: _optional(table, key, unit, getattr(Steel(), key)) for key, unit in _STEEL.items()})
    travel = _pair(table, "travel")
    positions = table.quantities("growth_positions", "m", "thermal.growth_positions")
    listed = positions if isinstance(positions, tuple) else (positions,)
    return Rig(
        radius=lengths["shaft_radius"],
        length=lengths["shaft_length"],
        nut=Nut(lengths["nut_outer_radius"], lengths["nut_length"], _optional(table, "nut_end_share", "1", 0.0)),
        travel=Travel(*travel),
        front=_seat(table, "front_bearing"),
        rear=_seat(table, "rear_bearing"),
        steel=steel,
        nut_heat_share=_optional(table, "nut_heat_share", "1", 1.0),
        growth_positions=(*listed, *(x for x in scales if not any(math.isclose(x, other) for other in listed))),
    )


def _pair(table: Table, key: str) -> tuple[float, float]:
    ends = table.quantities(key, "m", f"thermal.{key}")
    pair = isinstance(ends, tuple) and len(ends) == 2
    refuse_unless(pair, "is not a pair of places", table.place(key), f'write e.g. {key} = ["200 mm", "300 mm"]')
    assert isinstance(ends, tuple)
    return ends[0], ends[1]


def _lead(top: Table, table: Table) -> float:
    """[m/rad]."""
    screw = top.table("ball_screw")
    where = table if "lead" in table.entries or "lead" not in screw.entries else screw
    return where.quantity("lead", "m", "thermal.lead") / (2 * math.pi)


def _friction(table: Table, key: str, others: tuple[str, ...]) -> Friction:
    inner = table.table(key)
    inner.refuse_unknown((*_FRICTION, *others, "source"))
    share = _optional(inner, "heat_share", "1", 1.0)
    wanted = {name: unit for name, unit in _FRICTION.items() if name != "heat_share"}
    return Friction(**{name: _value(inner, name, unit) for name, unit in wanted.items()}, heat_share=share)


def _bearing(table: Table, key: str) -> Friction | None:
    """Friction of a bearing; None where the file declares none, or only its seat."""
    inner = table.table(key)
    if not any(name in inner.entries for name in _FRICTION):
        inner.refuse_unknown((*_SEAT, *_FRICTION, "source"))
        return None
    return _friction(table, key, tuple(_SEAT))


def _seat(table: Table, key: str) -> Seat:
    inner = table.table(key)
    film = _value(inner, "film", _SEAT["film"]) if "film" in inner.entries else None
    length = _optional(inner, "seat_length", "m", Seat().length)
    return Seat(length, film, _optional(inner, "end_share", "1", 0.0))


def _body(table: Table) -> Body:
    table.refuse_unknown(("name", "port", "source", *_BODY))
    port = table.choice("port", ("front", "rear", "nut"))
    values = {key: _value(table, key, unit) for key, unit in _BODY.items() if key != "to_air" or key in table.entries}
    return Body(table.text("name"), port, **values)


def _value(table: Table, key: str, unit: str) -> float:
    return table.quantity(key, unit, f"{SECTION}.{key}")


def _optional(table: Table, key: str, unit: str, default: float) -> float:
    return _value(table, key, unit) if key in table.entries else default


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
