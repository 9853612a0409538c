"""Single samples that a machine cannot have made, and motion that jumps.

**Positions.** A step from row to row is odd where it is `FAR` times the steps around it:

    |x_(k+1) - x_k| > FAR m_k + 4 q,    m_k: four fifths of the steps within `AROUND` rows are smaller; q: resolution

Noise cannot do it: m_k is 1.28 standard deviations of white noise's steps, so that FAR m_k is ten of them. Nor can
motion, where rows are closer than what a drive does between them (`CLOSE`): a mass that starts, stops or vibrates
makes steps of like size for many rows. Two odd steps out and back within `MOST_CELLS` rows enclose bad cells. Where
rows lie further apart a table may go and come back between them. There, and for a jump that stays, more is asked: an
acceleration that no drive reaches, or a step that the other position does not make, far beyond what the transmission
gives.

**Torque, current, force, temperature.** They may step. A cell is bad where it is `ALONE` times as far from its
neighbours as any other cell of the recording and the motion beside it is not exceptional: a torque five times as large
as all others would turn the motor five times as hard.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from feeddrive.errors import InputError
from feeddrive.recording.channels import channel_unit
from feeddrive.recording.checks.flaws import BAD, Flaw, IndexArray, flaw
from feeddrive.typing import FloatArray
from feeddrive.units.quantity import format_quantity

FAR = 8.0
"""Step over those around it; see above."""

AROUND = 20
"""Rows on either side that tell how large steps are: at 20 kHz a millisecond, at 1 kHz a period of 25 Hz."""

MOST_CELLS = 3
"""Bad cells in a row at most; more of them are a stretch that is held or lost."""

CLOSE = 2e-3
"""Time between rows [s] up to which a drive's motion shows as steps of like size: its cycles take 0.03 to 2 ms."""

ALONE = 5.0
"""Distance of a cell over that of any other. Of white noise the largest is 1.5 times the next once in 10^3 at most."""

FRICTION = 20.0
"""Peak torque of a drive over its friction, at most: a larger motor is never built for an axis."""

FASTEST = {"table_position": 200.0, "motor_angle": 1e6}
"""Acceleration beyond any drive's [m/s^2, rad/s^2]: linear motors reach 20 g, a free rotor 3 N m / 10^-5 kg m^2."""

WINDUP = 20.0
"""Departure from the lead over its usual size, beyond which it is no give of the transmission: windup is bounded by the
torque, whose peak is some ten times its usual size."""

MOST_GIVE = 1e-4
"""Windup of a stiff axis under its peak thrust [m]: 10 kN over 100 N/µm."""

IN_PARTS = 100_000
"""Rows that are looked at together, each by itself: a recording does not take many times its memory."""

SPIKY = ("motor_torque", "motor_current", "motor_torque_share", "cutting_force")
"""Channels that step with the motion, or make it."""


@dataclass(frozen=True)
class Jump:
    """A motion that is not continuous: channel, index of the row before, step [unit of the channel]."""

    channel: str
    row: int
    step: float


def bad_cells(
    channels: Mapping[str, FloatArray], sample_time: float, steps: Mapping[str, float]
) -> tuple[list[Flaw], list[Jump]]:
    """Return bad cells, and motion that jumps.

    Args:
        channels: (n,) each.
        sample_time: between rows [s].
        steps: channel -> resolution that it moves in, 0 where it has none.
    """
    flaws, jumps = [], []
    for name in FASTEST:
        if name in channels:
            cells, jumped = _of_position(name, channels, sample_time, steps[name])
            jumps.extend(jumped)
            if cells.size:
                flaws.append(flaw(name, BAD, cells, channels[name]))
    for name, samples in channels.items():
        if name in SPIKY or name.endswith("_temperature") or name.startswith("table_growth"):
            motion = next((channels[one] for one in FASTEST if one in channels), None) if name in SPIKY else None
            cells = _alone(samples, steps[name], motion, name in SPIKY and sample_time > CLOSE * (1.0 + 1e-6))
            if cells.size and (motion is not None or name not in SPIKY):
                flaws.append(flaw(name, BAD, cells, samples))
    return flaws, jumps


def refuse_jumps(jumps: Sequence[Jump], first_row: int, where: str) -> None:
    """Refuse motion that is not continuous; first_row is the row in the file of sample 0.

    Raises:
        InputError: there is a jump.
    """
    if not jumps:
        return
    first = min(jumps, key=lambda jump: jump.row)
    same = [jump for jump in jumps if jump.channel == first.channel]
    more = f" ({len(same)} such jumps in the column)" if len(same) > 1 else ""
    step = format_quantity(first.step, channel_unit(first.channel, where))
    place = f'{where}, row {first_row + first.row + 1}, column "{first.channel}"'
    what = f"the motion jumps by {step} from one row to the next{more}"
    if first.channel == "motor_angle" and all(abs(abs(jump.step) - 2.0 * np.pi) < 0.1 * 2.0 * np.pi for jump in same):
        raise InputError(f"{what}: the angle begins again at every revolution", place, "record it over all revolutions")
    raise InputError(what, place, "rows are lost or written twice there: cut the file at that row, or record again")


def odd_steps(samples: FloatArray, resolution: float) -> IndexArray:
    """Return the indices k of the steps from k to k + 1 that those around them do not explain; samples is (n,).

    A channel that changes only every few rows, as its loop is slower than the recorder, is judged by its changes.
    """
    size = np.abs(np.diff(samples))
    places = np.flatnonzero(size) if rows_per_change(samples) > 1 else np.arange(size.size)
    size = size[places]
    reach = np.array([-13, -9, -6, -4, 4, 6, 9, 13])
    found = []
    for first in range(0, size.size, IN_PARTS):
        index = np.arange(first, min(first + IN_PARTS, size.size))
        beside = np.median([size[np.clip(index + r, 0, size.size - 1)] for r in reach], axis=0)
        found.append(index[size[index] > FAR * beside + 4.0 * resolution])
    likely = np.concatenate(found) if found else np.zeros(0, dtype=np.int64)
    odd = [k for k in likely.tolist() if size[k] > FAR * _around(size, k) + 4.0 * resolution]
    return places[odd].astype(np.int64)


def rows_per_change(samples: FloatArray) -> int:
    """Return how many rows a channel, (n,), holds its value where it moves fastest: 1 where each row is its own."""
    moved = np.abs(samples[AROUND:] - samples[:-AROUND])
    moving = moved[moved > 0.0]
    usual = float(np.quantile(moving, 0.9)) if moving.size else 0.0  # not the most, which may be a bad cell
    fast = np.flatnonzero(moved > 0.5 * usual) + AROUND // 2
    changes = float(np.mean(samples[fast] != samples[fast - 1])) if fast.size else 1.0
    return round(1.0 / max(changes, 1.0 / AROUND)) if changes < 0.6 else 1


def _around(size: FloatArray, k: int) -> float:
    """Return what four fifths of the steps around step k stay below, without the nearest."""
    gap = MOST_CELLS + 1
    beside = np.concatenate((size[max(0, k - AROUND) : max(0, k - gap + 1)], size[k + gap : k + AROUND + 1]))
    return float(np.quantile(beside, 0.8)) if beside.size else np.inf


def _of_position(
    name: str, channels: Mapping[str, FloatArray], sample_time: float, resolution: float
) -> tuple[IndexArray, list[Jump]]:
    samples = channels[name]
    odd = odd_steps(samples, resolution)
    if not odd.size:
        return odd, []
    sample_time = sample_time * rows_per_change(samples)
    cells: list[int] = []
    alone: list[int] = []
    position = 0
    while position < odd.size:
        k = int(odd[position])
        back = next((int(j) for j in odd[position + 1 : position + 4] if _returns(samples, k, int(j))), None)
        if back is not None and _impossible(name, channels, sample_time, k, True):
            cells.extend(range(k + 1, back + 1))
        elif back is None and _impossible(name, channels, sample_time, k, False):
            alone.append(k)
        position = int(np.searchsorted(odd, back if back is not None else k, side="right"))
    ends = [k for k in alone if k < MOST_CELLS or k >= samples.size - 1 - MOST_CELLS]
    for k in ends:  # at an end of the recording there is no way back to be seen
        cells.extend(range(k + 1) if k < MOST_CELLS else range(k + 1, samples.size))
    jumps = [Jump(name, k, float(samples[k + 1] - samples[k])) for k in alone if k not in ends]
    return np.array(sorted(cells), dtype=np.int64), jumps


def _returns(samples: FloatArray, k: int, j: int) -> bool:
    """Tell whether step j takes back what step k did."""
    out, back = samples[k + 1] - samples[k], samples[j + 1] - samples[j]
    return j - k <= MOST_CELLS and out * back < 0.0 and abs(out + back) < 0.5 * max(abs(out), abs(back))


def _impossible(name: str, channels: Mapping[str, FloatArray], sample_time: float, k: int, returns: bool) -> bool:
    """Tell whether no machine makes the odd step k."""
    if returns and sample_time <= CLOSE * (1.0 + 1e-6):
        return True
    step = abs(float(channels[name][k + 1] - channels[name][k]))
    if step / sample_time**2 > FASTEST[name]:
        return True
    if "motor_angle" not in channels or "table_position" not in channels:
        return False
    ratio, give = transmission(channels["motor_angle"], channels["table_position"])
    departs = np.diff(channels["table_position"][k : k + 2] - ratio * channels["motor_angle"][k : k + 2])
    return give > 0.0 and bool(abs(departs[0]) > give)


def transmission(angle: FloatArray, position: FloatArray) -> tuple[float, float]:
    """Return travel per angle [m/rad], and the departure from it [m] that is beyond what a transmission gives.

    The departure is `WINDUP` times that which a third of the motion stays below, and no less than `MOST_GIVE`; zeros
    where nothing moves. Shapes (n,).
    """
    apart = np.linspace(0, angle.size - 1, min(angle.size, 1000)).astype(np.int64)
    turned, moved = (np.diff(series[apart]) for series in (angle, position))
    fast = float(np.quantile(np.abs(turned), 0.95))  # not the fastest, which may be a bad cell
    strong = (np.abs(turned) >= 0.1 * fast) & (turned != 0.0)
    if not np.any(strong):
        return 0.0, 0.0
    ratio = float(np.median(moved[strong] / turned[strong]))
    departure = (position[apart] - ratio * angle[apart])[1:][strong]
    usual = float(np.quantile(np.abs(departure - np.median(departure)), 1.0 / 3.0))
    return ratio, max(WINDUP * usual, MOST_GIVE)


def _alone(samples: FloatArray, resolution: float, motion: FloatArray | None, slow: bool) -> IndexArray:
    """Return the cells that stand alone, and whose motion is not exceptional where it is known.

    Between slow rows a drive may accelerate and stop again: there a cell must be `FRICTION` times all others.
    """
    away = np.zeros(samples.size)  # at the ends, which are left out anyway, a step is not distinguished from a cell
    for first in range(2, samples.size - 2, IN_PARTS):
        last = min(first + IN_PARTS, samples.size - 2)
        beside = np.stack([samples[first + shift : last + shift] for shift in (-2, -1, 1, 2)])
        middle = 0.5 * (beside.sum(axis=0) - beside.max(axis=0) - beside.min(axis=0))
        away[first:last] = np.abs(samples[first:last] - middle)
    most = max(3 * MOST_CELLS, samples.size // 1000)
    order = np.argpartition(away, -most - 1)[-most - 1 :]
    order = order[np.argsort(away[order])[::-1]]
    sizes = away[order]
    gaps = np.flatnonzero(sizes[:-1] > ALONE * sizes[1:] + 8.0 * resolution)
    if not gaps.size:
        return np.zeros(0, dtype=np.int64)
    chosen, largest_other = order[: gaps[-1] + 1], sizes[gaps[-1] + 1]
    if slow and np.abs(samples[chosen]).min() < FRICTION * np.abs(np.delete(samples, chosen)).max():
        return np.zeros(0, dtype=np.int64)
    return np.array(
        [
            int(k)
            for k in np.sort(chosen)
            if _far(samples, int(k), chosen) > ALONE * largest_other + 8.0 * resolution
            and (motion is None or not _exceptional(motion, int(k), chosen))
        ],
        dtype=np.int64,
    )


def _far(samples: FloatArray, k: int, chosen: IndexArray) -> float:
    """Return how far a cell is from the median of those around it that are not suspected."""
    around = np.setdiff1d(np.arange(max(0, k - 6), min(samples.size, k + 7)), chosen)
    return abs(float(samples[k] - np.median(samples[around]))) if around.size else 0.0


def _exceptional(motion: FloatArray, k: int, chosen: IndexArray) -> bool:
    """Tell whether the motion bends beside row k as nowhere else; a torque acts on the rows that follow it."""
    bend = np.abs(np.diff(motion, 2))
    near = np.zeros(bend.size, dtype=bool)
    for shift in range(-4, 6):
        near[np.clip(chosen + shift, 0, bend.size - 1)] = True
    here = bend[max(0, k - 4) : k + 6].max(initial=0.0)
    return bool(here > bend[~near].max(initial=0.0))
