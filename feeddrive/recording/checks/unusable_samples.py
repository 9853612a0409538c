"""What makes samples unusable: refused with file, row, column and the mend."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

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
        raise InputError(
            f"only {rows} row{'s' if rows != 1 else ''} of numbers", where, f"record at least {FEWEST_ROWS} samples"
        )


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


_LONGEST_STEP = 1.5  # of the usual step: a missing sample makes 2, coarse time stamps (0.3 ms, 0.4 ms) up to 1.34
_SHORTEST_STEP = 0.5
_SAME_RATE = 0.02  # relative difference of mean steps between parts of a file that is one rate
_PARTS = 20
_SAID_DRIFT = 0.05  # of a sample: far below it no result changes
_SAID_RATE = 5e-6  # relative departure from a round sample time; quartz clocks are good to 50e-6


def check_time(time: FloatArray, first_row: int, where: str) -> None:
    """Refuse times (n,) [s], finite, that are not evenly increasing; time[0] stands in row `first_row` of the file.

    Time running backwards, duplicated stamps, gaps, two sample rates, irregular sampling.
    """
    steps = np.diff(time)
    _refuse_not_increasing(time, steps, first_row, where)
    usual = float(np.median(steps))
    odd = np.flatnonzero((steps > _LONGEST_STEP * usual) | (steps < _SHORTEST_STEP * usual))
    if odd.size:
        raise _uneven(steps, odd, usual, first_row, where)
    _refuse_two_rates(time, where)


def mean_sample_time(time: FloatArray) -> float:
    """Return the mean distance of the samples [s], freed of rounding errors; time is (n,) [s], n >= 2."""
    return float(f"{(time[-1] - time[0]) / (time.size - 1):.12g}")


def clock_notes(time: FloatArray, sample_time: float) -> tuple[str, ...]:
    """Say a clock that drifts within the recording or runs beside a round sample time; time is (n,) [s]."""
    grid = time[0] + sample_time * np.arange(time.size)
    away = float(np.max(np.abs(time - grid))) / sample_time
    written = _written_step(time)
    notes = []
    if away > _SAID_DRIFT and away * sample_time > 1.01 * written:
        notes.append(f"clock drift: time stamps leave an even grid by up to {away:.2g} samples")
    round_value = float(f"{sample_time:.2g}")
    round_rate = 1.0 / float(f"{1.0 / sample_time:.2g}")
    off = min((sample_time / nominal - 1.0 for nominal in (round_value, round_rate)), key=abs)
    resolved = written / float(time[-1] - time[0])
    if max(_SAID_RATE, 2.0 * resolved) < abs(off) < 1e-3:
        notes.append(f"clock drift: the sample time is {sample_time:.8g} s, {off * 1e6:+.0f} ppm from a round value")
    return tuple(notes)


def _refuse_not_increasing(time: FloatArray, steps: FloatArray, first_row: int, where: str) -> None:
    bad = np.flatnonzero(steps <= 0.0)
    if not bad.size:
        return
    index = int(bad[0])
    place = f'{where}, row {first_row + index + 1}, column "time"'
    if steps[index] == 0.0:
        times = f"{bad.size} times" if bad.size > 1 else "once"
        what = f"the time stamp {time[index]:g} s is there twice (duplicated stamps: {times} in the file)"
        raise InputError(what, place, "remove repeated rows, or write the time with more digits")
    what = f"time runs backwards, from {time[index]:g} s to {time[index + 1]:g} s"
    raise InputError(what, place, "sort the rows by time, one run to a file")


def _uneven(steps: FloatArray, odd: NDArray[np.int64], usual: float, first_row: int, where: str) -> InputError:
    """Name what uneven steps are: two rates, a gap, or no order at all."""
    first = int(odd[0])
    place = f'{where}, row {first_row + first + 1}, column "time"'
    one_block = odd.size >= 10 and int(odd[-1]) - first + 1 == odd.size
    if one_block:
        other = float(np.median(steps[odd]))
        what = f"two sample rates in one file: steps of {usual:g} s and of {other:g} s"
        return InputError(what, place, "split the file, or resample it to one rate")
    if bool(np.all(steps[odd] > usual)) and odd.size <= 0.05 * steps.size:
        missing = round(float(steps[first]) / usual) - 1
        gaps = "1 gap" if odd.size == 1 else f"{odd.size} gaps"
        what = f"gap of {missing} missing sample{'s' if missing != 1 else ''} ({gaps} in the file)"
        return InputError(what, place, "record without interruption, or cut the file at the gap")
    what = f"irregular sampling: a step of {steps[first]:g} s where most are {usual:g} s ({odd.size} such steps)"
    return InputError(what, place, "resample the file to one rate")


def _refuse_two_rates(time: FloatArray, where: str) -> None:
    """Refuse rates whose steps differ too little to stand out one by one."""
    ends = np.linspace(0, time.size - 1, _PARTS + 1).astype(np.int64)
    steps = np.diff(time[ends]) / np.diff(ends)
    # Stamps written with few digits blur the mean step of a part by that digit.
    blur = 2.0 * _written_step(time) / float(np.min(np.diff(ends)))
    if steps.max() - steps.min() > _SAME_RATE * steps.min() + blur:
        what = f"two sample rates in one file: mean steps from {steps.min():.4g} s to {steps.max():.4g} s"
        raise InputError(what, f'{where}, column "time"', "split the file, or resample it to one rate")


def _written_step(time: FloatArray) -> float:
    """Return the last digit that the time stamps are written with [s]; 0 if they have more than nine decimals."""
    rounding = 1e-12 * np.maximum(1.0, np.abs(time))
    for decimals in range(10):
        if bool(np.all(np.abs(np.round(time, decimals) - time) < rounding)):
            return float(10.0**-decimals)
    return 0.0
