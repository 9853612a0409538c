"""Tests of ISO 230 from recordings with a scale: where the axis stood, which way it came, how far it was off.

The target is the set-point; without one it is what the motor's encoder says, lead / 2 pi times its angle, which is
where a control without a scale believes the table to be. The deviation is that of the scale, averaged over the second
half of a stop.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from feeddrive.errors import InputError
from feeddrive.metrology.measured.forms import drift_test_of, linear_test_of
from feeddrive.metrology.measured.measurements import CircleTest, DriftTest, LinearTest
from feeddrive.recording import Recording
from feeddrive.typing import FloatArray

SHORTEST_STOP = 0.1
"""Shortest stop of the set-point [s]: half of it is averaged, a few periods of the slowest mode, 40 Hz and more."""

SLOWEST = 1e-3
"""Speed of the motor's position below which an axis without a set-point stands [m/s]."""

HOUR = 3600.0
SINE = 1e-3
"""Share of the radius that a sine may leave (rms) for the motion to be a circle: 5 µm of 5 mm are friction's."""


@dataclass(frozen=True)
class Stop:
    """A stop of the axis.

    Attributes:
        rows: samples that are averaged.
        time: in their middle [s].
        target: [m].
        direction: of the approach, +1 or -1; 0 where it has stood from the beginning.
        deviation: scale less target [m].
    """

    rows: slice
    time: float
    target: float
    direction: int
    deviation: float


def believed(recording: Recording, motor_radius: float | None) -> FloatArray:
    """Where the control believes the table to be, (n,) [m]: the set-point, or the motor's angle times lead / 2 pi.

    Raises:
        InputError: no scale, or neither a set-point nor a motor angle with a plant that knows the lead.
    """
    if "table_position" not in recording:
        raise InputError("there is no table_position", recording.name, "record the scale, or give a table of readings")
    if "setpoint" in recording and np.ptp(recording["setpoint"]) > 0:
        return recording["setpoint"]
    if "motor_angle" not in recording or motor_radius is None:
        mend = "record the set-point, or the motor angle and name the machine by --plant"
        raise InputError("there is no set-point", recording.name, mend)
    return motor_radius * recording["motor_angle"]


def stops_of(recording: Recording, target: FloatArray) -> tuple[Stop, ...]:
    """The stops of a recording.

    Args:
        recording: whose scale is read.
        target: as `believed` gives it.
    """
    scale = recording["table_position"]
    exact = "setpoint" in recording and target is recording["setpoint"]
    rate = np.abs(np.diff(target)) / recording.sample_time
    still = np.concatenate([[False], rate <= (0.0 if exact else SLOWEST), [False]])
    edges = np.flatnonzero(np.diff(still.astype(int)))
    least = max(4, math.ceil(SHORTEST_STOP / recording.sample_time))
    found: list[Stop] = []
    for begin, end in zip(edges[::2], edges[1::2], strict=True):  # samples begin .. end stand
        if end - begin < least:
            continue
        rows = slice(int((begin + end) // 2), int(end) + 1)
        place = float(np.mean(target[rows]))
        came = place - found[-1].target if found else place - float(target[0])
        direction = 0 if abs(came) < 1e-6 else int(math.copysign(1, came))
        middle = float(np.mean(recording.time[rows]))
        found.append(Stop(rows, middle, place, direction, float(np.mean(scale[rows] - target[rows]))))
    return tuple(found)


def part_of_recording(recording: Recording, target: FloatArray) -> int:
    """Which part of ISO 230 a recording is for: a sine is 4, stops over more than an hour are 3, else 2."""
    if circle_angle(recording, target) is not None:
        return 4
    return 3 if recording.duration > HOUR else 2


def linear_test_from(recording: Recording, target: FloatArray) -> LinearTest:
    """A positioning test of the stops that were approached alike; ends from which the axis only turns are left out.

    Raises:
        InputError: no target was approached twice from a side.
    """
    found: dict[tuple[float, int], list[float]] = {}
    places: list[float] = []
    for stop in stops_of(recording, target):
        place = next((one for one in places if abs(one - stop.target) < same_place(recording, target)), stop.target)
        places += [] if place in places else [place]
        if stop.direction:
            found.setdefault((place, stop.direction), []).append(stop.deviation)
    sides = [side for side in (1, -1) if any(s == side and len(v) > 1 for (_, s), v in found.items())]
    whole = [place for place in places if all(len(found.get((place, side), [])) > 1 for side in sides)]
    if not whole or not sides:
        mend = "record a staircase of stops of 0.1 s and more, every target twice at least from the same side"
        raise InputError("no target is approached twice", recording.name, mend)
    fewest = min(len(found[place, side]) for place in whole for side in sides)
    kept = {(place, side): found[place, side][:fewest] for place in whole for side in sides}
    return linear_test_of(kept, recording.name)


def same_place(recording: Recording, target: FloatArray) -> float:
    """How near two stops are that were sent to one target [m]: set-points are exact, an encoder's stops are not."""
    return 1e-6 if "setpoint" in recording and target is recording["setpoint"] else 0.2e-3


def drift_test_from(recording: Recording, target: FloatArray, stop: float | None) -> DriftTest:
    """The drift at stops that come again and again, always from the same side.

    Raises:
        InputError: fewer than two targets that come twice.
    """
    visits: dict[tuple[float, int], list[Stop]] = {}
    for one in stops_of(recording, target):
        near = same_place(recording, target)
        key = next((k for k in visits if abs(k[0] - one.target) < near and k[1] == one.direction), None)
        visits.setdefault(key or (one.target, one.direction), []).append(one)
    best: dict[float, list[Stop]] = {}
    for (place, _), ones in sorted(visits.items(), key=lambda item: -len(item[1])):
        if not any(abs(place - other) < same_place(recording, target) for other in best) and len(ones) > 1:
            best[place] = ones  # the side from which it came most often
    series = [
        (place, np.array([one.time for one in ones]), np.array([one.deviation for one in ones]))
        for place, ones in best.items()
    ]
    if len(series) < 2:
        mend = "record stops of 0.1 s and more at two targets, again and again for an hour"
        raise InputError("fewer than two targets come again", recording.name, mend)
    return drift_test_of(series, stop, {}, recording.name)


@dataclass(frozen=True)
class Sine:
    """A stretch of a set-point that is a sine, centre + radius sin(angle).

    Attributes:
        rows: the stretch.
        angle: in it, rising, (k,) [rad].
        radius: [m].
    """

    rows: slice
    angle: FloatArray
    radius: float


def circle_angle(recording: Recording, target: FloatArray) -> Sine | None:
    """The longest stretch without run-up and run-out that is a sine of one turn at least; None where there is none."""
    count = len(target)
    shares = [(begin, end) for begin in (0.0, 0.05, 0.1, 0.2, 0.3, 0.4) for end in (1.0, 0.95, 0.9, 0.8, 0.7, 0.6)]
    for begin, end in sorted(shares, key=lambda one: one[0] - one[1]):
        rows = slice(round(begin * count), round(end * count))
        found = _sine_of(recording, target, rows)
        if found is not None:
            return found
    return None


def _sine_of(recording: Recording, target: FloatArray, rows: slice) -> Sine | None:
    time, about = recording.time[rows] - recording.time[rows.start], target[rows] - np.mean(target[rows])
    if len(time) < 64 or not np.ptp(about) > 0:
        return None
    # crossings of the middle tell the frequency nearly enough for Gauss and Newton
    crossings = int(np.count_nonzero(np.diff(np.signbit(about))))
    if crossings < 2:
        return None
    omega, (centre, sine, cosine) = _sine(time, about, math.pi * crossings / float(time[-1]))
    rest = about - centre - sine * np.sin(omega * time) - cosine * np.cos(omega * time)
    radius, turned = math.hypot(sine, cosine), omega * float(time[-1])
    if not radius > 0 or float(np.std(rest)) > SINE * radius or turned < 2 * math.pi:
        return None
    return Sine(rows, omega * time + math.atan2(cosine, sine), radius)


def _sine(time: FloatArray, values: FloatArray, omega: float) -> tuple[float, FloatArray]:
    """Frequency near `omega` [rad/s] and centre, sine and cosine parts of the best sine, by Gauss-Newton."""
    parts = np.zeros(3)
    for _ in range(12):
        sine, cosine = np.sin(omega * time), np.cos(omega * time)
        basis = np.column_stack([np.ones_like(time), sine, cosine])
        parts = np.linalg.lstsq(basis, values, rcond=None)[0]
        slope = time * (parts[1] * cosine - parts[2] * sine)
        step = np.linalg.lstsq(np.column_stack([basis, slope]), values - basis @ parts, rcond=None)[0][-1]
        omega += float(step)
    return omega, parts


def circle_test_from(first: Recording, second: Recording, radius: float | None) -> CircleTest:
    """A circle of two axes that were recorded together, both by their scales.

    Raises:
        InputError: recordings of other lengths.
    """
    x, y = first["table_position"], second["table_position"]
    if len(x) != len(y) or abs(first.sample_time - second.sample_time) > 1e-6 * first.sample_time:
        what = f"{len(x)} and {len(y)} samples"
        raise InputError(what, f"{first.name}, {second.name}", "give two recordings of the same samples")
    nominal = radius
    if nominal is None and "setpoint" in first:
        found = circle_angle(first, first["setpoint"])
        nominal = None if found is None else found.radius
    return CircleTest(((x, y),), nominal)
