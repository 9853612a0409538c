"""Effects that follow from what a plant file says of table and guide: weight, counterbalance, friction of carriages.

F = m g sin(inclination) - counterbalance                 constant_force, positive resists + motion
guide_friction of `carriages` ball carriages              see `feeddrive.plant.file.guide_section`
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from feeddrive.effects.base import Effect
from feeddrive.effects.source.constant_force import ConstantForce
from feeddrive.errors import InputError
from feeddrive.plant.file.effect_sections import next_label
from feeddrive.plant.file.entries import Table
from feeddrive.units.quantity import format_quantity

GRAVITY = 9.80665
"""Standard acceleration of fall [m/s^2]."""

WEIGHT_KEYS = ("inclination", "counterbalance")


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
    from feeddrive.plant.file.guide_section import guide_friction_of  # Hertz's contacts take time to import

    return guide_friction_of(top, GRAVITY, before)
