"""Rows that a flaw of the recording reaches, which are left out of the comparison.

A flaw in a channel that is compared reaches as far as the filter: its slowest poles, those of a Butterworth filter of
fourth order, fall as exp(-0.38 omega t), to 10^-4 within four periods of the band's edge. A flaw in the motor angle
drives the simulated load side too; at the ends of a recording that is given half a second, and a gap has two ends.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from feeddrive.diagnosis.motion.band import END_CUT, Band
from feeddrive.errors import InputError
from feeddrive.plant.plant import Plant
from feeddrive.recording import Recording
from feeddrive.recording.checks.copies import are_copies
from feeddrive.recording.checks.flaws import CLIPPED, JOINED, Flaw
from feeddrive.typing import BoolArray
from feeddrive.units.quantity import format_quantity

FILTER_PERIODS = 4.0
"""Periods of the band's edge that a flaw reaches through the filter; see above."""

SAME_LIMIT = 0.01
"""Share of the declared torque limit by which a torque at it may miss it: the motor's constant is known to that."""

LEAST_LEFT = 0.5
"""Share of the rows that is left at least: with more flawed than sound, it is another recording that is needed."""


def sound_rows(recording: Recording, torque_limit: float, band: Band) -> BoolArray:
    """Return the rows that no flaw reaches, (n,).

    Args:
        recording: with its flaws.
        torque_limit: of the declared drive [N m]; a torque cut off there is what the drive did.
        band: of the comparison.
    """
    sound = np.ones(len(recording), dtype=bool)
    for flaw in recording.flaws:
        if not _is_the_drives(flaw, torque_limit):
            seconds = END_CUT if flaw.channel == "motor_angle" else FILTER_PERIODS / band.edge
            reach = int(np.ceil(seconds / recording.sample_time))
            for run in np.split(flaw.rows, np.flatnonzero(np.diff(flaw.rows) > 1) + 1):
                sound[max(0, run[0] - reach) : run[-1] + reach + 1] = False
    return sound


def refuse_little_left(counted: BoolArray, recording: Recording) -> None:
    """Refuse a recording most of which its flaws reach; counted are the rows that are left, (n,).

    Raises:
        InputError: less than `LEAST_LEFT` of the rows are left; names the worst flaw.
    """
    flaws = [flaw for flaw in recording.flaws if flaw.kind != JOINED]  # joints are our own doing
    if not flaws or float(np.mean(counted)) >= LEAST_LEFT:
        return
    worst = max(flaws, key=lambda flaw: flaw.rows.size)
    unit = {"motor_current": "A", "motor_torque_share": "1", "motor_angle": "rad", "table_position": "m"}
    level = format_quantity(worst.level, unit.get(worst.channel, "N m"))
    did = {CLIPPED: f"is cut off at {level}"}.get(worst.kind, f"holds {worst.rows.size} samples that no machine made")
    what = f"{worst.channel} {did}, and only {100 * float(np.mean(counted)):.0f} % of the rows are out of reach of it"
    raise InputError(what, recording.name, "record again, with a range that is wide enough and no sample lost")


def without_copied_position(recording: Recording, plant: Plant) -> Recording:
    """Return the recording without a table position that is the motor angle times the lead, where the plant gives."""
    if not plant.chain.elastic or not are_copies(recording, "motor_angle", "table_position"):
        return recording
    channels = {name: samples for name, samples in recording.channels.items() if name != "table_position"}
    note = "table_position is the motor angle times the lead, not a scale on the table: it is not compared"
    return replace(recording, channels=channels, notes=(*recording.notes, note))


def _is_the_drives(flaw: Flaw, torque_limit: float) -> bool:
    limited = flaw.kind == CLIPPED and flaw.channel == "motor_torque"
    return limited and abs(abs(flaw.level) / torque_limit - 1.0) <= SAME_LIMIT
