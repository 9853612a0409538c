"""What to do after a diagnosis, and what repair and compensation will bring; the report shows it."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import cast

from feeddrive.compensation.compensate import Compensated, Wishes, compensate_plant
from feeddrive.compensation.cures import cure, in_order
from feeddrive.compensation.lost_motion import lost_motion
from feeddrive.diagnosis.judging.result import Diagnosis
from feeddrive.errors import InputError
from feeddrive.plant.plant import Plant
from feeddrive.units.quantity import format_quantity

FORM = "csv"
"""In which the figures are predicted: both directions, no rounding that tells; a control's own limits come on top."""

_UNSURE = "backlash is in no table: {reason}. A backlash value against wind-up makes the contour worse"


@dataclass(frozen=True, eq=False)
class Actions:
    """What to do.

    Attributes:
        effects: names in the order in which a person goes through them.
        predicted: figures before, after repair, after compensation; None where no table helps.
        why_not: why nothing is predicted, where a table was asked for; empty where it was not.
        set_to: effect to the value to set for it, in words, where it is one value.
    """

    effects: tuple[str, ...]
    predicted: Compensated | None = None
    why_not: str = ""
    set_to: Mapping[str, str] = field(default_factory=dict)


def actions(diagnosis: Diagnosis, after: Plant) -> Actions:
    """What to do, with a prediction where a table of positions helps.

    Args:
        diagnosis: what was found.
        after: the machine with what was found.
    """
    names = in_order([one.name for one in diagnosis.effects])
    carried = [one.name for left in diagnosis.unexplained.values() for one in left.carried]
    wanted = [name for name in (*names, *carried) if cure(name).form == "table"]
    values = values_to_set(after) if names and after.has_motion else {}
    if not wanted or not after.has_motion:
        return Actions(tuple(names), set_to=values)
    stroke = after.stroke or diagnosis.recorded_stroke
    if stroke is None:
        return Actions(tuple(names), None, "no stroke is declared, and none was recorded", values)
    try:
        unsure = unsure_of_play([(one.name, one.carries) for one in diagnosis.effects], diagnosis.ambiguous)
        done = compensate_plant(
            after,
            Wishes(FORM, stroke=stroke, recorded=diagnosis.recorded_stroke),
            None,
            unsure,
            diagnosis.plant,
            beside=False,
        )
    except InputError as error:
        return Actions(tuple(names), None, str(error), values)
    return Actions(tuple(names), done, "", values)


def values_to_set(after: Plant) -> dict[str, str]:
    """Effects that one value in plant file, drive or control takes care of, to that value.

    Args:
        after: the machine with what was found.
    """
    radius, found = after.chain.motor_radius, {}
    for one in after.effects:
        if one.name == "lead_error_cumulative":
            lead = 2e3 * math.pi * radius
            found[one.name] = (
                f"{lead * (1 + cast(float, one.values['slope'])):.7g} mm per revolution, not {lead:.7g} mm"
            )
        elif one.name == "payload":
            found[one.name] = f"moving mass {format_quantity(after.chain_values()['table_mass'], 'kg')}"
        elif one.name == "constant_force":
            found[one.name] = f"torque offset {format_quantity(radius * cast(float, one.values['force']), 'N m')}"
        elif one.name == "backlash" and not _rests(after):
            found[one.name] = f"until then, backlash value {format_quantity(cast(float, one.values['width']), 'm')}"
    return found


def _rests(plant: Plant) -> bool:
    """Whether a load holds the table on one flank of its play, which a backlash value would only put in."""
    try:
        return lost_motion(plant).rests
    except InputError:  # no steady motion in the middle of the stroke
        return False


def unsure_of_play(effects: Iterable[tuple[str, bool]], ambiguous: Iterable[Sequence[str]]) -> str:
    """Why the backlash of a diagnosis may not be taken for play; empty where it may.

    Takes the names of what was found, each with whether it carries over to data that were not fitted, and the ambiguous
    sets.
    """
    if ("backlash", False) in effects:
        return _UNSURE.format(reason="it was not confirmed on data that were not fitted")
    for names in ambiguous:
        if "backlash" in names:
            others = " or ".join(str(one).replace("_", " ") for one in names if one != "backlash")
            return _UNSURE.format(reason=f"these recordings cannot tell it from {others}")
    return ""
