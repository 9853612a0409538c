"""Set-points of the usual tests: moves with dwells, staircases, steps, circles, sines, excited bands.

| symbol | meaning | unit |
|---|---|---|
| x, t | position, time | m, s |
| s, R | path along a circle, its radius | m, m |
| W, w | integral and value of a waveform | s, 1 |
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from feeddrive.errors import InputError
from feeddrive.simulate.setpoints.setpoint_motion import Limits, Motion, Piece, Pieces, Stop, Trajectory, move, rest
from feeddrive.simulate.setpoints.waveforms import Waveform
from feeddrive.typing import FloatArray

_MOST_LOOKED_AT = 1_000_000


def moves(start: float, targets: Sequence[tuple[float, Limits]], dwell: float) -> Pieces:
    """Fastest moves from `start` to targets [m], each under its limits, standing for `dwell` [s] before and after.

    Raises InputError: no target, or a negative dwell.
    """
    if not targets:
        raise InputError("no target", "trajectory", "write at least one")
    if dwell < 0:
        raise InputError(f"a dwell of {dwell:g} s", "trajectory.dwell", "write zero or more")
    pieces: list[Piece] = [rest(start, dwell)]
    stops = [Stop(start, 0.0, dwell, 0)]
    at, now = start, dwell
    for target, limits in targets:
        way = move(at, target, limits)
        now += sum(piece.duration for piece in way)
        pieces += [*way, rest(target, dwell)]
        stops.append(Stop(target, now, now + dwell, int(np.sign(target - at))))
        at, now = target, now + dwell
    return Pieces(tuple(pieces), tuple(stops))


def staircase(targets: Sequence[float], runs: int, overrun: float, limits: Limits, dwell: float) -> Pieces:
    """The cycle of a positioning test after ISO 230-2: ascending targets [m] from below and from above, `runs` times.

    Beyond first and last target the direction turns after `overrun` [m]; it stands at each for `dwell` [s]. Raises
    InputError: targets that do not ascend, no run, no overrun.
    """
    if len(targets) < 2 or any(b <= a for a, b in pairwise(targets)):
        raise InputError("the targets do not ascend", "trajectory.targets", "write two or more, in ascending order")
    if runs < 1 or not overrun > 0:
        raise InputError(f"{runs} runs, overrun {overrun:g} m", "trajectory", "write one run or more, overrun above 0")
    below, above = targets[0] - overrun, targets[-1] + overrun
    cycle = [*targets, above, *reversed(targets), below]
    return moves(below, [(target, limits) for target in cycle * runs], dwell)


def position_step(start: float, height: float, at: float, duration: float) -> Pieces:
    """A jump of the position by `height` [m] at a time [s]; its velocity is not in the set-point's derivatives."""
    pieces = (rest(start, at), rest(start + height, duration - at))
    return Pieces(pieces, (Stop(start, 0.0, at, 0), Stop(start + height, at, duration, int(np.sign(height)))))


def velocity_steps(start: float, steps: Sequence[tuple[float, float]]) -> Pieces:
    """Constant velocities, each (duration [s], velocity [m/s]), with jumps between."""
    pieces: list[Piece] = []
    at = start
    for duration, velocity in steps:
        pieces.append(Piece(duration, at, velocity, 0.0, 0.0))
        at = pieces[-1].end[0]
    return Pieces(tuple(pieces))


@dataclass(frozen=True)
class Circle:
    """One axis of a circular path: x = centre + R sin(s / R), the path s from rest to rest under limits.

    Attributes:
        centre, radius: [m].
        turns: around the circle.
        limits: of the path; its velocity is the feed.
        dwell: at rest before and after [s].
    """

    centre: float
    radius: float
    turns: float
    limits: Limits
    dwell: float

    def __post_init__(self) -> None:
        if not (self.radius > 0 and self.turns > 0):
            raise InputError("a circle without radius or turns", "trajectory", "write both above zero")

    @property
    def _path(self) -> Pieces:
        return moves(0.0, [(2 * math.pi * self.radius * self.turns, self.limits)], self.dwell)

    @property
    def duration(self) -> float:
        return self._path.duration

    @property
    def stops(self) -> tuple[Stop, ...]:
        return ()

    def angle(self, time: FloatArray) -> FloatArray:
        """Angle along the circle [rad], 0 at the start."""
        return self._path.at(time).position / self.radius

    def at(self, time: FloatArray) -> Motion:
        path, r = self._path.at(time), self.radius
        sine, cosine = np.sin(path.position / r), np.cos(path.position / r)
        v, a, j = path.velocity, path.acceleration, path.jerk
        velocity, acceleration = cosine * v, cosine * a - sine * v**2 / r
        jerk = cosine * (j - v**3 / r**2) - sine * 3 * v * a / r
        return Motion(self.centre + r * sine, velocity, acceleration, jerk)


@dataclass(frozen=True)
class Sine:
    """x = centre + A g(t) sin(2 pi f t), faded in and out by g over `fade` [s], g = 10 z^3 - 15 z^4 + 6 z^5.

    Attributes:
        centre, amplitude: [m].
        frequency: [Hz].
        duration: [s].
        fade: [s].
    """

    centre: float
    amplitude: float
    frequency: float
    duration: float
    fade: float

    def __post_init__(self) -> None:
        if not (self.frequency > 0 and 0 < 2 * self.fade <= self.duration):
            what = f"a sine of {self.frequency:g} Hz over {self.duration:g} s, faded over {self.fade:g} s"
            raise InputError(what, "trajectory", "write a frequency above zero and a fade of at most half the duration")

    @property
    def stops(self) -> tuple[Stop, ...]:
        return ()

    def at(self, time: FloatArray) -> Motion:
        time = np.clip(np.asarray(time, dtype=float), 0.0, self.duration)
        g = self._fading(time)
        w = 2 * math.pi * self.frequency
        sine, cosine = np.sin(w * time), w * np.cos(w * time)
        s = (sine, cosine, -(w**2) * sine, -(w**2) * cosine)
        scaled = self.amplitude
        return Motion(
            self.centre + scaled * g[0] * s[0],
            scaled * (g[1] * s[0] + g[0] * s[1]),
            scaled * (g[2] * s[0] + 2 * g[1] * s[1] + g[0] * s[2]),
            scaled * (g[3] * s[0] + 3 * g[2] * s[1] + 3 * g[1] * s[2] + g[0] * s[3]),
        )

    def _fading(self, time: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
        """g and its three derivatives."""
        rising = np.minimum(time, self.duration - time)
        side = np.where(time <= 0.5 * self.duration, 1.0, -1.0)
        z = np.clip(rising / self.fade, 0.0, 1.0)
        inside, h = (rising < self.fade).astype(float), self.fade
        g = z**3 * (10 - 15 * z + 6 * z**2)
        slope = side * 30 * z**2 * (1 - z) ** 2 / h
        curve = 60 * z * (1 - 3 * z + 2 * z**2) / h**2
        third = side * 60 * (1 - 6 * z + 6 * z**2) / h**3
        return g, inside * slope, inside * curve, inside * third


@dataclass(frozen=True)
class Wave:
    """Velocity v = v_0 + A w(t): an offset that keeps the axis from reversing, and a waveform.

    Attributes:
        start: position [m].
        offset, amplitude: velocities [m/s].
        waveform: w.
    """

    start: float
    offset: float
    amplitude: float
    waveform: Waveform

    @property
    def duration(self) -> float:
        return self.waveform.duration

    @property
    def stops(self) -> tuple[Stop, ...]:
        return ()

    def at(self, time: FloatArray) -> Motion:
        time = np.clip(np.asarray(time, dtype=float), 0.0, self.duration)
        integral, value, slope, curve = self.waveform.values(time)
        position = self.start + self.offset * time + self.amplitude * integral
        return Motion(position, self.offset + self.amplitude * value, self.amplitude * slope, self.amplitude * curve)


def refuse_beyond_travel(trajectory: Trajectory, travel: tuple[float, float], tick: float, where: str) -> None:
    """Refuse a trajectory that leaves the travel [m], seen at ticks [s], at most a million, and at every stop.

    Raises:
        InputError: it does; says by how much and when.
    """
    count = min(math.ceil(trajectory.duration / tick) + 1, _MOST_LOOKED_AT)
    arrivals = [stop.arrival for stop in trajectory.stops]
    time = np.concatenate([np.linspace(0.0, trajectory.duration, max(count, 2)), arrivals])
    position = trajectory.at(time).position
    beyond = np.maximum(travel[0] - position, position - travel[1])
    worst = int(np.argmax(beyond))
    if beyond[worst] > 1e-12:
        what = f"the set-point is {1e3 * beyond[worst]:.4g} mm beyond the travel at {time[worst]:.4g} s"
        shown = f"the travel is {1e3 * travel[0]:g} mm to {1e3 * travel[1]:g} mm"
        raise InputError(what, where, f"{shown}; shorten the motion or widen the travel")
