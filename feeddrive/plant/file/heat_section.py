"""The thermal section of a plant file.

    [thermal]
    shaft_radius = "8 mm"                      # half the pitch circle's diameter, or the nominal radius
    shaft_length = "500 mm"
    nut_outer_radius = "20 mm"
    nut_length = "100 mm"
    travel = ["200 mm", "300 mm"]              # of the nut's centre, from the motor-side end, which is held
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

A file with `[thermal]` and no `structure` declares heat alone, no chain; its screw is held at the motor-side end alone.
Where the machine's own bearings hold the screw at both ends (fixed-fixed), it grows between them. Nothing is evaluated.

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
from feeddrive.parts.bearings.supports import Support
from feeddrive.parts.lubricant import Lubricant
from feeddrive.parts.screw.screw_drive import BallScrewDrive
from feeddrive.plant.chain.chain import Chain
from feeddrive.plant.chain.distributed_screw import DistributedScrew
from feeddrive.plant.file.equipment import read_heat_sensors
from feeddrive.plant.file.ratings import declares_heat_alone
from feeddrive.schema.table import Table
from feeddrive.thermal.laws.films import Films
from feeddrive.thermal.laws.friction import Friction, bearings_of, nut_of
from feeddrive.thermal.machine_heat import Heat
from feeddrive.thermal.rig import Body, BothEnds, Nut, Rig, Seat, Steel, Travel, refuse_unless
from feeddrive.thermal.thermal_coupling import Coupling, Spacer

SECTION = "thermal"
_LENGTHS = ("shaft_radius", "shaft_length", "nut_outer_radius", "nut_length")
_FRICTION = ("load_torque", "viscous_factor", "viscosity", "mean_diameter")


def read_heat(
    top: Table, name: str, effects: Sequence[Effect], joint: Coupling | None, both_ends: BothEnds | None = None
) -> Heat | None:
    """What a plant file declares about heat; None where it declares nothing.

    Args:
        top: the whole file.
        name: where the file gives none.
        effects: that it declares; friction of a motion that is joined to the heat is declared by them.
        joint: how the two are joined, where they are.
        both_ends: what holds its screw at both ends; None where the bearing at the motor alone does.

    Raises:
        InputError: unknown key, a value that is missing, without unit, of another dimension or impossible.
    """
    if SECTION not in top.entries:
        return None
    table = top.table(SECTION)
    table.refuse_undeclared()
    sensors = read_heat_sensors(top)
    try:
        declared = _declared(top, table, effects, joint)
        return Heat(
            name=top.text("name", name),
            rig=_rig(table, tuple(sensor.at for sensor in sensors if isinstance(sensor.at, float)), both_ends),
            films=Films(*(_value(table.table("film"), f.name) for f in fields(Films))),
            contact=_value(table, "contact_conductance"),
            preload=_value(table, "preload"),
            lead=_lead(top, table),
            nut=_friction(table, "nut") if "nut" in table.entries else declared[0] or _friction(table, "nut"),
            front=_bearing(table, "front_bearing") or declared[1],
            rear=_bearing(table, "rear_bearing") or declared[2],
            ambient=_value(table, "ambient"),
            highest_speed=_optional(table, "highest_speed"),
            bodies=tuple(_body(inner) for inner in table.tables("body")),
            sensors=sensors,
            origins=top.origins.found,
        )
    except InputError as error:
        # What the rig refuses is reported with the file and the section in front.
        inside = error.where.startswith(table.where)
        raise error if inside else InputError(error.what, f"{table.where}, {error.where}", error.mend) from None


def read_both_ends(top: Table, chain: Chain | None, drive: BallScrewDrive | None) -> BothEnds | None:
    """What holds the screw of a file with [thermal] at both ends; None where its front bearing alone does.

    The chain is None where the file declares heat alone. Raises InputError for bearings that take thrust one way each:
    the file does not say whether they let the screw grow.
    """
    if SECTION not in top.entries:
        return None
    if drive is not None:
        supports = drive.supports
        if supports.kind is Support.SUPPORTED_SUPPORTED:
            what = "bearings that take thrust one way each hold a warm screw or let it grow, by the way they face"
            mend = f'write "{Support.FIXED_FIXED.value}" if they hold it, "{Support.FIXED_SUPPORTED.value}" if not'
            raise InputError(f"{what}, which [{SECTION}] has to know", f"{top.where}, support.kind", mend)
        far = supports.far.axial_stiffness if supports.far is not None else 0.0
        near, rigidity = supports.near.axial_stiffness, drive.screw.axial_rigidity
    elif isinstance(chain, DistributedScrew):
        near, far, rigidity = (
            chain.values[k] for k in ("bearing_stiffness", "far_bearing_stiffness", "axial_rigidity")
        )
    else:
        return None
    return BothEnds(near, far, rigidity) if near > 0 and far > 0 else None


def _declared(
    top: Table, table: Table, effects: Sequence[Effect], joint: Coupling | None
) -> tuple[Friction | None, Friction | None, Friction | None]:
    """Friction of nut, front and rear bearing that the file's own motion declares, where the two are coupled."""
    if joint is None or declares_heat_alone(top.entries):
        return None, None, None
    ambient = _value(table, "ambient")
    diameter = 2 * _value(table, "shaft_radius")
    nut = nut_of(effects, joint, ambient, diameter, _lead(top, table))
    return nut, *bearings_of(effects, joint, ambient, diameter)


def _rig(table: Table, scales: tuple[float, ...], both_ends: BothEnds | None) -> Rig:
    lengths = {key: _value(table, key) for key in _LENGTHS}
    steel = Steel(**{f.name: _optional(table, f.name) for f in fields(Steel)})
    travel = _pair(table, "travel")
    positions = table.quantities("growth_positions", "m", "thermal.growth_positions")
    listed = positions if isinstance(positions, tuple) else (positions,)
    return Rig(
        radius=lengths["shaft_radius"],
        length=lengths["shaft_length"],
        nut=Nut(lengths["nut_outer_radius"], lengths["nut_length"], _optional(table, "nut_end_share")),
        travel=Travel(*travel),
        front=_seat(table, "front_bearing"),
        rear=_seat(table, "rear_bearing"),
        steel=steel,
        nut_heat_share=_optional(table, "nut_heat_share"),
        growth_positions=(*listed, *(x for x in scales if not any(math.isclose(x, other) for other in listed))),
        both_ends=both_ends,
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


def _friction(table: Table, key: str) -> Friction:
    inner = table.table(key)
    inner.refuse_undeclared()
    return Friction(**{name: _value(inner, name) for name in _FRICTION}, heat_share=_optional(inner, "heat_share"))


def _bearing(table: Table, key: str) -> Friction | None:
    """Friction of a bearing; None where the file declares none, or only its seat."""
    inner = table.table(key)
    inner.refuse_undeclared()
    declared = any(name in inner.entries for name in (*_FRICTION, "heat_share"))
    return _friction(table, key) if declared else None


def _seat(table: Table, key: str) -> Seat:
    inner = table.table(key)
    film = _value(inner, "film") if "film" in inner.entries else None
    length = inner.optional("seat_length", Seat().length, f"{SECTION}.seat_length")
    return Seat(length, film, _optional(inner, "end_share"))


def _body(table: Table) -> Body:
    table.refuse_undeclared()
    keys = ("capacity", "conductance", *(("to_air",) if "to_air" in table.entries else ()))
    return Body(table.text("name"), table.choice("port"), **{key: _value(table, key) for key in keys})


def _value(table: Table, key: str) -> float:
    return table.quantity(key, origin=f"{SECTION}.{key}")


def _optional(table: Table, key: str) -> float:
    return table.optional(key, origin=f"{SECTION}.{key}")


_SPACERS = {spacer.name.lower(): spacer for spacer in Spacer}


def read_coupling(top: Table) -> Coupling | None:
    """The coupling that a whole plant file declares; None where it declares none.

    Raises InputError: unknown key, a value that is missing, without unit or impossible.
    """
    thermal = top.table("thermal")
    if "coupling" not in thermal.entries:
        return None
    table = thermal.table("coupling")
    table.refuse_undeclared()
    oil = _oil(table, "nut_oil")
    try:
        return Coupling(
            nut_oil=oil,
            bearing_oil=_oil(table, "bearing_oil") if "bearing_oil" in table.entries else oil,
            spacer=_SPACERS[table.choice("spacer")],
            guide_heat_to=table.text("guide_heat_to", ""),
            **_numbers(table),
        )
    except InputError as error:
        inside = error.where.startswith(top.where)
        raise error if inside else InputError(error.what, f"{top.where}, {error.where}", error.mend) from None


def _numbers(table: Table) -> dict[str, Any]:
    given = [key for key in ("rear_share", "motor_constant") if key in table.entries]
    keys = ("nut_at_zero", "nut_stiffness", "group_distance", "contact_angle", *given)
    return {key: table.quantity(key, origin=f"thermal.coupling.{key}") for key in keys}


def _oil(table: Table, key: str) -> Lubricant:
    inner = table.table(key)
    inner.refuse_undeclared()
    return Lubricant(*(inner.quantity(f"viscosity_{at}", origin=f"thermal.coupling.{key}.{at}") for at in (40, 100)))
