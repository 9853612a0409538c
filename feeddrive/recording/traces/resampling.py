"""Signals with times of their own brought onto one even grid, knowingly: the rule is stated, and so is what was done.

The grid is that of the slowest channel of motion or torque, or the rate that is asked for: nothing is made up between
its samples. Positions and speeds are read at the instants of the grid, between samples on the straight line. A torque
or current acts from its sample to the next, so it becomes the mean over each step of the grid. Lost stretches divide
the signals into parts.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from feeddrive.errors import InputError
from feeddrive.recording.channels import INJECTED
from feeddrive.typing import FloatArray

HELD = ("motor_torque", "motor_current", "motor_torque_share", "cutting_force", *INJECTED)
_LONGEST_STEP = 1.5  # of the usual step: a missing sample makes 2, coarse time stamps up to 1.34
_SAME = 1e-6  # relative difference of steps that are the same
_MOST_PARTS = 0.01  # of the samples: more breaks are no lost stretches but irregular sampling


@dataclass(frozen=True, eq=False)
class Series:
    """A channel with its own time: time and values are (n,), in s and SI."""

    time: FloatArray
    values: FloatArray


@dataclass(frozen=True)
class Part:
    """A stretch without a gap, from `start` to `stop` [s], both ends sampled."""

    start: float
    stop: float


def usual_step(time: FloatArray) -> float:
    """Return the median distance of time stamps, (n,) [s], n >= 2."""
    return float(np.median(np.diff(time)))


def gaps(time: FloatArray) -> list[tuple[int, int]]:
    """Return for each lost stretch the index of the sample before it and the number of samples that are missing."""
    if time.size < 3:
        return []
    steps, usual = np.diff(time), usual_step(time)
    found = np.flatnonzero(steps > _LONGEST_STEP * usual)
    return [(int(i), round(float(steps[i]) / usual) - 1) for i in found]


def parts_of(series: Mapping[str, Series], where: str) -> list[Part]:
    """Return the stretches in which every channel is sampled without a gap.

    Raises:
        InputError: channels that share no time, or irregular sampling.
    """
    common: list[Part] | None = None
    seen: list[tuple[FloatArray, float]] = []
    for name, one in series.items():
        time = one.time
        if time.size < 2:
            raise InputError("a channel has fewer than two samples", where, "record again, or leave it out")
        # A torque acts, and a temperature stands, for a step beyond its last sample.
        beyond = usual_step(time) if name in HELD or name.endswith("_temperature") else 0.0
        if any(beyond == other and same_time(time, known) for known, other in seen):
            continue
        seen.append((time, beyond))
        breaks = [i for i, _ in gaps(time)]
        if len(breaks) > max(5.0, _MOST_PARTS * time.size):
            what = (
                f"irregular sampling: {len(breaks)} of {time.size} steps are longer than {_LONGEST_STEP:g} usual ones"
            )
            raise InputError(what, where, "record or export it with an even clock")
        edges = [-1, *breaks, time.size - 1]
        own = [Part(float(time[a + 1]), float(time[b]) + beyond) for a, b in pairwise(edges)]
        common = own if common is None else _both(common, own)
    if not common:
        raise InputError("the channels share no time", where, "map channels that were recorded together")
    return common


def part_read(parts: Sequence[Part], wished: int | None, where: str) -> tuple[int, Part]:
    """Return number, 1 for the first, and extent of the part that is read: the longest unless another is wished.

    Raises:
        InputError: there is no such part.
    """
    number = wished or 1 + max(range(len(parts)), key=lambda i: parts[i].stop - parts[i].start)
    if not 1 <= number <= len(parts):
        raise InputError(f"there is no part {number}", where, f"it has {len(parts)}")
    return number, parts[number - 1]


def _both(first: Sequence[Part], second: Sequence[Part]) -> list[Part]:
    overlaps = (Part(max(a.start, b.start), min(a.stop, b.stop)) for a in first for b in second)
    return [part for part in overlaps if part.stop > part.start]


def same_time(first: FloatArray, second: FloatArray) -> bool:
    """Tell whether two signals were sampled at the same instants."""
    return first is second or (first.size == second.size and bool(np.array_equal(first, second)))


def on_one_grid(
    series: Mapping[str, Series], part: Part, rate: float | None, where: str
) -> tuple[FloatArray, dict[str, FloatArray], tuple[str, ...]]:
    """Return the time of the grid, (n,) [s], the channels on it, (n,) each, and what was done.

    Args:
        series: channel -> its samples.
        part: stretch that is taken.
        rate: samples per second; None for that of the slowest channel.
        where: file name.

    Raises:
        InputError: a rate that is not possible.
    """
    inside = {name: _cut(one, part) for name, one in series.items()}
    slow = {name for name in inside if name.endswith("_temperature") or name == "setpoint"}
    fast = {name: one for name, one in inside.items() if name not in slow} or inside
    step = max(usual_step(one.time) for one in fast.values()) if rate is None else 1.0 / rate
    count = (part.stop - part.start) / step
    if count > 1e8:
        raise InputError(f"a rate of {1.0 / step:g} Hz makes {count:.3g} samples", where, "give a lower --rate")
    own = next((one.time for one in fast.values() if abs(usual_step(one.time) / step - 1.0) < _SAME), None)
    if own is not None:
        grid: FloatArray = own if own[0] >= part.start and own[-1] <= part.stop else _inside(own, part)
    else:
        grid = part.start + step * np.arange(int(np.floor(count * (1.0 + 1e-12))) + 1, dtype=np.float64)
    made: dict[str, FloatArray] = {}
    done: dict[str, list[str]] = {}
    for name, one in inside.items():
        made[name], how = _on(name, one, grid, step)
        if how:
            done.setdefault(how, []).append(name)
    remarks = [f"{', '.join(names)} {how}" for how, names in done.items()]
    return grid, made, ((f"one grid of {step * 1e3:.6g} ms: " + "; ".join(remarks),) if remarks else ())


def _cut(one: Series, part: Part) -> Series:
    """Return the samples of a part, with the one before its start: it is held, or begins the line, across the start."""
    first = max(0, int(np.searchsorted(one.time, part.start, side="right")) - 1)
    last = int(np.searchsorted(one.time, part.stop, side="left")) + 1
    return Series(one.time[first:last], one.values[first:last])


def _inside(time: FloatArray, part: Part) -> FloatArray:
    found: FloatArray = time[(time >= part.start) & (time <= part.stop)]
    return found


def _on(name: str, one: Series, grid: FloatArray, step: float) -> tuple[FloatArray, str]:
    """Return a channel on the grid, and what was done; nothing where its samples are those of the grid."""
    if same_time(one.time, grid):  # as they are: no second copy of a long recording
        return one.values, ""
    at = np.searchsorted(one.time, grid)
    if at.size and at[-1] < one.time.size and np.array_equal(one.time[at], grid):
        finer = usual_step(one.time) < (1.0 - _SAME) * step
        if not (finer and name in HELD):
            return one.values[at], "taken at its instants" if finer else ""
    if name not in HELD:
        return np.interp(grid, one.time, one.values), "read between its samples on a straight line"
    if usual_step(one.time) < (1.0 - _SAME) * step:
        return _mean(one, grid, step), "averaged over each step, in which it acts"
    before = np.clip(np.searchsorted(one.time, grid, side="right") - 1, 0, None)
    return one.values[before], "held from its sample to the next"


def _mean(one: Series, grid: FloatArray, step: float) -> FloatArray:
    """Return the mean of a held signal over each step of the grid."""
    own = usual_step(one.time)
    # Moved by its mean, so that the integral does not lose digits over a long recording.
    level = float(np.mean(one.values))
    edges = np.append(one.time, one.time[-1] + own)
    integral = np.concatenate(([0.0], np.cumsum((one.values - level) * np.diff(edges))))
    ends = np.minimum(grid + step, edges[-1])
    starts = np.clip(grid, edges[0], edges[-1])
    width = np.maximum(ends - starts, 1e-3 * own)
    found: FloatArray = level + (np.interp(ends, edges, integral) - np.interp(starts, edges, integral)) / width
    return found
