"""What a recording is found not to be: a fault of the recorder or of a mapping, and how to mend it.

A fault is no effect of the machine. What is judged after it is the recording as mended, and `plant_after.toml` holds
nothing of it. Where a law of the machine says the same in one value, both are reported and neither is denied:

| found | what the recorder may have done | distinguished by |
|---|---|---|
| channel_delay | this channel is written late; nothing else says so | |
| drive_delay | motor angle and table position are both written late | the times of the recorder |
| constant_force, no force declared | the torque has an offset | a torque recorded at rest, brake on |
| lead_error_cumulative beyond any class of screw | the position is written with another factor | a second scale |

The last is one beyond class T10, 210 um in 300 mm: ISO 3408-3, table 2.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from feeddrive.effects.base import Effect, number
from feeddrive.effects.source.constant_force import ConstantForce
from feeddrive.effects.source.weight import Weight
from feeddrive.plant.plant import Plant
from feeddrive.recording import Recording
from feeddrive.recording.checks.flaws import JOINED, sentence
from feeddrive.units.quantity import format_quantity

WORST_SCREW = 210e-6 / 0.3
"""Travel deviation per travel of the worst class of screw [1]; see above."""


@dataclass(frozen=True)
class Quality:
    """One thing that a recording is not, or may not be.

    Attributes:
        kind: clock_rate, channel_gain, channel_drift, channel_offset, channel_delay, channel_hold, or that of a flaw.
        channel: it is about; time for the clock.
        value: of the fault [unit]; NaN where it has none.
        unit: SI unit.
        ci95: 95 % interval; None where none is known.
        sentence: what is wrong.
        mend: what to do.
        explains: share of the squared error on data not fitted that it takes away; NaN where it was not asked.
        alternatives: effects of the machine that say the same.
        mended: whether the rest of the diagnosis is of the recording as mended.
    """

    kind: str
    channel: str
    value: float
    unit: str
    sentence: str
    mend: str
    ci95: tuple[float, float] | None = None
    explains: float = math.nan
    alternatives: tuple[str, ...] = ()
    mended: bool = False


def quality_record(found: Sequence[Quality]) -> list[dict[str, Any]]:
    """The list `quality` of `diagnosis.json`."""
    return [
        {
            "kind": one.kind,
            "channel": one.channel,
            "value": None if math.isnan(one.value) else one.value,
            "unit": one.unit,
            "ci95": None if one.ci95 is None else list(one.ci95),
            "explains": None if math.isnan(one.explains) else one.explains,
            "sentence": one.sentence,
            "mend": one.mend,
            "alternatives": list(one.alternatives),
            "mended": one.mended,
        }
        for one in found
    ]


def is_recorders(effect: Effect) -> bool:
    """Whether an effect is of the recording alone, and no part of the machine as corrected."""
    return effect.name == "channel_delay"


def quality_lines(found: Sequence[Quality]) -> list[str]:
    """Sentences on each."""
    return [f"{one.sentence[:1].upper()}{one.sentence[1:]}: {one.mend}." for one in found]


def flawed(recordings: Sequence[Recording]) -> tuple[Quality, ...]:
    """The stretches that no machine made, which are left out."""
    result = []
    for recording in dict.fromkeys(recordings):
        for flaw in recording.flaws:
            if flaw.kind == JOINED:  # our own doing, told in the notes
                continue
            what = f"{recording.name}: {sentence(flaw, 0)}"
            mend = "record again without them where they matter"
            result.append(Quality(flaw.kind, flaw.channel, math.nan, "1", what, mend, mended=True))
    return tuple(result)


def read_otherwise(effects: Sequence[Effect], plant: Plant, has_torque: bool) -> tuple[Quality, ...]:
    """What the recorder may have done instead of, or as, an effect that was found.

    Args:
        effects: found.
        plant: as declared.
        has_torque: whether a torque or a current was recorded, which alone can have an offset.
    """
    if not plant.has_motion:
        return ()
    hangs = any(isinstance(effect, ConstantForce | Weight) for effect in plant.effects)
    found = []
    for effect in effects:
        match effect.name:
            case "channel_delay":
                found.append(_late(effect))
            case "drive_delay" if number(effect.values["delay"]) > 0:
                found.append(_all_late(effect))
            case "constant_force" if has_torque and not hangs:
                found.append(_offset(effect, plant))
            case "lead_error_cumulative" if abs(number(effect.values["slope"])) > WORST_SCREW:
                found.append(_scaled(effect))
    return tuple(found)


def _late(effect: Effect) -> Quality:
    delay = number(effect.values["delay"])
    what = f"{effect.place} is recorded {_time(delay)} later than the other channels"
    mend = "let the recorder read it with the others, or shift its rows by that in the file"
    return Quality("channel_delay", effect.place, delay, "s", what, mend, mended=True)


def _all_late(effect: Effect) -> Quality:
    late = number(effect.values["delay"])
    what = f"the torque acts {_time(late)} after it is recorded, or every position is written that late"
    mend = "check when the recorder reads torque and positions; otherwise it is a delay of the drive"
    return Quality("channel_delay", "motor_angle", late, "s", what, mend, alternatives=(effect.name,))


def _offset(effect: Effect, plant: Plant) -> Quality:
    torque = number(effect.values["force"]) * plant.chain.motor_radius
    size, back = (format_quantity(one, "N m") for one in (torque, -torque))
    what = f"a constant force and an offset of the torque by {size} are the same on an axis where nothing hangs"
    mend = f'record the torque at rest without control; an offset is mended by "offset = {back}" in the mapping'
    return Quality("channel_offset", "motor_torque", torque, "N m", what, mend, alternatives=(effect.name,))


def _scaled(effect: Effect) -> Quality:
    gain = 1 + number(effect.values["slope"])
    what = f"table_position is {gain:.5g} times the travel of the motor, further off than any class of screw"
    mend = f"check its unit, its factor and the lead; divide it by {gain:.5g} in the mapping"
    return Quality("channel_gain", "table_position", gain, "1", what, mend, alternatives=(effect.name,))


def _time(seconds: float) -> str:
    return f"{1e3 * seconds:.3g} ms"
