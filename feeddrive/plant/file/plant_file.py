"""Plant files: a machine written down, every number with its unit and, where known, its source.

    format = "feeddrive-plant/1"
    name = "bench axis"
    structure = "three_inertias"     # "rigid": without [transmission], inertias may be left out; "distributed_screw"
    source = "data sheet"            # of every value that names none itself; also inside a table

    [motor]
    inertia = "2.6e-3 kg m^2"
    torque_limit = "30 N m"          # may be left out
    torque_constant = "1.2 N m/A"    # may be left out; where a recording holds the current and no torque
    [ball_screw]
    lead = { value = "20 mm", source = "measured", tolerance = "0.1 %" }
    inertia = "2.37e-3 kg m^2"
    [transmission]
    torsional_stiffness = "11982.4 N m/rad"
    torsional_damping = "0.074 N m s/rad"
    axial_stiffness = "244.7 N/µm"
    axial_damping = "8650 N s/m"
    ratio = 1.5                      # motor turns per screw turn; may be left out: direct
    [table]
    mass = "134 kg"
    [[effect]]                       # any number; `feeddrive list` shows names, ports and keys
    name = "guide_friction"
    port = "table"                   # may be left out where there is only one, or for the first
    coulomb = "60 N"
    smoothing_velocity = "0.5 mm/s"
    [[sensor]]
    channel = "motor_angle"
    kind = "encoder"                 # encoder, scale, tachometer, current
    at = "motor"                     # motor, screw, table
    resolution = "1.5 µrad"          # may be left out
    absolute = true                   # its zero is kept from recording to recording; may be left out
    [controller]
    kind = "position_velocity"
    position_gain = "160 1/s"
    velocity_gain = "240 V s/m"
    output_limit = "10 V"
    torque_per_output = "0.014 N m/V"
    velocity_samples = 2             # velocity from the position over so many samples; left out: velocity itself
    # or kind = "cascade", with the keys of a controller file (`feeddrive.simulate.scenario.scenario_controller`)

A machine may be described by its parts instead (`feeddrive.plant.file.drive_sections`): their stiffness and inertia are
computed, and a value of the chain that is written takes the place of the computed one. Further, for every structure:

    [table]
    stroke = ["0 mm", "500 mm"]      # least and greatest table position
    first_nut_position = "150 mm"    # nut from the bearing at the motor's end where the table is at 0
    inclination = "90 deg"           # of the + direction above the horizontal: the weight acts
    counterbalance = "1200 N"        # against the weight
    [damping]                        # in place of the dampers
    ratio = 0.02                     # at `frequency`, or at the first mode with the motor free
    [guide]                          # guide_friction from catalogue data
    carriage = "HSR-30R"
    carriages = 4
    seal_drag = "8 N"                # of one

and ratings for plausibility rules (`feeddrive.plant.file.ratings`). Heat is declared in `[thermal]`
(`feeddrive.plant.file.heat_section`), beside the motion or, in a file without `structure`, alone. Nothing in the
file is evaluated.
"""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from feeddrive.errors import InputError, ValidityWarning
from feeddrive.plant.chain.chain import CHAINS, Chain, DistributedScrew, Rigid, ThreeInertias
from feeddrive.plant.composition import refuse_what_cannot_compose
from feeddrive.plant.file.chain_sections import read_chain
from feeddrive.plant.file.drive_sections import PART_VALUES, describes_parts
from feeddrive.plant.file.effect_sections import read_effects
from feeddrive.plant.file.equipment import read_controller, read_sensors
from feeddrive.plant.file.guide_section import WEIGHT_KEYS, derived_effects
from feeddrive.plant.file.heat_section import read_both_ends, read_coupling, read_heat
from feeddrive.plant.file.plant_schema import NAMED_PARTS, plant_table
from feeddrive.plant.file.ratings import RATINGS, declares_heat_alone, read_data, read_stroke
from feeddrive.plant.motor_torque import TorqueGain
from feeddrive.plant.passive_friction import refuse_active_friction
from feeddrive.plant.plant import Plant
from feeddrive.schema.table import Table
from feeddrive.schema.toml_text import read_toml, refuse_other_format
from feeddrive.units.quantity import format_quantity

FORMAT = "feeddrive-plant/1"
_TOP_OF_HEAT_ALONE = ("format", "name", "source", "description", "ball_screw", "effect", "sensor", "thermal")
_SECTIONS = (
    "motor",
    "ball_screw",
    "transmission",
    "table",
    "brake",
    "coupling",
    "belt",
    "gear",
    "support",
    "nut",
    "damping",
)


def read_plant(path: Path) -> Plant:
    """Read a plant file.

    Args:
        path: of the file.

    Returns:
        The plant, values in SI; `origins` names the source of each value that has one: chain values and
        `torque_limit` by key, effects as `label.key`, the controller as `controller.key`, parts as `section.key`.
        Values computed from parts are marked so.

    Raises:
        InputError: not found, not TOML, another format, unknown key or name, a value that is missing, without unit,
            of another dimension or impossible, effects that cannot act together.

    Warns:
        ValidityWarning: a value far outside what is usual.
    """
    return plant_from_entries(read_toml(path, "plant file"), path)


def plant_from_entries(entries: Mapping[str, Any], path: Path) -> Plant:
    """The plant of a file that is parsed already, values perhaps put in; else as `read_plant`.

    Args:
        entries: of the file.
        path: of the file, for messages and the name.
    """
    where = str(path)
    refuse_other_format(entries, FORMAT, where)
    top = plant_table(entries, where)
    top.text("description", "")
    moving = not declares_heat_alone(entries)
    if moving:
        named = [one.get("name") for one in top.entries.get("effect", []) if isinstance(one, dict)]
        top.refuse_undeclared({one: f"it is an effect: write effect.{one}" for one in named if isinstance(one, str)})
        _refuse_unknown_keys(top)
    else:
        top.refuse_unknown(_TOP_OF_HEAT_ALONE)
    chain, drive = read_chain(top) if moving else (None, None)
    motor = top.table("motor")
    limit = motor.positive("torque_limit", "N m", "torque_limit") if "torque_limit" in motor.entries else float("inf")
    constant = "torque_constant"
    per_ampere = motor.positive(constant, "N m/A", constant) if constant in motor.entries else None
    declared = read_effects(top)
    factor = motor.positive("torque_factor", "1", "torque_factor") if "torque_factor" in motor.entries else 1.0
    scaled = (TorqueGain.of(gain=1 / factor),) if factor != 1.0 else ()
    effects = (*declared, *derived_effects(top, declared), *scaled)
    if chain is not None:
        refuse_what_cannot_compose(effects, chain.elastic, top.where)
    joint = read_coupling(top)
    plant = Plant(
        name=top.text("name", path.stem),
        mechanics=chain,
        effects=effects,
        torque_limit=limit,
        sensors=read_sensors(top),
        controller=read_controller(top),
        stroke=read_stroke(top),
        drive=drive,
        data=read_data(top),
        origins=top.origins.found,
        torque_constant=per_ampere,
        network=read_heat(top, path.stem, effects, joint, read_both_ends(top, chain, drive)),
        joint=joint,
    )
    if chain is not None:
        _refuse_moving_mass(plant, where)
        refuse_active_friction(plant, where)
        _refuse_stroke_off_screw(plant, where)
        _warn_of_unusual(chain, where)
    return plant


def _refuse_unknown_keys(top: Table) -> None:
    """Refuse keys that nothing reads; the message tells where they would have a meaning."""
    structure = CHAINS[top.choice("structure", CHAINS)]
    parts = describes_parts(top)
    if structure is Rigid and (parts or "damping" in top.entries):
        mend = "leave its sections out, or use another structure"
        raise InputError("a rigid machine has neither springs nor dampers", top.where, mend)
    for section in _SECTIONS:
        known = [value.section_key for value in (*structure.required, *structure.optional) if value.section == section]
        known += [value.key for value in RATINGS.get(section, ())]
        if parts:
            known += [value.key for value in PART_VALUES.get(section, ())]
            known += ["part"] if section in NAMED_PARTS else []
        elsewhere = {
            value.section_key: f'leave it out, or use structure = "{other.structure}"'
            for other in CHAINS.values()
            for value in (*other.required, *other.optional)
            if value.section == section
        }
        further = _further(section, structure, parts)
        top.table(section).refuse_unknown((*known, *further, "source"), elsewhere)


def _further(section: str, structure: type[Chain], parts: bool) -> tuple[str, ...]:
    """Keys of a section that are neither values of a chain nor of a part, where something reads them."""
    placed = structure is DistributedScrew or parts
    keys = {
        "motor": ("torque_limit", "torque_constant", "torque_factor"),
        "ball_screw": ("elements",) if structure is DistributedScrew else (),
        "transmission": ("nut_position",) if structure is ThreeInertias and parts else (),
        "table": ("stroke", *WEIGHT_KEYS, *(("first_nut_position",) if placed else ())),
        "support": ("kind",) if parts else (),
        "damping": ("ratio", "frequency"),
    }
    return keys.get(section, ())


def _refuse_moving_mass(plant: Plant, where: str) -> None:
    """Refuse a payload that takes away the whole table; here and not in `Plant`, for a fit may pass through it."""
    mass = plant.chain_values()["table_mass"]
    if mass <= 0:
        what = f"table mass with the payload is {format_quantity(mass, 'kg')}"
        raise InputError(what, where, "write a payload that leaves it above zero")


def _refuse_stroke_off_screw(plant: Plant, where: str) -> None:
    for position in plant.stroke or ():
        plant.chain.refuse_off_screw(position, f"{where}, table.stroke")


def _warn_of_unusual(chain: Chain, where: str) -> None:
    for value in chain.required:
        if value.usual is None:
            continue
        low, high = value.usual
        number = chain.values[value.key]
        if number != 0 and not low <= number <= high:
            place = f"{where}, {value.section}.{value.section_key}"
            shown = format_quantity(number, value.unit)
            usual = " to ".join(format_quantity(end, value.unit) for end in (low, high))
            text = f"{place}: {shown} is unusual, {usual} is usual; check its unit"
            warnings.warn(text, ValidityWarning, stacklevel=3)
