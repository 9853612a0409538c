"""A recommended cascade as a drive will have it: within its filters, in its resolution, checked again in every case."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from feeddrive.errors import InputError
from feeddrive.plant.plant import Plant
from feeddrive.servo.cascade import Cascade
from feeddrive.servo.margins import GROWTH
from feeddrive.servo.mechanics_response import Case
from feeddrive.tuning.demand import Demand
from feeddrive.tuning.drive_forms.drive_file import Writer, drive_text, fits, writer_of
from feeddrive.tuning.drive_forms.parameter import Facts, Line, LoopSettings
from feeddrive.tuning.filter_choice import FilterChoice, is_low_pass
from feeddrive.tuning.reasons import operating_points
from feeddrive.tuning.recommendation import Reached, Recommendation, holds, reached_in, recommend

_TRIES = 20
_SLOWED = 0.99


@dataclass(frozen=True)
class DriveSettings:
    """The settings of a drive.

    Attributes:
        form: name of the form.
        lines: parameters and numbers as typed.
        cascade: the loop that these numbers make.
        reached: margins of that loop in every case.
        remarks: what was changed for the drive, and where the margins hold.
        text: the file.
    """

    form: str
    lines: tuple[Line, ...]
    cascade: Cascade
    reached: tuple[Reached, ...]
    remarks: tuple[str, ...]
    text: str


def facts_of(plant: Plant, cascade: Cascade) -> Facts:
    """What forms need to know of an axis and its drive."""
    fast = 1 / cascade.sample_time
    return Facts(cascade.radius, plant.torque_constant, fast, fast / cascade.position_divider)


def drive_settings(plant: Plant, found: Recommendation, form: str) -> DriveSettings:
    """What to type into a drive of a form, for a recommendation.

    Where the drive does not have the filters of the recommendation, the loop is tuned again with those that it has. The
    numbers are rounded to its resolution to the safe side, and the loop that they make is checked in every case. Raises
    InputError: an unknown form, a value that the drive does not take, margins that it cannot keep.
    """
    writer, remarks = writer_of(form), []
    cases = [one.case for one in found.reached]
    filters, notes = as_low_passes(found.velocity.filters)
    remarks += notes
    if notes or not fits(filters, writer.limits):
        drive = replace(found.cascade, torque_filters=())
        found = recommend(plant, drive, cases, found.demand, writer.limits)
        filters = found.velocity.filters
        remarks.append(f"tuned again with the filters of {writer.form.title}")
    facts = facts_of(plant, found.cascade)
    lines, cascade, reached = _settled(plant, found, filters, writer, facts, cases)
    phase, gain = (min(getattr(one.velocity, name) for one in reached) for name in ("phase", "gain"))
    outer = min(one.position.gain for one in reached)
    remarks += [
        f"least margins: velocity loop {phase:.1f} deg and {gain:.1f} dB, position loop {outer:.1f} dB",
        f"they hold at: {operating_points(replace(found, reached=reached))}",
        f"loops at {facts.velocity_rate:g} Hz and {facts.position_rate:g} Hz, as tuned for",
    ]
    text = drive_text(writer.form, lines, remarks)
    return DriveSettings(form, tuple(lines), cascade, reached, tuple(remarks), text)


def as_low_passes(filters: Sequence[FilterChoice]) -> tuple[tuple[FilterChoice, ...], list[str]]:
    """The filters, a notch wider than an octave as the low-pass that it is; and a sentence for each that was one."""
    made, notes = [], []
    for one in filters:
        if one.kind == "notch" and is_low_pass(one.frequency, one.bandwidth):
            notes.append(
                f"a notch at {one.frequency:g} Hz that is {one.bandwidth:.4g} Hz wide is a low-pass, "
                "and is written as one"
            )
            one = FilterChoice("PT2", one.frequency, one.damping)
        made.append(one)
    return tuple(made), notes


def _settled(
    plant: Plant,
    found: Recommendation,
    filters: Sequence[FilterChoice],
    writer: Writer,
    facts: Facts,
    cases: Sequence[Case],
) -> tuple[list[Line], Cascade, tuple[Reached, ...]]:
    """Lines whose loop keeps the margins: of the recommendation, or slowed by a percent until it does."""
    whole, demand = found.cascade, found.demand
    loop = LoopSettings(whole.velocity_gain, whole.reset_time, whole.position_gain, tuple(filters))
    for _ in range(_TRIES):
        lines = writer.lines(loop, facts)
        typed = {line.parameter.name: line.typed for line in lines}
        cascade = writer.settings(typed, facts).on(whole)
        reached = tuple(reached_in(plant, cascade, case) for case in cases)
        inner, outer = _kept(reached, demand)
        if inner and outer:
            return lines, cascade, reached
        if not inner:
            loop = replace(loop, velocity_gain=_SLOWED * loop.velocity_gain, reset_time=loop.reset_time / _SLOWED)
        loop = replace(loop, position_gain=_SLOWED * loop.position_gain)
    raise InputError(
        f"{writer.form.title} keeps {demand.phase:g}° and {demand.gain:g} dB in no way that was found",
        plant.name,
        "ask for less",
    )


def _kept(reached: Sequence[Reached], demand: Demand) -> tuple[bool, bool]:
    """Whether the velocity loop holds in every case, and the position loop."""
    inner = all(holds(one.velocity, demand) for one in reached)
    return inner, all(holds(one.position, demand) and one.growth < GROWTH for one in reached)
