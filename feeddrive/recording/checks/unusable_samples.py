"""What makes samples unusable: refused with file, row, column and the mend."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from feeddrive.errors import InputError
from feeddrive.recording.channels import MOTION_AND_TORQUE, channel_unit
from feeddrive.typing import FloatArray

FEWEST_ROWS = 100
"""A shorter recording holds neither a stroke nor enough samples for a filter."""


USUAL: dict[str, float] = {
    "time": 1e5,
    "setpoint": 10.0,
    "motor_torque": 1e3,
    "motor_current": 1e3,
    "motor_torque_share": 10.0,
    "motor_angle": 1e5,
    "motor_speed": 1e3,
    "table_position": 10.0,
    "table_velocity": 10.0,
    "screw_speed": 1e3,
    "cutting_force": 1e4,
    "injected_torque": 1e3,
    "injected_speed": 1e3,
}
"""Largest size of a channel that is usual on machine tools [SI unit]; 100 for temperatures, 1 mm for growths."""

BEYOND = 1e6
"""Over the usual size, from which a number is none that was measured, and no unit was mistaken."""

NOTHING = 1e-12
"""Share of the usual size below which a change is the rounding of the computer that wrote the file."""

FASTEST_ROWS, SLOWEST_ROWS = 1e-8, 1e5
"""Time between rows that is possible [s]: a recorder of 100 MHz, a row a day."""


def usual_size(channel: str) -> float:
    """Return the largest size of a channel that is usual [SI unit]."""
    return USUAL.get(channel, 1e-3 if channel.startswith("table_growth") else 100.0)


def check_size(samples: FloatArray, column: str, first_row: int, where: str) -> None:
    """Refuse numbers that nobody measures; samples is (n,), SI, finite, first_row the row in the file of samples[0].

    Raises:
        InputError: a sample is beyond `BEYOND` times the usual, or the channel changes by next to nothing.
    """
    unit, usual = channel_unit(column, where), usual_size(column)
    bad = np.flatnonzero(np.abs(samples) > BEYOND * usual)
    if bad.size:
        count = f" ({bad.size} such cells in the column)" if bad.size > 1 else ""
        place = f'{where}, row {first_row + int(bad[0])}, column "{column}"'
        what = f"{samples[bad[0]]:.3g} {unit} is a million times what is usual{count}"
        raise InputError(what, place, "correct the cell, or the unit of the column")
    change = float(np.ptp(samples))
    if 0.0 < change < NOTHING * usual:
        what = f"the channel changes by no more than {change:.3g} {unit}"
        raise InputError(what, f'{where}, column "{column}"', "correct the unit, or leave the column out")


def check_sample_time(sample_time: float, where: str) -> None:
    """Refuse a time between rows [s] that no recorder has.

    Raises:
        InputError: it is shorter than `FASTEST_ROWS` or longer than `SLOWEST_ROWS`.
    """
    if not FASTEST_ROWS <= sample_time <= SLOWEST_ROWS:
        what = f"the rows are {sample_time:.3g} s apart"
        raise InputError(what, f'{where}, column "time"', "correct the unit of the time")


def check_length(rows: int, where: str) -> None:
    """Refuse recordings that are too short.

    Raises:
        InputError: fewer than `FEWEST_ROWS` rows.
    """
    if rows < FEWEST_ROWS:
        raise InputError(f"only {rows} rows of numbers", where, f"record at least {FEWEST_ROWS} samples")


def check_finite(samples: FloatArray, column: str, first_row: int, where: str) -> None:
    """Refuse NaN and infinity; samples is (n,), first_row the row in the file of samples[0].

    Raises:
        InputError: a sample is not finite.
    """
    bad = np.flatnonzero(~np.isfinite(samples))
    if bad.size:
        kind = "NaN" if np.isnan(samples[bad[0]]) else "infinite"
        count = f" ({bad.size} such cells in the column)" if bad.size > 1 else ""
        place = f'{where}, row {first_row + int(bad[0])}, column "{column}"'
        raise InputError(f"the value is {kind}{count}", place, "cut the file there, or record again")


def check_alive(channels: Mapping[str, FloatArray], where: str) -> None:
    """Refuse motion and torque channels, (n,) each, that never change.

    Raises:
        InputError: such a channel is constant.
    """
    for name in MOTION_AND_TORQUE:
        samples = channels.get(name)
        if samples is not None and bool(np.all(samples == samples[0])):
            what = f"the channel never changes, it is {samples[0]:g} in every row"
            raise InputError(what, f'{where}, column "{name}"', "check the sensor, or leave the column out")
