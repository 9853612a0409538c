"""Forty ways in which a recording is spoilt before it is diagnosed, in plain numpy.

Each takes the channels of a sound recording (SI, evenly sampled) and gives them as a wrong mapping, a bad cable, a slow
recorder or a careless export would. Nothing here is an effect of a machine: what is named from such a recording is
named wrongly, unless a law of the machine does to the recording just what the fault does (`LIKE_AN_EFFECT`).
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
Channels = dict[str, Array]

RATED_TORQUE = 30.0
"""What a share or a percentage of the torque refers to [N m]."""

LEAD = 0.02
"""Travel per motor revolution of the axis that is spoilt [m]."""


def scaled(name: str, factor: float) -> Callable[[Channels], Channels]:
    """One channel times a factor."""
    return lambda given: {**given, name: factor * given[name]}


def clock(factor: float) -> Callable[[Channels], Channels]:
    """Time stamps times a factor."""
    return scaled("time", factor)


def clipped(name: str, share: float) -> Callable[[Channels], Channels]:
    """One channel cut off at a share of its largest size, as by a range of the recorder."""

    def change(given: Channels) -> Channels:
        top = share * float(np.max(np.abs(given[name])))
        return {**given, name: np.clip(given[name], -top, top)}

    return change


def in_place_of(name: str, other: Callable[[Channels], Array]) -> Callable[[Channels], Channels]:
    """One channel filled from others."""
    return lambda given: {**given, name: other(given)}


def swapped(first: str, second: str) -> Callable[[Channels], Channels]:
    """Two columns under each other's names."""
    return lambda given: {**given, first: given[second], second: given[first]}


def cell(name: str, value: float) -> Callable[[Channels], Channels]:
    """One sample in the middle of the recording replaced."""

    def change(given: Channels) -> Channels:
        samples = given[name].copy()
        samples[int(0.41 * len(samples))] = value
        return {**given, name: samples}

    return change


def held_dropouts(names: tuple[str, ...], seconds: float = 0.015) -> Callable[[Channels], Channels]:
    """Three stretches in motion in which the last good sample is repeated."""

    def change(given: Channels) -> Channels:
        rows = round(seconds / step_of(given))
        result = dict(given)
        for name in names:
            samples = given[name].copy()
            for share in (0.06, 0.17, 0.33):
                start = int(share * len(samples))
                samples[start : start + rows] = samples[start]
            result[name] = samples
        return result

    return change


def late(name: str, seconds: float) -> Callable[[Channels], Channels]:
    """One channel recorded later than the others."""

    def change(given: Channels) -> Channels:
        rows = round(seconds / step_of(given))
        samples = np.concatenate([np.full(rows, given[name][0]), given[name][:-rows]])
        return {**given, name: samples}

    return change


def sampled_and_held(name: str, every: int) -> Callable[[Channels], Channels]:
    """One channel recorded more slowly, each value repeated until the next."""

    def change(given: Channels) -> Channels:
        rows = np.arange(len(given[name])) // every * every
        return {**given, name: given[name][rows]}

    return change


def quantised(name: str, step: float) -> Callable[[Channels], Channels]:
    """One channel in coarse steps."""
    return lambda given: {**given, name: step * np.round(given[name] / step)}


def repeated_rows(given: Channels) -> Channels:
    """Thirty rows of motion written twice, the time stamps going on."""
    start = int(0.17 * len(given["time"]))
    rows = np.concatenate([np.arange(start + 30), np.arange(start, len(given["time"]))])
    return {**{name: samples[rows] for name, samples in given.items()}, "time": even_time(given, len(rows))}


def lost_rows(given: Channels, seconds: float, mended: bool) -> Channels:
    """A stretch of motion that is not there; its gap hidden by new time stamps where `mended`."""
    start, count = int(0.17 * len(given["time"])), round(seconds / step_of(given))
    rows = np.concatenate([np.arange(start), np.arange(start + count, len(given["time"]))])
    result = {name: samples[rows] for name, samples in given.items()}
    return {**result, "time": even_time(given, len(rows))} if mended else result


def drifting(name: str, by: float) -> Callable[[Channels], Channels]:
    """One channel with a zero that moves by this much over the recording."""
    return lambda given: {**given, name: given[name] + by * np.linspace(0.0, 1.0, len(given[name]))}


def moved_zero(name: str, by: float) -> Callable[[Channels], Channels]:
    """One channel with another zero."""
    return lambda given: {**given, name: given[name] + by}


def wrapped(given: Channels) -> Channels:
    """The motor angle within one revolution, as a single-turn encoder shows it."""
    return {**given, "motor_angle": np.mod(given["motor_angle"], 2 * math.pi)}


def step_of(given: Channels) -> float:
    """Time between two rows [s]."""
    return float(np.median(np.diff(given["time"])))


def even_time(given: Channels, count: int) -> Array:
    """Time stamps of so many rows without a gap [s]."""
    return np.asarray(given["time"][0] + step_of(given) * np.arange(count), dtype=np.float64)


MOTION = ("motor_angle", "table_position")
EVERYTHING = ("motor_torque", *MOTION)

CORRUPTIONS: dict[str, Callable[[Channels], Channels]] = {
    "torque with the other sign": scaled("motor_torque", -1.0),
    "angle with the other sign": scaled("motor_angle", -1.0),
    "position with the other sign": scaled("table_position", -1.0),
    "torque in percent of the rated torque": scaled("motor_torque", 100.0 / RATED_TORQUE),
    "torque as a share of the rated torque": scaled("motor_torque", 1.0 / RATED_TORQUE),
    "torque from an rms current": scaled("motor_torque", math.sqrt(0.5)),
    "torque from a peak current": scaled("motor_torque", math.sqrt(2.0)),
    "clock at half speed": clock(2.0),
    "clock at double speed": clock(0.5),
    "clock 1 % slow": clock(1.01),
    "dropouts held in all channels": held_dropouts(EVERYTHING),
    "dropouts held in the torque": held_dropouts(("motor_torque",)),
    "dropouts held in the position": held_dropouts(("table_position",)),
    "dropouts held in the angle": held_dropouts(("motor_angle",)),
    "torque clipped at 90 %": clipped("motor_torque", 0.9),
    "torque clipped at 60 %": clipped("motor_torque", 0.6),
    "torque clipped at 30 %": clipped("motor_torque", 0.3),
    "position clipped at 80 %": clipped("table_position", 0.8),
    "set-point logged as the actual angle": in_place_of(
        "motor_angle", lambda given: given["setpoint"] * 2 * math.pi / LEAD
    ),
    "set-point logged as the actual position": in_place_of("table_position", lambda given: given["setpoint"]),
    "position from the angle": in_place_of("table_position", lambda given: given["motor_angle"] * LEAD / (2 * math.pi)),
    "position at twice the lead": scaled("table_position", 2.0),
    "position at half the lead": scaled("table_position", 0.5),
    "angle in degrees": scaled("motor_angle", 180.0 / math.pi),
    "one angle of 0": cell("motor_angle", 0.0),
    "one torque of 999": cell("motor_torque", 999.0),
    "one position of 0": cell("table_position", 0.0),
    "one angle of a million": cell("motor_angle", 1e6),
    "angle and position swapped": swapped("motor_angle", "table_position"),
    "torque and set-point swapped": swapped("motor_torque", "setpoint"),
    "torque without its sign": in_place_of("motor_torque", lambda given: np.abs(given["motor_torque"])),
    "rows written twice": repeated_rows,
    "a stretch of 0.2 s lost": lambda given: lost_rows(given, 0.2, mended=False),
    "a stretch of 0.1 s lost, time stamps mended": lambda given: lost_rows(given, 0.1, mended=True),
    "angle within one revolution": wrapped,
    "position recorded 3 ms late": late("table_position", 3e-3),
    "torque in steps of 0.5 N m": quantised("motor_torque", 0.5),
    "torque held for 5 ms": sampled_and_held("motor_torque", 10),
    "torque with an offset of 1 N m": moved_zero("motor_torque", 1.0),
    "torque drifting by 1 N m": drifting("motor_torque", 1.0),
}
"""What went wrong -> the channels as they are then recorded."""

LIKE_AN_EFFECT = {
    "position recorded 3 ms late": ("channel_delay",),
    "torque with an offset of 1 N m": ("constant_force",),
}
"""What a law of the catalogue does to a recording too: the name is right, the fault lies in the recorder."""
