"""Plant files: a machine written down, every number with its unit and, where known, its source.

    format = "feeddrive-plant/1"
    name = "bench axis"
    structure = "three_inertias"     # or "rigid": without [transmission], inertias may be left out
    source = "data sheet"            # of every value that names none itself; also inside a table

    [motor]
    inertia = "2.6e-3 kg m^2"
    torque_limit = "30 N m"          # may be left out
    [ball_screw]
    lead = { value = "20 mm", source = "measured", tolerance = "0.1 %" }
    inertia = "2.37e-3 kg m^2"
    [transmission]
    torsional_stiffness = "11982.4 N m/rad"
    torsional_damping = "0.074 N m s/rad"
    axial_stiffness = "244.7 N/µm"
    axial_damping = "8650 N s/m"
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
    [controller]
    kind = "position_velocity"
    position_gain = "160 1/s"
    velocity_gain = "240 V s/m"
    output_limit = "10 V"
    torque_per_output = "0.014 N m/V"

Nothing in the file is evaluated.
"""

from __future__ import annotations

import warnings
from itertools import pairwise
from pathlib import Path

from feeddrive.effects.base import Effect
from feeddrive.effects.catalogue import EFFECTS, find_effect
from feeddrive.errors import InputError, ValidityWarning
from feeddrive.plant.chain import CHAINS, Chain, ChainValue, Rigid
from feeddrive.plant.composition import refuse_what_cannot_compose
from feeddrive.plant.effect_text import plant_text_with_effects
from feeddrive.plant.entries import Origins, Table, nearest, read_toml
from feeddrive.plant.equipment import read_controller, read_sensors
from feeddrive.plant.plant import Plant
from feeddrive.quantity import format_quantity

__all__ = ["FORMAT", "plant_text_with_effects", "read_plant", "section_key"]

FORMAT = "feeddrive-plant/1"
_SECTIONS = ("motor", "ball_screw", "transmission", "table")
_TOP_KEYS = ("format", "name", "structure", "source", "description", *_SECTIONS, "effect", "sensor", "controller")
_PREFIXES = {"motor": "motor_", "ball_screw": "screw_", "table": "table_"}
_USUAL = {
    "lead": (5e-4, 0.2),
    "motor_inertia": (1e-8, 10.0),
    "screw_inertia": (1e-8, 10.0),
    "torsional_stiffness": (1.0, 1e8),
    "axial_stiffness": (1e5, 1e11),
    "table_mass": (1e-2, 1e5),
}
"""Range in which a value is usual [SI]; outside it a slip of the unit is likely."""


def read_plant(path: Path) -> Plant:
    """Read a plant file.

    Args:
        path: of the file.

    Returns:
        The plant, values in SI; `origins` names the source of each value that has one: chain values and
        `torque_limit` by key, effects as `label.key`, the controller as `controller.key`.

    Raises:
        InputError: not found, not TOML, another format, unknown key or name, a value that is missing, without unit,
            of another dimension or impossible, effects that cannot act together.

    Warns:
        ValidityWarning: a value far outside what is usual.
    """
    top = _top(path)
    chain = _chain(top)
    motor = top.table("motor")
    limit = _positive(motor, "torque_limit", "N m", "torque_limit") if "torque_limit" in motor.entries else float("inf")
    effects = _effects(top)
    refuse_what_cannot_compose(effects, chain.elastic, top.where)
    plant = Plant(
        name=top.text("name", path.stem),
        chain=chain,
        effects=effects,
        torque_limit=limit,
        sensors=read_sensors(top),
        controller=read_controller(top),
        origins=top.origins.found,
    )
    _refuse_moving_mass(plant, str(path))
    _warn_of_unusual(chain, str(path))
    return plant


def section_key(value: ChainValue) -> str:
    """Key of a chain value inside its section: `motor_inertia` is `inertia` in [motor]."""
    return value.key.removeprefix(_PREFIXES.get(value.section, ""))


def _top(path: Path) -> Table:
    where, entries = str(path), read_toml(path, "plant file")
    if entries.get("format") != FORMAT:
        raise InputError("is not a plant file of this version", where, f'write format = "{FORMAT}" in its first line')
    unread = Table(entries, where, Origins())
    unread.refuse_unknown(_TOP_KEYS)
    unread.text("description", "")
    return Table(entries, where, unread.origins, unread.text("source", ""))


def _chain(top: Table) -> Chain:
    """The chain of the structure, its values checked."""
    structure = CHAINS[top.choice("structure", CHAINS)]
    for section in _SECTIONS:
        _refuse_unknown_values(top.table(section), section, structure)
    values: dict[str, float] = {}
    for value in structure.required:
        table = top.table(value.section)
        missing = section_key(value) not in table.entries
        if missing and structure is Rigid and value.may_be_zero:
            values[value.key] = 0.0
            continue
        values[value.key] = _chain_value(table, value)
    return structure(values)


def _refuse_unknown_values(table: Table, section: str, structure: type[Chain]) -> None:
    known = [section_key(value) for value in structure.required if value.section == section]
    extra = ("torque_limit",) if section == "motor" else ()
    elsewhere = {
        section_key(value): f'leave it out, or use structure = "{other.structure}"'
        for other in CHAINS.values()
        for value in other.required
        if value.section == section
    }
    table.refuse_unknown((*known, *extra, "source"), elsewhere)


def _chain_value(table: Table, value: ChainValue) -> float:
    key = section_key(value)
    if value.may_be_zero:
        number = table.quantity(key, value.unit, value.key)
        if number < 0:
            shown = format_quantity(number, value.unit)
            raise InputError(f"{shown} is negative", table.place(key), "write it positive")
        return number
    return _positive(table, key, value.unit, value.key)


def _positive(table: Table, key: str, unit: str, origin: str) -> float:
    number = table.quantity(key, unit, origin)
    if number <= 0:
        sign = "negative" if number < 0 else "zero"
        raise InputError(f"{format_quantity(number, unit)} is {sign}", table.place(key), "write a value above zero")
    return number


def _effects(top: Table) -> tuple[Effect, ...]:
    """The effects, in the order of the file."""
    effects: list[Effect] = []
    for table in top.tables("effect"):
        name = table.text("name")
        label = _label(name, effects)
        effects.append(_effect(Table(table.entries, f"{table.where} ({name})", table.origins, table.source), label))
    return tuple(effects)


def _label(name: str, before: list[Effect]) -> str:
    """The label that the plant will give to the next effect of that name."""
    count = sum(effect.name == name for effect in before)
    return name if count == 0 else f"{name}_{count + 1}"


def _effect(table: Table, label: str) -> Effect:
    name = table.entries["name"]
    if name not in EFFECTS:
        raise InputError(f"unknown effect {name!r}", table.where, nearest(name, EFFECTS))
    effect = find_effect(name)
    keys = [parameter.key for parameter in effect.parameters]
    table.refuse_unknown(("name", "port", "source", *keys))
    values = {
        parameter.key: (table.quantities if parameter.table else table.quantity)(
            parameter.key, parameter.unit, f"{label}.{parameter.key}"
        )
        for parameter in effect.parameters
        if parameter.key in table.entries or parameter.default is None
    }
    port = table.choice("port", effect.ports, effect.ports[0])
    try:
        made = effect.of(next(known for known in effect.ports if known == port), **values)
    except InputError as error:
        raise InputError(error.what, table.where, error.mend) from None
    _refuse_bad_curve(made, table.where)
    return made


def _refuse_bad_curve(effect: Effect, where: str) -> None:
    """Refuse tables of unequal length, or positions that do not ascend."""
    tables = {p.key: effect.values[p.key] for p in effect.parameters if p.table and p.key in effect.values}
    lengths = {key: len(value) if isinstance(value, tuple) else 1 for key, value in tables.items()}
    if len(set(lengths.values())) > 1:
        told = " and ".join(f"{key} has {length}" for key, length in lengths.items())
        raise InputError(f"{told} values", where, "write lists of equal length")
    position = tables.get("position")
    if isinstance(position, tuple) and any(b <= a for a, b in pairwise(position)):
        raise InputError("position does not ascend", where, "write the positions in ascending order, none twice")


def _refuse_moving_mass(plant: Plant, where: str) -> None:
    """Refuse a payload that takes away the whole table; here and not in `Plant`, for a fit may pass through it."""
    mass = plant.chain_values()["table_mass"]
    if mass <= 0:
        what = f"table mass with the payload is {format_quantity(mass, 'kg')}"
        raise InputError(what, where, "write a payload that leaves it above zero")


def _warn_of_unusual(chain: Chain, where: str) -> None:
    for value in chain.required:
        low, high = _USUAL.get(value.key, (0.0, float("inf")))
        number = chain.values[value.key]
        if number != 0 and not low <= number <= high:
            place = f"{where}, {value.section}.{section_key(value)}"
            shown = format_quantity(number, value.unit)
            warnings.warn(f"{place}: {shown} is unusual; check its unit", ValidityWarning, stacklevel=3)
