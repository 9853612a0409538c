"""Every key of a plant file: values of chains, parts, ratings and effects as they declare themselves, and the rest.

The readers of this package get their tables with these sections (`plant_table`), so that nothing is read that is not
declared here. The meaning of an effect's key stands in the table of symbols of its module.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import Any

from feeddrive.effects.base import Effect, Parameter
from feeddrive.effects.catalogue import EFFECTS, THERMAL_EFFECTS
from feeddrive.parts.guide.guide_geometry import GUIDE_VALUES
from feeddrive.parts.screw.ball_screw import STEEL
from feeddrive.parts.values import PartValue
from feeddrive.plant.chain.chain import CHAINS
from feeddrive.plant.file.drive_sections import BEARING_VALUES, PART_VALUES
from feeddrive.plant.file.named_parts import with_named_parts
from feeddrive.plant.file.ratings import RATINGS
from feeddrive.schema.controller import DECLARED_CONTROLLER
from feeddrive.schema.heat import THERMAL
from feeddrive.schema.key import SOURCE, Key, Kind
from feeddrive.schema.key import keys as keys_of
from feeddrive.schema.section import Section, keyed, sections
from feeddrive.schema.table import Table, whole_file
from feeddrive.units.quantity import format_quantity

OF_PARTS = "in a machine described by its parts, with [support], [bearing.near] and [nut]"
_PLACED = 'with structure = "distributed_screw", or in a machine described by its parts'
_NEEDED_PARTS = {
    "motor": ("rotor_inertia", "torque_limit"),
    "ball_screw": ("lead", "diameter", "length"),
    "table": ("mass",),
}
_STEEL = {"young": STEEL.young, "shear": STEEL.shear, "density": STEEL.density, "expansion": STEEL.expansion}

_MEANINGS = {
    "motor": "the motor, and what turns with it",
    "brake": "a brake that holds the motor while it is off",
    "coupling": "the coupling between motor and screw",
    "belt": "a belt between motor and screw",
    "gear": "a gear between motor and screw",
    "ball_screw": "the screw",
    "transmission": "stiffness and damping between motor and table",
    "support": "how the screw is held",
    "nut": "the nut",
    "table": "the table and what moves with it",
    "damping": "damping in place of single dampers",
}

_FURTHER: dict[str, str] = {
    "motor": """
torque_limit | N m | > 0 | | peak torque of the motor
torque_constant | N m/A | > 0 | | torque per current, where a recording holds the current
torque_factor | 1 | > 0 | = 1 | torque that acts over torque that the drive records
""",
    "ball_screw": """
elements | whole | [1, 2] | = 1 | of the main span: 1 or 2 | with structure = "distributed_screw"
""",
    "transmission": """
nut_position | m | | | from the near bearing, where stiffness is computed; mid-stroke if left out | \
with structure = "three_inertias" in a machine described by its parts
""",
    "support": f"""
kind | text | fixed-free, fixed-supported, supported-supported, fixed-fixed | required | \
near end and far end of the screw | {OF_PARTS}
""",
    "table": f"""
stroke | m list | | | least and greatest table position
inclination | rad | [{-math.pi / 2}, {math.pi / 2}] | | of the + direction above the horizontal
counterbalance | N | | | force against the weight; with inclination
first_nut_position | m | | = 0 m | nut from the near bearing where the table is at 0 | {_PLACED}
""",
    "damping": """
ratio | 1 | [0, 1] usual 0.01 to 0.05 | | damping ratio
frequency | Hz | > 0 | | at which the ratio is meant; the first mode with the motor free if left out
""",
}


def _part_key(section: str, value: PartValue, when: str) -> Key:
    """The key of a value that a part declares."""
    default = f"{_STEEL[value.key]:g} {value.unit}" if value.key in _STEEL and section == "ball_screw" else None
    if value.default is not None:
        default = format_quantity(value.default, value.unit)
    required = value.key in _NEEDED_PARTS.get(section, ()) or (
        section in ("brake", "coupling", "belt", "gear") and value.default is None
    )
    return Key(
        value.key, value.meaning, value.unit, minimum=value.minimum, maximum=value.maximum,
        open_ends=value.open_ends, usual=value.usual, default=default, required=required, when=when,
    )  # fmt: skip


def _chain_keys(section: str) -> list[Key]:
    """Values of chains in a section, each with the structures that have it."""
    found: dict[str, Key] = {}
    structures: dict[str, list[str]] = {}
    for structure in CHAINS.values():
        for value in (*structure.required, *structure.optional):
            if value.section != section:
                continue
            name = value.section_key
            structures.setdefault(name, []).append(f'"{structure.structure}"')
            key = Key(name, value.meaning, value.unit, minimum=0.0, open_ends=not value.may_be_zero, usual=value.usual)
            found.setdefault(name, key)
    alone = {name: f"with structure = {' or '.join(held)}" for name, held in structures.items()}
    return [
        replace(key, when="" if len(structures[name]) == len(CHAINS) else alone[name]) for name, key in found.items()
    ]


def _section(name: str) -> Section:
    """One of the sections of motion."""
    chain = _chain_keys(name)
    parts = [_part_key(name, value, OF_PARTS) for value in PART_VALUES.get(name, ())]
    ratings = [replace(_part_key(name, value, ""), required=False) for value in RATINGS.get(name, ())]
    named = keys_of(_PART) if name in NAMED_PARTS else ()
    both = {key.name for key in chain} & {key.name for key in parts}
    further = keys_of(_FURTHER.get(name, ""))
    keys = [*further, *(key for key in chain if key.name not in both), *parts, *ratings]
    if name == "table":
        keys = [replace(key, required=key.name == "mass") if key.name == "mass" else key for key in keys]
    open_to_all = {key.name for key in ratings} | both - {key.name for key in chain if key.when}
    keys = [replace(key, when="") if key.name in open_to_all else key for key in keys]
    return Section(f"plant.{name}", _MEANINGS[name], keyed(*named, *keys, *keys_of(SOURCE)))


NAMED_PARTS = ("motor", "coupling", "ball_screw", "nut", "bearing")
"""Sections that may name a part of the catalogue."""


_PART = f"part | text | | | of the catalogue (`feeddrive parts`); gives the values that are left out here | {OF_PARTS}"


def _bearing() -> Section:
    ends = {}
    for end, meaning in (("near", "bearing at the motor's end"), ("far", "bearing at the far end")):
        keys = [_part_key("bearing", value, "") for value in BEARING_VALUES]
        keys = [replace(key, required=key.name == "axial_stiffness") for key in keys]
        (named,) = keys_of(_PART)
        ends[end] = Section(f"plant.bearing.{end}", meaning, keyed(replace(named, when=""), *keys, *keys_of(SOURCE)))
    return Section("plant.bearing", "the bearings of the screw", keyed(*keys_of(SOURCE)), ends)


def _guide() -> Section:
    catalogue = "with a carriage of the catalogue"
    guide = sections(f"""
[plant.guide] carriages under the table, from which guide friction follows
carriage | text | | | a known one (`feeddrive parts guide`), or its geometry in place of the name
carriages | whole | [1, 1000] | required | how many
seal_drag | N | >= 0 usual 0 to 100 | | of the seals of one carriage; 0 or the catalogue's if left out
load | N | | | vertical load of one carriage; the table's weight, shared evenly, if left out
coefficients | text | A, B | = A | of rolling and slip | with a geometry
smoothing_velocity | m/s | >= 0 | = 0.5 mm/s | where the friction turns
friction_factor | 1 | > 0 usual 0.3 to 3 | = 1 | level of the friction that acts, over that computed from the carriages
preload_class | text | | | as the catalogue calls it; its lightest if left out | {catalogue}
preload | N | >= 0 | | of one carriage, in place of that of the class | {catalogue}
friction_coefficient | 1 | [0, 0.1] | | force over load; the catalogue's if left out | {catalogue}
""")
    geometry = [_part_key("guide", value, "where no carriage is named") for value in GUIDE_VALUES]
    counted = [replace(key, kind=Kind.WHOLE) if key.name == "balls_per_row" else key for key in geometry]
    return replace(guide, keys={**guide.keys, **keyed(*counted, *keys_of(SOURCE))})


SENSOR = sections(f"""
[[plant.sensor]] one sensor
channel | text | | required | canonical name of what it reads
kind | text | encoder, scale, tachometer, current, thermometer | required | of sensor
at | text | | required | motor, screw or table; of a thermometer front, rear, nut or shaft; of a growth scale \
the nut's position
resolution | | >= 0 | | smallest step, in the unit of the channel
noise | | >= 0 | | rms of a thermometer or a growth scale; read off the recording if left out
absolute | switch | | = false | whether its zero is the same in every recording, so that an offset that moves is growth
model_error | | >= 0 | | rms of what this plant may miss of a channel of motion, in its unit; nothing within it is a \
finding
{SOURCE}
""")


def meaning_of(effect: type[Effect], key: str) -> str:
    """What a parameter of an effect means: the row of its key in the table of symbols of the effect's module.

    A row may hold several keys (`coulomb, viscous`); its meaning is then that of all of them.
    """
    text = sys.modules[effect.__module__].__doc__ or ""
    for line in text.splitlines():
        cells = [cell.strip() for cell in line.strip().strip("|").split("|")] if line.lstrip().startswith("|") else []
        if len(cells) >= 3 and any(key in cell.replace(",", " ").split() for cell in cells[:2]):
            return cells[-2]
    return ""


def _parameter_key(effect: type[Effect], parameter: Parameter) -> Key:
    along = getattr(effect, "stroke_keys", ())
    default = None if parameter.default is None else format_quantity(parameter.default, parameter.unit)
    if parameter.table and parameter.default is not None:
        default = None
    return Key(
        parameter.key,
        meaning_of(effect, parameter.key),
        parameter.unit,
        Kind.QUANTITIES if parameter.table else Kind.QUANTITY,
        parameter.minimum,
        parameter.maximum,
        default=default,
        required=parameter.default is None and parameter.key not in along,
    )


def _effect(known: Iterable[type[Effect]]) -> Section:
    kinds = {}
    for effect in known:
        place = []
        if effect.place_key:
            place = [Key(effect.place_key, "what it acts on", kind=Kind.TEXT, choices=effect.places,
                         default=effect.default_place or None, required=not effect.default_place)]  # fmt: skip
        keys = [_parameter_key(effect, parameter) for parameter in effect.parameters]
        meaning = (effect.__doc__ or "").strip().splitlines()[0].rstrip(".")
        kinds[effect.name] = Section(f"plant.effect.{effect.name}", meaning, keyed(*place, *keys))
    declared = sections(f"""
[[plant.effect]] one effect
name | text | | required | of the effect (`feeddrive list`)
port | text | motor, screw, transmission, table, sensor, thermal | | where it acts; its first possible one if left out
{SOURCE}
""")
    return replace(declared, kinds=kinds, kind_key="name")


EFFECT = _effect((*EFFECTS.values(), *THERMAL_EFFECTS.values()))
"""[[effect]] of plant and scenario files."""

_PLANT = sections(f"""
[plant] a machine
format | text | | required | its first line, "feeddrive-plant/1"
name | text | | | of the machine; that of the file if left out
structure | text | {", ".join(CHAINS)} | | of the chain; left out where heat alone is declared
description | text | | | in a sentence
{SOURCE}
""")
PLANT = replace(
    _PLANT,
    sections={
        **{name: _section(name) for name in _MEANINGS},
        "bearing": _bearing(),
        "guide": _guide(),
        "effect": EFFECT,
        "sensor": SENSOR,
        "controller": DECLARED_CONTROLLER,
        "thermal": THERMAL,
    },
)
"""A plant file."""


def plant_table(entries: Mapping[str, Any], where: str) -> Table:
    """The table of a whole plant file, its keys declared and the values of the parts that it names put in.

    Takes the entries of the file and its path. Raises InputError: a `source` that is no text, or a part that the
    catalogue does not hold.
    """
    return whole_file(with_named_parts(entries, where), where, PLANT)
