"""A long recording as one recording of its informative stretches, with what the rest says as statistics.

Between two stretches the motor is moved on by a motion that a drive could make, a polynomial of fifth degree that meets
position, speed and acceleration at both ends, and the clock goes on over what is left out. Rows in between are flawed,
and so are those behind until the machine has moved far enough to have forgotten where it came from.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from feeddrive.recording.checks.flaws import JOINED, Flaw, IndexArray, flaw
from feeddrive.recording.long.windows import Rows, informative_windows
from feeddrive.recording.recording import Recording
from feeddrive.typing import BoolArray, FloatArray

LONGEST = 400_000
"""Rows up to which a recording is taken whole: seven minutes at 1 kHz."""

KEPT_ROWS, KEPT = 100_000, 60.0
"""Rows that are kept of a longer one, and seconds [s] at least: of a search that runs the machine some thousand times,
minutes."""

LEAST_BRIDGE = 0.5
"""Time between two stretches at least [s]."""

FORGOTTEN = 0.5e-3
"""Way of the table [m] behind which it is the motion before that tells on which flank the nut is: several times any
play, wind-up and presliding distance."""

SLOWEST_WITHIN = 1.0
"""Time about the end of a window [s] within which the stretch ends where the motion is slowest."""

REACHED = 0.999
"""Share of the moving rows whose speed and acceleration the way between two stretches may reach: the drive can."""

FITTED = 8
"""Rows that speed and acceleration at an end are taken from."""


def shortened(recording: Recording, radius: float, split: float = 1.0) -> Recording:
    """The recording, or where it is long what is informative of it and notes on the rest.

    `radius` is travel per angle of the motor [m/rad]; of what is kept a share `split` is fitted, the rest judged.
    """
    name = next((one for one in ("motor_angle", "table_position") if one in recording), None)
    if len(recording) <= LONGEST or name is None:
        return recording
    seconds = max(KEPT_ROWS * recording.sample_time, KEPT)
    windows, judged = informative_windows(recording, seconds, split)
    stretches = _ended_slowly(recording[name], windows, recording.sample_time)
    return _joined(recording, name, stretches, judged, radius if name == "motor_angle" else 1.0)


def is_joined(recording: Recording) -> bool:
    """Tell whether a recording is what was kept of a long one."""
    return any(one.kind == JOINED for one in recording.flaws)


def clock(recording: Recording) -> FloatArray:
    """Time of the samples since the first, (n,) [s]: even, but where stretches are joined."""
    if is_joined(recording):
        since: FloatArray = recording.time - recording.time[0]
        return since
    return np.arange(len(recording), dtype=np.float64) * recording.sample_time


def recorded(recording: Recording) -> BoolArray:
    """Tell the rows that were recorded, (n,): all but those between stretches, which have no noise of a sensor."""
    found = np.ones(len(recording), dtype=bool)
    for one in recording.flaws:
        if one.kind == JOINED:
            found[one.rows] = False
    return found


def first_stretch(recording: Recording) -> float:
    """Time [s] that the first stretch of a joined recording lasts; 0 for one that is whole."""
    own = recorded(recording)
    return 0.0 if own.all() else float(np.argmin(own)) * recording.sample_time


def _ended_slowly(position: FloatArray, windows: list[Rows], sample_time: float) -> list[Rows]:
    """The stretches with both ends moved inwards to where the motion is slowest nearby."""
    reach = round(SLOWEST_WITHIN / sample_time)
    found = []
    for first, last in windows:
        begins = first + int(np.argmin(np.abs(np.diff(position[first : first + reach]))))
        ends = last - reach + int(np.argmin(np.abs(np.diff(position[last - reach : last]))))
        found.append((begins, ends + 1))
    return found


def _joined(recording: Recording, name: str, stretches: list[Rows], judged: list[Rows], radius: float) -> Recording:
    step, position = recording.sample_time, recording[name]
    low, high, fastest, hardest = _usual(position, step)
    parts: dict[str, list[FloatArray]] = {channel: [] for channel in ("time", *recording.channels)}
    flaws: list[Flaw] = []
    bridged: list[IndexArray] = []
    apart: list[BoolArray] = []
    at = 0
    for number, (first, last) in enumerate(stretches):
        if number:
            before = stretches[number - 1][1]
            bridge = _bridge(
                position[before - FITTED : before], position[first : first + FITTED], step, fastest, hardest
            )
            bridge = np.clip(bridge, low, high)  # on the screw
            share = np.arange(1, len(bridge) + 1) / (len(bridge) + 1)
            parts["time"].append(
                recording.time[before - 1] + share * (recording.time[first] - recording.time[before - 1])
            )
            for channel, samples in recording.channels.items():
                parts[channel].append(
                    _between(channel, samples[before - 1], samples[first], share, bridge, name, radius, step,
                             (position[before - 1], position[first]))
                )  # fmt: skip
            way = np.abs(position[first:last] - position[first]) * radius
            unknown = int(np.argmax(way > FORGOTTEN)) if np.any(way > FORGOTTEN) else last - first
            bridged.append(np.arange(at, at + len(bridge) + unknown))
            at += len(bridge)
            apart.append(np.zeros(len(bridge), dtype=bool))
        apart.append(np.zeros(last - first, dtype=bool))
        for begin, end in judged:
            apart[-1][max(begin - first, 0) : max(end - first, 0)] = True
        parts["time"].append(recording.time[first:last])
        for channel, samples in recording.channels.items():
            parts[channel].append(samples[first:last])
        for one in recording.flaws:
            inside = one.between(first, last)
            flaws += [replace(inside, rows=inside.rows + at)] if inside.rows.size else []
        at += last - first
    channels = {channel: np.concatenate(parts[channel]) for channel in recording.channels}
    if bridged:
        flaws.append(flaw("motor_angle", JOINED, np.concatenate(bridged), channels[name]))
    remarks = _remarks(recording, name, stretches, radius, fastest)
    return replace(
        recording,
        time=np.concatenate(parts["time"]),
        channels=channels,
        flaws=tuple(flaws),
        kept_apart=np.concatenate(apart) if judged else None,
        notes=(*recording.notes, *remarks),
    )


def _usual(position: FloatArray, step: float) -> tuple[float, float, float, float]:
    """Least and largest position, and speed and acceleration that are not exceeded for long."""
    some = slice(None, None, max(1, len(position) // 1_000_000))
    speed = np.abs(position[FITTED:] - position[:-FITTED])[some] / (FITTED * step)
    bend = np.abs(position[2 * FITTED :] - 2 * position[FITTED:-FITTED] + position[: -2 * FITTED])[some]
    bend /= (FITTED * step) ** 2
    fastest, hardest = (float(np.quantile(one[one > 0], REACHED)) if np.any(one > 0) else 1.0 for one in (speed, bend))
    return float(position.min()), float(position.max()), fastest, hardest


def _bridge(before: FloatArray, after: FloatArray, step: float, fastest: float, hardest: float) -> FloatArray:
    """Positions from the last row before to the first after, both left out."""
    ends = []
    for part, here in ((before, len(before) - 1), (after, 0)):
        curve = np.polynomial.Polynomial.fit((np.arange(len(part)) - here) * step, part, 2)
        ends.append((float(part[here]), float(curve.deriv(1)(0.0)), float(curve.deriv(2)(0.0))))
    way = abs(ends[1][0] - ends[0][0])
    # of a polynomial of fifth degree from rest to rest: 15/8 of the mean speed, 10/sqrt(3) of way / time^2
    time = max(LEAST_BRIDGE, 1.875 * way / fastest, np.sqrt(5.774 * way / hardest))
    rows = [[1, 0, 0, 0, 0, 0], [0, 1, 0, 0, 0, 0], [0, 0, 2, 0, 0, 0],
            [1, 1, 1, 1, 1, 1], [0, 1, 2, 3, 4, 5], [0, 0, 2, 6, 12, 20]]  # fmt: skip
    found: FloatArray
    for slower in 1.15 ** np.arange(6):  # ends that move ask for more than rest
        count = int(np.ceil(slower * time / step))
        scales = np.array([1.0, count * step, (count * step) ** 2])
        terms = np.linalg.solve(np.array(rows, float), np.concatenate([np.array(end) * scales for end in ends]))
        way_on = np.polynomial.polynomial.polyval(np.arange(1, count) / count, terms)
        found = np.asarray(way_on, dtype=np.float64)
        if np.abs(np.diff(found)).max() <= fastest * step:
            break
    return found


def _between(
    channel: str, last: float, first: float, share: FloatArray, bridge: FloatArray, name: str, radius: float,
    step: float, ends: tuple[float, float],
) -> FloatArray:  # fmt: skip
    """A channel between two stretches, (k,), from its last sample to its first."""
    if channel == name:
        return bridge
    if channel in ("table_position", "setpoint"):  # goes with the motor; what it is beside it goes over
        return radius * bridge + last - radius * ends[0] + share * (first - radius * ends[1] - last + radius * ends[0])
    if channel in ("motor_speed", "screw_speed", "table_velocity"):
        turned = np.gradient(bridge, step) * (radius if channel == "table_velocity" else 1.0)
        fade = 4 * share * (1 - share)
        return fade * turned + (1 - fade) * (last + share * (first - last))
    smooth: FloatArray = last + (first - last) * share**2 * (3 - 2 * share)
    return smooth


def _remarks(recording: Recording, name: str, stretches: list[Rows], radius: float, fastest: float) -> tuple[str, ...]:
    """What was taken, and statistics of all of it."""
    step, position = recording.sample_time, recording[name]
    kept = sum(last - first for first, last in stretches) * step
    every = max(1, round(0.01 / step))  # a row in 10 ms: no reversal of a table is shorter
    speed = np.diff(position[::every]) / (every * step)
    moving = np.abs(speed) > 1e-3 * fastest
    turns = int(np.sum(np.diff(np.sign(speed[moving])) != 0))
    way = float(np.sum(np.abs(speed[moving]))) * every * step * radius
    notes = [
        f"{recording.duration / 3600:.2g} h in {len(recording)} rows: compared are {kept:.0f} s in {len(stretches)} "
        "stretches, those that tell most of speeds, accelerations, places and hours; the rest counts as statistics",
        f"in all of it the table moves for {100 * float(np.mean(moving)):.0f} % of the time, {way:.3g} m with "
        f"{turns} reversals, up to {60 * radius * float(np.abs(speed).max()):.3g} m/min",
    ]
    if "motor_torque" in recording:
        torque = recording["motor_torque"]
        whole, part = (
            float(np.sqrt(np.mean(np.square(one))))
            for one in (torque[::every], np.concatenate([torque[first:last] for first, last in stretches]))
        )
        notes.append(f"rms of motor_torque: {whole:.3g} N m in all of it, {part:.3g} N m in what is compared")
        even = moving[1:] & (np.abs(np.diff(speed)) < 0.02 * np.abs(speed[1:]))
        drag = (torque[: every * len(speed) : every] * np.sign(speed))[1:]
        hour = np.arange(len(drag)) * 4 // len(drag)
        levels = [
            float(np.median(drag[even & (hour == quarter)]))
            for quarter in range(4)
            if np.sum(even & (hour == quarter)) > 100
        ]
        if len(levels) == 4:
            written = ", ".join(f"{level:.3g}" for level in levels)
            notes.append(f"drag at even speed, median of each quarter of the time: {written} N m")
    return tuple(notes)
