"""Flaws of a recording: values that repeat, and what is apart from its neighbours.

Values that repeat while the machine moves on: a recorder that held its last one, and a range that was too small.

A run of equal values of a position is held where the position afterwards makes up at once for at least half of what it
would have moved by meanwhile, at the lower of the speeds before and after; or where the other position moves on by far
more than the transmission gives.

A run of equal values of a torque is held where what stands beside it is noise, and noise as large as that does not
repeat itself so often:

    n p^(L - 1) < RARE,    p = (equal neighbours + 1) / (neighbours + 2)  within `BESIDE` rows before and after
    noise: median |D4| / (0.6745 sqrt 70) > 0.6 resolutions on both sides; rounding alone makes 0.29

| symbol | meaning |
|---|---|
| n | rows of the recording |
| L | length of the run |
| D4 | fourth difference; 70 is its power of white noise |

A torque that is held by a slower loop, coarse steps at slow speed, a record without noise, and rest have a p near one,
no such noise, or no motion. A run at the channel's own largest or smallest value is clipped, not held.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from feeddrive.recording.checks.bad_cells import CLOSE, SPIKY, bad_cells, refuse_jumps, transmission
from feeddrive.recording.checks.flaws import (
    CLIPPED,
    HELD,
    Flaw,
    IndexArray,
    filled,
    flaw,
    refuse_where_not_compared,
    resolution,
)
from feeddrive.typing import FloatArray

RARE = 1e-3
"""Runs that noise makes in a recording by chance, at most."""

BESIDE = 50
"""Rows on either side that tell what a channel does between."""

SHORTEST_HELD = 3
"""Rows of a held position at least: a recorder that is slower than its rows repeats one of them now and then."""

MOST_REPEATS = 0.2
"""Share of rows beside a run that repeat the one before, at most: more are those of a slower loop or coarse steps."""

NOISY = 0.6
"""Noise over resolution from which it is noise and not rounding, which makes 0.29."""

AROUND = 20
"""Rows on either side that tell how fast a position moves."""

POSITIONS = ("motor_angle", "table_position")


def held_and_clipped(channels: Mapping[str, FloatArray], sample_time: float, steps: Mapping[str, float]) -> list[Flaw]:
    """Return what is held or clipped in positions and torques, (n,); steps are channel -> resolution, 0 if none."""
    found: list[Flaw] = []
    for name in (*POSITIONS, *SPIKY):
        if name in channels:
            first, length = runs(channels[name])
            held = _held(name, channels, sample_time, steps, first, length)
            found.extend(_sorted_out(name, channels[name], first[held], length[held]))
    return found


def runs(samples: FloatArray) -> tuple[IndexArray, IndexArray]:
    """Return first index and length of the runs of three and more equal samples, (n,)."""
    same = np.concatenate(([False], samples[1:] == samples[:-1], [False]))
    edges = np.flatnonzero(same[1:] != same[:-1])
    first, last = edges[::2], edges[1::2]
    whole = last - first >= SHORTEST_HELD - 1
    return first[whole].astype(np.int64), (last - first + 1)[whole].astype(np.int64)


def _held(
    name: str,
    channels: Mapping[str, FloatArray],
    sample_time: float,
    steps: Mapping[str, float],
    first: IndexArray,
    length: IndexArray,
) -> NDArray[np.bool_]:
    if name in POSITIONS:
        other = POSITIONS[1 - POSITIONS.index(name)]
        held = _made_up_for(channels[name], steps[name], first, length)
        return held | _left_behind(name, other, channels, steps, first, length) if other in channels else held
    motion = next((channels[one] for one in POSITIONS if one in channels), None)
    if motion is None or sample_time > CLOSE * (
        1.0 + 1e-6
    ):  # slower rows turn any vibration into what looks like noise
        return np.zeros(first.size, dtype=bool)
    moved = next(steps[one] for one in POSITIONS if one in channels)
    return _repeats_noise(channels[name], steps[name], motion, moved, first, length)


def _made_up_for(samples: FloatArray, resolution: float, first: IndexArray, length: IndexArray) -> NDArray[np.bool_]:
    """Tell runs after which the position makes up for what it did not move."""
    last = first + length - 1
    step = samples[np.minimum(last + 1, samples.size - 1)] - samples[last]
    held = np.zeros(first.size, dtype=bool)
    # In a channel that is itself held for some rows most steps are none: asked first, as there are many such runs.
    same = np.concatenate(([0], np.cumsum(samples[1:] == samples[:-1])))
    after = np.minimum(last + 1, samples.size - 1)
    beyond = np.minimum(after + AROUND, samples.size - 1)
    still = (same[first] - same[np.maximum(first - AROUND, 0)], same[beyond] - same[after])
    likely = (np.abs(step) > 3.0 * resolution) & (np.maximum(*still) <= AROUND // 2)
    for i in np.flatnonzero(likely).tolist():
        beside = samples[max(0, first[i] - AROUND) : first[i] + 1], samples[last[i] + 1 : last[i] + 2 + AROUND]
        if min(map(len, beside)) < AROUND // 2:
            continue
        speeds = [math.copysign(1.0, step[i]) * float(part[-1] - part[0]) / (part.size - 1) for part in beside]
        usual = [float(np.median(np.abs(np.diff(part)))) for part in beside]
        expected = min(speeds) * float(length[i])
        moves = all(one > 0.3 * speed for one, speed in zip(usual, speeds, strict=True))
        least = 6.0 * max(resolution, *map(_noise, beside))
        # A short stop at slow rows is no dropout: nothing is made up for, the first step is like those that follow.
        jumps = abs(step[i]) > 2.0 * max(float(np.quantile(np.abs(np.diff(part)), 0.8)) for part in beside)
        held[i] = moves and jumps and expected > least and abs(step[i]) >= 0.5 * expected
    return held


def _left_behind(
    name: str,
    other: str,
    channels: Mapping[str, FloatArray],
    steps: Mapping[str, float],
    first: IndexArray,
    length: IndexArray,
) -> NDArray[np.bool_]:
    """Tell runs during which the other position moves on by more than the transmission gives."""
    ratio, give = transmission(channels["motor_angle"], channels["table_position"])
    if ratio == 0.0 or give == 0.0 or not first.size:
        return np.zeros(first.size, dtype=bool)
    ends = np.ravel(np.column_stack((first, np.minimum(first + length - 1, channels[other].size - 1))))
    largest, least = (extreme.reduceat(channels[other], ends)[::2] for extreme in (np.maximum, np.minimum))
    moved = largest - least
    moved = moved * abs(ratio) if other == "motor_angle" else moved
    resolved = steps[name] * (abs(ratio) if name == "motor_angle" else 1.0)
    held: NDArray[np.bool_] = moved > give + 8.0 * resolved
    return held


def _repeats_noise(
    samples: FloatArray,
    resolution: float,
    motion: FloatArray,
    motion_resolution: float,
    first: IndexArray,
    length: IndexArray,
) -> NDArray[np.bool_]:
    """Tell runs that noise as large as that beside them would not make, while the machine moves."""
    n, last = samples.size, first + length - 1
    equal = np.concatenate(([0], np.cumsum(samples[1:] == samples[:-1])))
    ends = (np.maximum(first - BESIDE, 0), first - 1, np.minimum(last + 1, n - 1), np.minimum(last + 1 + BESIDE, n - 1))
    pairs = (ends[1] - ends[0]) + (ends[3] - ends[2])
    same = (equal[ends[1]] - equal[ends[0]]) + (equal[ends[3]] - equal[ends[2]])
    repeats = (same + 1.0) / (pairs + 2.0)
    rare = (math.log(n) + (length - 1) * np.log(repeats) < math.log(RARE)) & (repeats < MOST_REPEATS)
    moved = np.abs(motion[np.minimum(last + 2, n - 1)] - motion[np.maximum(first - 2, 0)])
    inside = (first >= BESIDE // 4) & (last < n - BESIDE // 4)  # beside a run at an end there is nothing to tell
    likely: NDArray[np.bool_] = rare & inside & (moved > 6.0 * motion_resolution)
    if not np.any(likely) or _quietest_noise(samples) <= NOISY * resolution:
        return np.zeros(first.size, dtype=bool)
    for i in np.flatnonzero(likely).tolist():
        beside = (samples[ends[0][i] : first[i]], samples[last[i] + 1 : ends[3][i] + 1])
        speeds = [np.median(np.abs(np.diff(motion[a:b]))) for a, b in ((ends[0][i], first[i]), (last[i], ends[3][i]))]
        goes_on = moved[i] >= 0.2 * min(speeds) * float(length[i])
        likely[i] = goes_on and min(speeds) > 0.0 and all(_noise(part) > NOISY * resolution for part in beside)
    return likely


def _noise(part: FloatArray) -> float:
    """Return the white noise of a stretch, (k,), by its median, which a few steps leave alone; 0 if too short."""
    return float(np.median(np.abs(np.diff(part, 4)))) / (0.6745 * math.sqrt(70.0)) if part.size >= 10 else 0.0


def _quietest_noise(samples: FloatArray) -> float:
    """Return the white noise of a channel, by the quietest tenth of its stretches in which anything changes."""
    length = 64
    count = samples.size // length
    levels = np.array([_noise(part) for part in samples[: count * length].reshape(count, length)])
    levels = levels[levels > 0.0]
    return float(np.quantile(levels, 0.1)) if levels.size else 0.0


def _sorted_out(name: str, samples: FloatArray, first: IndexArray, length: IndexArray) -> list[Flaw]:
    """Return held runs and clipped ones apart; where a limit is clipped, every pair of samples at it is."""
    limits = (float(samples.min()), float(samples.max()))
    held: list[int] = []
    clipped: set[float] = set()
    for start, count in zip(first.tolist(), length.tolist(), strict=True):
        if samples[start] in limits:
            clipped.add(float(samples[start]))
        else:
            held.extend(range(start, start + count))
    found = [flaw(name, HELD, held, samples)] if held else []
    for limit in sorted(clipped):
        at = samples == limit
        beside = np.concatenate((at[1:], [False])) | np.concatenate(([False], at[:-1]))
        found.append(flaw(name, CLIPPED, np.flatnonzero(at & beside), samples))
    return found


def find_flaws(channels: Mapping[str, FloatArray], sample_time: float, first_row: int, where: str) -> list[Flaw]:
    """Return the flaws of a recording whose rows can be left out; `first_row` is the row in the file of sample 0.

    Raises InputError: motion that jumps, or a bad cell in a channel that is not compared row by row.
    """
    steps = {name: resolution(samples) for name, samples in channels.items()}
    bad, _ = bad_cells(channels, sample_time, steps)
    # A bad cell of one position looks as if the other were left behind; and what was held is made up for by a jump.
    held = held_and_clipped(filled(channels, bad), sample_time, steps)
    more, jumps = bad_cells(filled(channels, [*bad, *held]), sample_time, steps)
    ends = {(one.channel, int(row)) for one in held for row in one.rows}
    refuse_jumps([jump for jump in jumps if (jump.channel, jump.row) not in ends], first_row, where)
    flaws = [*bad, *more, *held]
    refuse_where_not_compared(flaws, first_row, where)
    return flaws
