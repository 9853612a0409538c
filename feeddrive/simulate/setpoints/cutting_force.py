"""Forces on the table over time: steps, triangles, sines, a recorded one, milling by the passing of teeth.

Positive along + motion of the table; a cut resists, so its force is negative while the table feeds forward.

Milling, in the direction in which the table feeds:

    F = sum over teeth of  b h (-K_t cos p - K_r sin p),   h = f_t sin p,   p = W t + 2 pi i / N,   p_in <= p <= p_out

| symbol | meaning | unit |
|---|---|---|
| b, f_t | axial depth of cut, feed per tooth | m |
| K_t, K_r | tangential and radial cutting coefficient | N/m^2 |
| W, N | speed of the spindle, number of teeth | rad/s, 1 |
| p_in, p_out | angles at which a tooth enters and leaves, from the normal to the feed | rad |

Source: Altintas, Manufacturing Automation, 2nd ed., section 2.8, eqs. for F_x with edge forces left out.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from feeddrive.errors import InputError
from feeddrive.typing import FloatArray


class Force(Protocol):
    """A force on the table over time."""

    def at(self, time: FloatArray) -> FloatArray:
        """The force [N] at times [s], shape (n,)."""
        ...


@dataclass(frozen=True)
class NoForce:
    """Nothing pushes the table."""

    def at(self, time: FloatArray) -> FloatArray:
        return np.zeros_like(time)


@dataclass(frozen=True)
class StepForce:
    """A constant force [N] from a time on, until another [s]."""

    force: float
    start: float
    end: float = math.inf

    def at(self, time: FloatArray) -> FloatArray:
        return np.where((time >= self.start) & (time < self.end), self.force, 0.0)


@dataclass(frozen=True)
class TriangleForce:
    """Slow loading cycles 0, +F, 0, -F, 0 [N], `cycles` of `period` [s] from `start` [s] on."""

    amplitude: float
    period: float
    cycles: int
    start: float

    def __post_init__(self) -> None:
        if not (self.period > 0 and self.cycles >= 1):
            raise InputError("a triangle without period or cycles", "force", "write both above zero")

    def at(self, time: FloatArray) -> FloatArray:
        place = (time - self.start) / self.period
        within = np.where((place >= 0) & (place < self.cycles), place, 0.0)
        triangle: FloatArray = self.amplitude * (1 - np.abs((4 * within + 1) % 4 - 2))
        return triangle


@dataclass(frozen=True)
class SineForce:
    """A mean and a sine from a time on, `mean + amplitude sin(2 pi f (t - start))` [N, N, Hz, s]."""

    amplitude: float
    frequency: float
    mean: float
    start: float

    def at(self, time: FloatArray) -> FloatArray:
        since = time - self.start
        return np.where(since >= 0, self.mean + self.amplitude * np.sin(2 * math.pi * self.frequency * since), 0.0)


@dataclass(frozen=True)
class RecordedForce:
    """Samples of a force, each held until the next; zero before the first and after the last.

    Attributes:
        time: ascending [s], shape (n,).
        force: [N], shape (n,).
    """

    time: FloatArray
    force: FloatArray

    def at(self, time: FloatArray) -> FloatArray:
        index = np.searchsorted(self.time, time, side="right") - 1
        inside = (index >= 0) & (time <= self.time[-1])
        return np.where(inside, self.force[np.maximum(index, 0)], 0.0)


@dataclass(frozen=True)
class Milling:
    """Force of a straight-toothed cutter in the feed direction, from `start` to `end` [s]; symbols in the module.

    Raises:
        InputError: a value that is not above zero, or angles of entry and exit that are not in order.
    """

    teeth: int
    spindle_speed: float
    depth: float
    feed_per_tooth: float
    tangential: float
    radial: float
    entry: float
    exit: float
    start: float
    end: float = math.inf

    def __post_init__(self) -> None:
        for key in ("teeth", "spindle_speed", "depth", "feed_per_tooth", "tangential"):
            if not getattr(self, key) > 0:
                raise InputError("is not above zero", f"force.{key}", "write a positive value")
        if not 0 <= self.entry < self.exit <= math.pi:
            raise InputError("entry and exit are not in order", "force.entry", "write 0° <= entry < exit <= 180°")

    def at(self, time: FloatArray) -> FloatArray:
        total = np.zeros_like(time)
        for i in range(self.teeth):
            p = np.mod(self.spindle_speed * (time - self.start) + 2 * math.pi * i / self.teeth, 2 * math.pi)
            width = self.depth * self.feed_per_tooth * np.sin(p)
            force = width * (-self.tangential * np.cos(p) - self.radial * np.sin(p))
            total += np.where((p >= self.entry) & (p <= self.exit), force, 0.0)
        return np.where((time >= self.start) & (time < self.end), total, 0.0)


@dataclass(frozen=True)
class SumOfForces:
    """Several forces at once."""

    forces: tuple[Force, ...]

    def at(self, time: FloatArray) -> FloatArray:
        total = np.zeros_like(time)
        for force in self.forces:
            total = total + force.at(time)
        return total


def held(force: Force, first_tick: int, count: int, tick: float) -> FloatArray:
    """The force for ticks of `tick` [s], each the value in its middle, shape (count,) [N]."""
    middles = np.arange(first_tick, first_tick + count, dtype=np.float64) * tick + 0.5 * tick
    return force.at(middles)
