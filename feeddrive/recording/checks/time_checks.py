"""Is the time of a recording monotone and even? Refused if not, reported if it drifts."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from feeddrive.errors import InputError
from feeddrive.typing import FloatArray

_LONGEST_STEP = 1.5  # of the usual step: a missing sample makes 2, coarse time stamps (0.3 ms, 0.4 ms) up to 1.34
_SHORTEST_STEP = 0.5
_SAME_RATE = 0.02  # relative difference of mean steps between parts of a file that is one rate
_PARTS = 20
_SAID_DRIFT = 0.05  # of a sample: far below it no result changes
_SAID_RATE = 5e-6  # relative departure from a round sample time; quartz clocks are good to 50e-6


def check_time(time: FloatArray, first_row: int, where: str) -> None:
    """Refuse time stamps that are not evenly increasing.

    Args:
        time: (n,) [s], finite.
        first_row: row in the file of time[0].
        where: file name.

    Raises:
        InputError: time running backwards, duplicated stamps, gaps, two sample rates, irregular sampling.
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
        what = f"gap of {missing} missing sample{'s' if missing != 1 else ''} ({odd.size} gaps in the file)"
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
