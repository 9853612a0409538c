"""The chain of a plant file: values written there, and those computed from its parts where they are not.

A value of the chain that is written (a measured one) takes the place of the computed one; its origin tells both.
"""

from __future__ import annotations

import math
from dataclasses import replace

from feeddrive.errors import InputError
from feeddrive.parts.screw.screw_drive import BallScrewDrive
from feeddrive.plant.analysis.modes import free_modes
from feeddrive.plant.chain.chain import CHAINS, Chain, ChainValue, DistributedScrew, Rigid
from feeddrive.plant.chain.drive_values import Computed, distributed_values, lumped_values
from feeddrive.plant.file.drive_sections import describes_parts, read_drive
from feeddrive.plant.file.ratings import first_nut_position, read_stroke
from feeddrive.plant.plant import Plant
from feeddrive.schema.table import Table
from feeddrive.units.quantity import format_quantity

_DAMPERS = {
    "torsional_damping": "torsional_stiffness",
    "axial_damping": "axial_stiffness",
    "drive_damping": "drive_stiffness",
    "nut_damping": "nut_stiffness",
}
"""Damper of the chain to the spring beside it."""


def read_chain(top: Table) -> tuple[Chain, BallScrewDrive | None]:
    """The chain of a plant file, and the parts that it was computed from.

    Raises:
        InputError: unknown structure, a value that is missing, without unit, of another dimension or impossible.
    """
    structure = CHAINS[top.choice("structure", CHAINS)]
    drive = read_drive(top) if structure is not Rigid and describes_parts(top) else None
    computed = _computed(top, structure, drive)
    values: dict[str, float] = {}
    for value in structure.required:
        values[value.key] = _value(top, value, structure, computed)
    for value in structure.optional:
        if value.section_key in top.table(value.section).entries:
            values[value.key] = _value(top, value, structure, computed)
    chain = _made(top, structure, values)
    return _damped(top, chain, computed), drive


def _computed(top: Table, structure: type[Chain], drive: BallScrewDrive | None) -> dict[str, Computed]:
    if drive is None:
        return {}
    stroke = read_stroke(top)
    middle = first_nut_position(top) + (0.5 * sum(stroke) if stroke else 0.0)
    if structure is DistributedScrew:
        return distributed_values(drive, middle)
    table = top.table("transmission")
    position = table.quantity("nut_position", "m", "nut_position") if "nut_position" in table.entries else middle
    return lumped_values(drive, position)


def _value(top: Table, value: ChainValue, structure: type[Chain], computed: dict[str, Computed]) -> float:
    """A value that is written, or computed, or may be left out."""
    table, key = top.table(value.section), value.section_key
    known = computed.get(value.key)
    if key in table.entries:
        number = _written(table, value)
        if known is not None and known.value != number:
            shown = format_quantity(known.value, value.unit)
            origin = top.origins.found.get(value.key, "")
            top.origins.found[value.key] = f"{origin or 'written'} (in place of {shown} {known.source})"
        return number
    if known is not None:
        source = known.source or next((top.origins.found[of] for of in known.of if of in top.origins.found), "")
        if source:
            top.origins.found[value.key] = source
        return known.value
    if value.may_be_zero and (structure is Rigid or _left_to_damping(top, value.key)):
        return 0.0
    return _written(table, value)


def _written(table: Table, value: ChainValue) -> float:
    if not value.may_be_zero:
        return table.positive(value.section_key, value.unit, value.key, value.usual)
    number = table.quantity(value.section_key, value.unit, value.key, value.usual)
    if number < 0:
        shown = format_quantity(number, value.unit)
        raise InputError(f"{shown} is negative", table.place(value.section_key), "write it positive")
    return number


def _left_to_damping(top: Table, key: str) -> bool:
    """Whether a damper follows from the damping ratio."""
    return "ratio" in top.table("damping").entries and (key in _DAMPERS or key == "damping_time")


def _made(top: Table, structure: type[Chain], values: dict[str, float]) -> Chain:
    if structure is not DistributedScrew:
        return structure(values)
    elements = top.table("ball_screw").entries.get("elements", 1)
    if elements not in (1, 2) or isinstance(elements, bool):
        where = f"{top.where}, ball_screw.elements"
        raise InputError(f"{elements!r} elements of the main span", where, "write elements = 1 or elements = 2")
    if not values["bearing_stiffness"] + values["far_bearing_stiffness"] > 0:
        raise InputError("no bearing takes axial force", f"{top.where}, support", "give near_stiffness above zero")
    return DistributedScrew(values, elements)


def _damped(top: Table, chain: Chain, computed: dict[str, Computed]) -> Chain:
    """The chain with dampers from the damping ratio where none are written: C = tau K, tau = ratio / (pi f)."""
    table = top.table("damping")
    if "ratio" not in table.entries or isinstance(chain, Rigid):
        return chain
    ratio = table.quantity("ratio", "1", "damping.ratio")
    if not 0 <= ratio < 1:
        raise InputError(f"a damping ratio of {ratio:g}", table.place("ratio"), "write 0 to 1, 0.01 to 0.05 is usual")
    if "frequency" in table.entries:
        frequency, at = table.positive("frequency", "Hz", "damping.frequency"), ""
    else:
        stroke = read_stroke(top)
        bare = Plant(top.where, replace(chain, values={**chain.values, **dict.fromkeys(_DAMPERS, 0.0)}))
        frequency = float(free_modes(bare, 0.5 * sum(stroke) if stroke else 0.0).frequencies[1])
        at = ", first mode with the motor free" + (" at mid-stroke" if chain.varies else "")
    if not frequency > 0:  # springs apart by more than sixteen digits
        mend = "write frequency here, or springs and masses that a machine has"
        raise InputError("no mode of the chain rings with the motor free", table.place("ratio"), mend)
    time = ratio / (math.pi * frequency)
    values = dict(chain.values)
    origin = f"damping ratio {ratio:g} at {format_quantity(frequency, 'Hz')}{at}"
    for damper, spring in [*_DAMPERS.items(), ("damping_time", "")]:
        known = next((value for value in chain.required if value.key == damper), None)
        if known is not None and known.section_key not in top.table(known.section).entries:
            values[damper] = time * values[spring] if spring else time
            top.origins.found[damper] = origin
    return replace(chain, values=values)
