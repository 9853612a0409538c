"""What is found in samples: saturation and quantisation, and stretches that no machine has made.

A flawed sample is not used, and neither are the rows that it reaches through a filter or a simulation: `diagnose`
leaves them out. Until then it is filled with the cubic through its neighbours, so that it does not ring.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from feeddrive.errors import InputError
from feeddrive.recording.channels import INJECTED, channel_unit
from feeddrive.typing import BoolArray, FloatArray
from feeddrive.units.quantity import format_quantity

_LIMITED_CHANNELS = ("motor_torque", "motor_current", "cutting_force")  # a position at rest sits at its end rightly
_NOT_MEASURED = ("setpoint", "screw_speed", *INJECTED)  # a ramp repeats its own step, a programme has few values
_FEWEST_LEVELS = 5
_SATURATED_SHARE = 0.01
_SATURATED_RUN = 3  # samples in a row at the limit


def sample_notes(channels: Mapping[str, FloatArray]) -> tuple[str, ...]:
    """Say saturation and quantisation of channels, (n,) each."""
    notes: list[str] = []
    for name, samples in channels.items():
        unit = channel_unit(name, "")
        notes.extend(_saturation(name, samples, unit) if name in _LIMITED_CHANNELS else ())
        step = 0.0 if name in _NOT_MEASURED else quantisation_step(samples)
        if step > 0.0:
            notes.append(f"{name} moves in steps of {format_quantity(step, 'K' if unit == 'degC' else unit)}")
    return tuple(notes)


def quantisation_step(samples: FloatArray) -> float:
    """Return the step that samples, (n,), move in, or 0 if they have none: median of the smallest differences."""
    differences = np.diff(np.unique(samples))
    # Rounding errors of a unit conversion split equal values.
    differences = differences[differences > 1e-10 * np.max(np.abs(samples), initial=0.0)]
    if differences.size < _FEWEST_LEVELS:
        return 0.0
    smallest = differences[differences < 1.5 * differences.min()]  # two steps would be 2.0
    # Differences of a channel without steps do not come again: one or two of them lie as near to the least.
    return float(np.median(smallest)) if smallest.size >= 3 + 0.002 * differences.size else 0.0


def _saturation(name: str, samples: FloatArray, unit: str) -> list[str]:
    """Say the limits that a channel sits at."""
    notes = []
    for limit in sorted({float(samples.max()), float(samples.min())}):
        at_limit = samples == limit
        share = float(np.mean(at_limit))
        if share > _SATURATED_SHARE and _longest_run(at_limit) >= _SATURATED_RUN:
            notes.append(
                f"{name} is saturated at {format_quantity(limit, unit)} in {100.0 * share:.1f} % of the samples"
            )
    return notes


def _longest_run(mask: BoolArray) -> int:
    """Return the length of the longest run of True."""
    edges = np.flatnonzero(np.diff(np.concatenate(([False], mask, [False]))))
    return int(np.max(edges[1::2] - edges[::2], initial=0))


IndexArray = NDArray[np.int64]

BAD, HELD, CLIPPED, JOINED = "bad", "held", "clipped", "joined"
"""Kinds: cells apart from their neighbours; a value repeated while the machine moved on; a value at its own limit; what
lies between two stretches of a long recording."""

COMPARED = ("motor_torque", "motor_current", "motor_torque_share", "motor_angle", "table_position")
"""Channels whose flawed rows can be left out of a comparison."""

_SUPPORT = 4
"""Samples on either side that a cubic is laid through."""


@dataclass(frozen=True, eq=False)
class Flaw:
    """Samples of one channel that are not what the machine did.

    Attributes:
        channel: in which they stand.
        kind: `BAD`, `HELD`, `CLIPPED` or `JOINED`.
        rows: their indices, increasing, (k,).
        level: the first value that stands there [unit of the channel].
        runs: of how many stretches.
    """

    channel: str
    kind: str
    rows: IndexArray
    level: float
    runs: int

    def between(self, first: int, last: int) -> Flaw:
        """Return the part with first <= row < last, counted from `first`."""
        inside = (self.rows >= first) & (self.rows < last)
        rows = self.rows[inside] - first
        return Flaw(self.channel, self.kind, rows, self.level, runs_in(rows))


def flaw(channel: str, kind: str, rows: Sequence[int] | IndexArray, samples: FloatArray) -> Flaw:
    """Return the flaw of some rows of a channel; samples is (n,)."""
    index = np.unique(np.asarray(rows, dtype=np.int64))
    return Flaw(channel, kind, index, float(samples[index[0]]), runs_in(index))


def resolution(samples: FloatArray) -> float:
    """Return the step that samples, (n,), move in, or else their least difference from row to row; 0 if none."""
    sizes = np.abs(np.diff(samples[:1_000_000]))
    sizes = sizes[sizes > 1e-12 * np.max(np.abs(samples), initial=0.0)]
    return max(quantisation_step(samples), float(sizes.min()) if sizes.size else 0.0)


def refuse_where_not_compared(flaws: Sequence[Flaw], first_row: int, where: str) -> None:
    """Refuse flaws in channels that are not compared row by row: a temperature, a growth, a force that drives.

    Raises:
        InputError: there is one.
    """
    for one in flaws:
        if one.channel not in COMPARED:
            level = format_quantity(one.level, channel_unit(one.channel, where))
            count = f" ({one.rows.size} such cells in the column)" if one.rows.size > 1 else ""
            place = f'{where}, row {first_row + int(one.rows[0])}, column "{one.channel}"'
            what = f"{level} is far from what stands beside it{count}"
            raise InputError(what, place, "write the mean of its neighbours in its place, or cut the file there")


def runs_in(rows: IndexArray) -> int:
    """Return of how many stretches increasing indices are."""
    return int(np.sum(np.diff(rows) > 1)) + 1 if rows.size else 0


def filled(channels: Mapping[str, FloatArray], flaws: Sequence[Flaw]) -> dict[str, FloatArray]:
    """Return the channels, (n,) each, with what is bad or held filled; clipped samples stay as they are."""
    result = dict(channels)
    for one in flaws:
        if one.kind != CLIPPED:
            result[one.channel] = _filled(result[one.channel], one.rows)
    return result


def sentence(one: Flaw, first_row: int) -> str:
    """Return a remark on a flaw; first_row is the row in the file of sample 0."""
    unit = channel_unit(one.channel, "")
    level, row = format_quantity(one.level, unit), first_row + int(one.rows[0])
    count = f"{one.rows.size} sample{'s' if one.rows.size > 1 else ''}"
    more = f", the first of {one.runs} places" if one.runs > 1 else ""
    what = {
        BAD: f"{count} far from what stands beside ({level} in row {row}{more})",
        HELD: f"{count} repeat a value while the machine moved on ({level} from row {row} on{more})",
        CLIPPED: f"{count} are cut off at {level} (from row {row} on{more})",
    }[one.kind]
    return f"{one.channel}: {what}; they and the rows beside them are left out of the comparison"


def _filled(samples: FloatArray, rows: IndexArray) -> FloatArray:
    result, good = samples.copy(), np.ones(samples.size, dtype=bool)
    good[rows] = False
    levels, step = np.unique(samples[good]), quantisation_step(samples[good])
    for run in np.split(rows, np.flatnonzero(np.diff(rows) > 1) + 1):
        before = np.flatnonzero(good[max(0, run[0] - 8 * _SUPPORT) : run[0]])[-_SUPPORT:] + max(
            0, run[0] - 8 * _SUPPORT
        )
        after = np.flatnonzero(good[run[-1] + 1 : run[-1] + 1 + 8 * _SUPPORT])[:_SUPPORT] + run[-1] + 1
        known = np.concatenate((before, after))
        if not known.size:
            continue
        centre, half = 0.5 * (known[0] + known[-1]), max(1.0, 0.5 * (known[-1] - known[0]))
        # Through both sides a cubic; beyond an end of the recording no more than a straight line.
        degree = min(3, known.size - 1) if before.size and after.size else min(1, known.size - 1)
        curve = np.polynomial.polynomial.polyfit((known - centre) / half, samples[known], degree)
        result[run] = _as_read(np.polynomial.polynomial.polyval((run - centre) / half, curve), levels, step)
    return result


def _as_read(values: FloatArray, levels: FloatArray, step: float) -> FloatArray:
    """Values, (n,), as a channel that moves in steps reads them: one value between two steps would hide the steps.

    levels: everything that the channel read, increasing.
    """
    if step == 0.0:
        return values
    place = np.clip(np.searchsorted(levels, values), 1, levels.size - 1)
    below, above = levels[place - 1], levels[place]
    read = below + step * np.rint((values - below) / step)
    return np.where(np.abs(read - above) < 0.5 * step, above, read)
