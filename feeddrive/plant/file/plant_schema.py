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
from feeddrive.parts.material import STEEL
from feeddrive.parts.values import PartValue
from feeddrive.plant.chain.chain import CHAINS
from feeddrive.plant.file.drive_sections import BEARING_VALUES, PART_VALUES
from feeddrive.plant.file.entries import Table, whole_file
from feeddrive.plant.file.named_parts import with_named_parts
from feeddrive.plant.file.ratings import RATINGS
from feeddrive.schema.controller import DECLARED_CONTROLLER
from feeddrive.schema.heat import SOURCE, THERMAL
from feeddrive.schema.key import Key, Kind
from feeddrive.schema.section import Section, keyed
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

_FURTHER: dict[str, tuple[Key, ...]] = {
    "motor": (
        Key("torque_limit", "peak torque of the motor", "N m", minimum=0.0, open_ends=True),
        Key("torque_constant", "torque per current, where a recording holds the current", "N m/A", minimum=0.0,
            open_ends=True),
        Key("torque_factor", "torque that acts over torque that the drive records", "1", minimum=0.0, open_ends=True,
            default="1"),
    ),
    "ball_screw": (
        Key("elements", "of the main span: 1 or 2", "1", Kind.WHOLE, 1, 2, default="1",
            when='with structure = "distributed_screw"'),
    ),
    "transmission": (
        Key("nut_position", "from the near bearing, where stiffness is computed; mid-stroke if left out", "m",
            when='with structure = "three_inertias" in a machine described by its parts'),
    ),
    "support": (
        Key("kind", "near end and far end of the screw", kind=Kind.TEXT, required=True, when=OF_PARTS,
            choices=("fixed-free", "fixed-supported", "supported-supported", "fixed-fixed")),
    ),
    "table": (
        Key("stroke", "least and greatest table position", "m", Kind.QUANTITIES),
        Key("inclination", "of the + direction above the horizontal", "rad", minimum=-math.pi / 2,
            maximum=math.pi / 2),
        Key("counterbalance", "force against the weight; with inclination", "N"),
        Key("first_nut_position", "nut from the near bearing where the table is at 0", "m", default="0 m",
            when=_PLACED),
    ),
    "damping": (
        Key("ratio", "damping ratio", "1", minimum=0.0, maximum=1.0, usual=(0.01, 0.05)),
        Key("frequency", "at which the ratio is meant; the first mode with the motor free if left out", "Hz",
            minimum=0.0, open_ends=True),
    ),
}  # fmt: skip


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
    return [replace(key, when="" if len(structures[name]) == len(CHAINS) else alone[name])
            for name, key in found.items()]  # fmt: skip


def _section(name: str) -> Section:
    """One of the sections of motion."""
    chain = _chain_keys(name)
    parts = [_part_key(name, value, OF_PARTS) for value in PART_VALUES.get(name, ())]
    ratings = [replace(_part_key(name, value, ""), required=False) for value in RATINGS.get(name, ())]
    named = [_named_part(name)] if name in NAMED_PARTS else []
    both = {key.name for key in chain} & {key.name for key in parts}
    further = list(_FURTHER.get(name, ()))
    keys = [*further, *(key for key in chain if key.name not in both), *parts, *ratings]
    if name == "table":
        keys = [replace(key, required=key.name == "mass") if key.name == "mass" else key for key in keys]
    open_to_all = {key.name for key in ratings} | both - {key.name for key in chain if key.when}
    keys = [replace(key, when="") if key.name in open_to_all else key for key in keys]
    return Section(f"plant.{name}", _MEANINGS[name], keyed(*named, *keys, SOURCE))


NAMED_PARTS = ("motor", "coupling", "ball_screw", "nut", "bearing")
"""Sections that may name a part of the catalogue."""


def _named_part(section: str) -> Key:
    return Key("part", "of the catalogue (`feeddrive parts`); gives the values that are left out here",
               kind=Kind.TEXT, when=OF_PARTS)  # fmt: skip


def _bearing() -> Section:
    ends = {}
    for end, meaning in (("near", "bearing at the motor's end"), ("far", "bearing at the far end")):
        keys = [_part_key("bearing", value, "") for value in BEARING_VALUES]
        keys = [replace(key, required=key.name == "axial_stiffness") for key in keys]
        named = replace(_named_part("bearing"), when="")
        ends[end] = Section(f"plant.bearing.{end}", meaning, keyed(named, *keys, SOURCE))
    return Section("plant.bearing", "the bearings of the screw", keyed(SOURCE), ends)


def _guide() -> Section:
    geometry = "where no carriage is named"
    catalogue = "with a carriage of the catalogue"
    keys = [replace(_part_key("guide", value, geometry), kind=Kind.WHOLE if value.key == "balls_per_row" else
            Kind.QUANTITY) for value in GUIDE_VALUES]  # fmt: skip
    return Section(
        "plant.guide",
        "carriages under the table, from which guide friction follows",
        keyed(
            Key("carriage", "a known one (`feeddrive parts guide`), or its geometry in place of the name",
                kind=Kind.TEXT),
            Key("carriages", "how many", "1", Kind.WHOLE, 1, 1000, required=True),
            Key("seal_drag", "of the seals of one carriage; 0 or the catalogue's if left out", "N", minimum=0.0,
                usual=(0.0, 100.0)),
            Key("load", "vertical load of one carriage; the table's weight, shared evenly, if left out", "N"),
            Key("coefficients", "of rolling and slip", kind=Kind.TEXT, choices=("A", "B"), default="A",
                when="with a geometry"),
            Key("smoothing_velocity", "where the friction turns", "m/s", minimum=0.0, default="0.5 mm/s"),
            Key("preload_class", "as the catalogue calls it; its lightest if left out", kind=Kind.TEXT,
                when=catalogue),
            Key("preload", "of one carriage, in place of that of the class", "N", minimum=0.0, when=catalogue),
            Key("friction_coefficient", "force over load; the catalogue's if left out", "1", minimum=0.0,
                maximum=0.1, when=catalogue),
            *keys,
            SOURCE,
        ),
    )  # fmt: skip


def _sensor() -> Section:
    return Section(
        "plant.sensor",
        "one sensor",
        keyed(
            Key("channel", "canonical name of what it reads", kind=Kind.TEXT, required=True),
            Key("kind", "of sensor", kind=Kind.TEXT, required=True,
                choices=("encoder", "scale", "tachometer", "current", "thermometer")),
            Key("at", "motor, screw or table; of a thermometer front, rear, nut or shaft; of a growth scale the"
                " nut's position", kind=Kind.TEXT, required=True),
            Key("resolution", "smallest step, in the unit of the channel", minimum=0.0),
            Key("noise", "rms of a thermometer or a growth scale; read off the recording if left out", minimum=0.0),
            Key("absolute", "whether its zero is the same in every recording, so that an offset that moves is growth",
                kind=Kind.SWITCH, default="false"),
            SOURCE,
        ),
        listed=True,
    )  # fmt: skip


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
        parameter.key, meaning_of(effect, parameter.key), parameter.unit,
        Kind.QUANTITIES if parameter.table else Kind.QUANTITY, parameter.minimum, parameter.maximum,
        default=default, required=parameter.default is None and parameter.key not in along,
    )  # fmt: skip


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
    return Section(
        "plant.effect",
        "one effect",
        keyed(
            Key("name", "of the effect (`feeddrive list`)", kind=Kind.TEXT, required=True),
            Key("port", "where it acts; its first possible one if left out", kind=Kind.TEXT,
                choices=("motor", "screw", "transmission", "table", "sensor", "thermal")),
            SOURCE,
        ),
        kinds=kinds,
        kind_key="name",
        listed=True,
    )  # fmt: skip


EFFECT = _effect((*EFFECTS.values(), *THERMAL_EFFECTS.values()))
"""[[effect]] of plant and scenario files."""

PLANT = Section(
    "plant",
    "a machine",
    keyed(
        Key("format", 'its first line, "feeddrive-plant/1"', kind=Kind.TEXT, required=True),
        Key("name", "of the machine; that of the file if left out", kind=Kind.TEXT),
        Key("structure", "of the chain; left out where heat alone is declared", kind=Kind.TEXT,
            choices=tuple(CHAINS)),
        Key("description", "in a sentence", kind=Kind.TEXT),
        SOURCE,
    ),
    {
        **{name: _section(name) for name in _MEANINGS},
        "bearing": _bearing(),
        "guide": _guide(),
        "effect": EFFECT,
        "sensor": _sensor(),
        "controller": DECLARED_CONTROLLER,
        "thermal": THERMAL,
    },
)  # fmt: skip
"""A plant file."""


def plant_table(entries: Mapping[str, Any], where: str) -> Table:
    """The table of a whole plant file, its keys declared and the values of the parts that it names put in.

    Args:
        entries: of the file.
        where: its path, for messages.

    Raises:
        InputError: `source` is not a text, or a part that the catalogue does not hold.
    """
    return whole_file(with_named_parts(entries, where), where, PLANT)
