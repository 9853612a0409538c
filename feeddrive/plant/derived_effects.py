"""Effects that follow from what a plant file says of table and guide: weight, counterbalance, friction of carriages.

F = m g sin(inclination) - counterbalance                 constant_force, positive resists + motion
guide_friction of `carriages` ball carriages              see `feeddrive.effects.guide_friction`
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from feeddrive.effects.base import Effect
from feeddrive.effects.constant_force import ConstantForce
from feeddrive.effects.guide_friction import GuideFriction, guide_effect
from feeddrive.errors import InputError
from feeddrive.parts.guide_coefficients import SET_A
from feeddrive.parts.guide_geometry import HSR_20R, HSR_30R
from feeddrive.plant.drive_sections import placed
from feeddrive.plant.effect_sections import next_label
from feeddrive.plant.entries import Table
from feeddrive.quantity import format_quantity

GRAVITY = 9.80665
"""Standard acceleration of fall [m/s^2]."""

CARRIAGES = {"HSR-20R": HSR_20R, "HSR-30R": HSR_30R}
_GUIDE_KEYS = ("carriage", "carriages", "seal_drag", "smoothing_velocity", "load", "source")
WEIGHT_KEYS = ("inclination", "counterbalance")

_TURNING = 5e-4  # where tanh of the guide friction turns unless it is said [m/s]


def derived_effects(top: Table, before: Sequence[Effect]) -> tuple[Effect, ...]:
    """Weight and guide friction of a plant file, with their origins noted.

    Args:
        top: the file.
        before: effects that it declares itself.

    Raises:
        InputError: a value that is missing, without unit or not possible, or friction declared twice.
    """
    made: list[Effect] = []
    for effect, origin in [*_weight(top), *_guide(top, before)]:
        label = next_label(effect.name, [*before, *made])
        for key in effect.values:
            top.origins.found[f"{label}.{key}"] = origin
        made.append(effect)
    return tuple(made)


def _weight(top: Table) -> list[tuple[Effect, str]]:
    table = top.table("table")
    if "inclination" not in table.entries:
        if "counterbalance" in table.entries:
            mend = 'write inclination = "90 deg" for a vertical axis whose + direction is up'
            raise InputError("a counterbalance without inclination", table.place("counterbalance"), mend)
        return []
    angle = table.quantity("inclination", "rad", "table.inclination")
    if abs(angle) > math.pi / 2 + 1e-9:
        mend = "write -90 deg to 90 deg, positive where the + direction points up"
        raise InputError(f"{math.degrees(angle):g} deg is not an inclination", table.place("inclination"), mend)
    weight = table.quantity("mass", "kg", "table_mass") * GRAVITY * math.sin(angle)
    held = 0.0
    if "counterbalance" in table.entries:
        held = math.copysign(table.quantity("counterbalance", "N", "table.counterbalance"), angle)
    origin = "computed from mass and inclination"
    if held:
        origin += f", less the counterbalance of {format_quantity(abs(held), 'N')}"
    return [(ConstantForce.of(force=weight - held), origin)]


def _guide(top: Table, before: Sequence[Effect]) -> list[tuple[Effect, str]]:
    if "guide" not in top.entries:
        return []
    table = top.table("guide")
    table.refuse_unknown(_GUIDE_KEYS)
    if any(isinstance(effect, GuideFriction) for effect in before):
        raise InputError("guide and guide_friction are both declared", table.where, "keep one of them")
    name = table.choice("carriage", CARRIAGES)
    count = _count(table)
    seal = table.quantity("seal_drag", "N", "guide.seal_drag") if "seal_drag" in table.entries else 0.0
    load, turning = _load(top, count), _TURNING
    if "smoothing_velocity" in table.entries:
        turning = table.quantity("smoothing_velocity", "m/s", "guide.smoothing_velocity")
    effect = placed(table.where, lambda: guide_effect(CARRIAGES[name], SET_A, count, load, seal, turning))
    origin = f"computed from {count} carriages {name} with {format_quantity(load, 'N')} and seals of"
    return [(effect, f"{origin} {format_quantity(seal, 'N')} each")]


def _count(table: Table) -> int:
    count = table.entries.get("carriages")
    if not isinstance(count, int) or isinstance(count, bool) or not 1 <= count <= 1000:
        raise InputError(f"{count!r} carriages", table.place("carriages"), "write a whole number, e.g. carriages = 4")
    return count


def _load(top: Table, count: int) -> float:
    """Vertical load of one carriage [N]: written, or the table's weight across the guide, shared evenly."""
    guide, table = top.table("guide"), top.table("table")
    if "load" in guide.entries:
        return guide.quantity("load", "N", "guide.load")
    angle = table.quantity("inclination", "rad", "table.inclination") if "inclination" in table.entries else 0.0
    return table.quantity("mass", "kg", "table_mass") * GRAVITY * math.cos(angle) / count
