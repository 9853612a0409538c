"""Set-point motions: position with its exact derivatives at any time, and the pieces they are made of.

The fastest motion from rest to rest under limits of velocity, acceleration and jerk, in closed form.

Seven phases: jerk +J, 0, -J, constant velocity, -J, 0, +J, of durations T_j, T_a, T_j, T_v, T_j, T_a, T_j:

    T_j = min(A / J, sqrt(V / J), (D / 2J)^(1/3))
    T_a = min(V / A - T_j, -3/2 T_j + sqrt(T_j^2 / 4 + D / A))  where T_j = A / J, else 0
    T_v = D / v - (T_a + 2 T_j),   v = J T_j (T_a + T_j)

| symbol | meaning | unit |
|---|---|---|
| D | distance | m |
| V, A, J | limits of velocity, acceleration, jerk | m/s, m/s^2, m/s^3 |
| v | velocity reached | m/s |

Source: Lambrechts, Boerlage, Steinbuch, Trajectory planning and feedforward design for electromechanical motion
systems, Control Engineering Practice 13 (2005), section 3, for the third order.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from feeddrive.errors import InputError
from feeddrive.typing import FloatArray


@dataclass(frozen=True)
class Motion:
    """Position and its derivatives at some times, each of shape (n,) [m, m/s, m/s^2, m/s^3]."""

    position: FloatArray
    velocity: FloatArray
    acceleration: FloatArray
    jerk: FloatArray


@dataclass(frozen=True)
class Stop:
    """A stand-still of a trajectory.

    Attributes:
        target: position [m].
        arrival, leave: when the set-point comes to rest and leaves again [s].
        direction: in which it was approached, +1 or -1; 0 at the start.
    """

    target: float
    arrival: float
    leave: float
    direction: int


class Trajectory(Protocol):
    """A set-point over time.

    Attributes:
        duration: after which it stands, or ends [s].
        stops: stand-stills, in order; empty for motions that have none.
    """

    @property
    def duration(self) -> float: ...

    @property
    def stops(self) -> tuple[Stop, ...]: ...

    def at(self, time: FloatArray) -> Motion:
        """The motion at times [s], shape (n,); before the start and after the end it holds its last value."""
        ...


@dataclass(frozen=True)
class Piece:
    """Constant jerk over a while: the state at its begin and the jerk; duration [s], SI."""

    duration: float
    position: float
    velocity: float
    acceleration: float
    jerk: float

    @property
    def end(self) -> tuple[float, float, float]:
        """Position, velocity and acceleration at its end."""
        t, v, a, j = self.duration, self.velocity, self.acceleration, self.jerk
        return self.position + t * (v + t * (a / 2 + t * j / 6)), v + t * (a + t * j / 2), a + t * j


@dataclass(frozen=True)
class Pieces:
    """A trajectory of pieces of constant jerk, after which the last position is held."""

    pieces: tuple[Piece, ...]
    stops: tuple[Stop, ...] = ()

    @property
    def duration(self) -> float:
        return float(sum(piece.duration for piece in self.pieces))

    def at(self, time: FloatArray) -> Motion:
        time = np.asarray(time, dtype=float)
        begins = np.concatenate([[0.0], np.cumsum([piece.duration for piece in self.pieces])])
        held = Piece(np.inf, self.pieces[-1].end[0], 0.0, 0.0, 0.0)
        table = np.array([[p.position, p.velocity, p.acceleration, p.jerk] for p in (*self.pieces, held)])
        index = np.clip(np.searchsorted(begins, time, side="right") - 1, 0, len(self.pieces))
        x, v, a, j = table[index].T
        t = np.maximum(time - begins[index], 0.0)
        return Motion(x + t * (v + t * (a / 2 + t * j / 6)), v + t * (a + t * j / 2), a + t * j, j)


def rest(position: float, duration: float) -> Piece:
    """Standing at a position [m] for a while [s]."""
    return Piece(duration, position, 0.0, 0.0, 0.0)


def chained(start: float, jerks: Sequence[tuple[float, float]]) -> list[Piece]:
    """Pieces from rest at `start` [m], each (duration [s], jerk [m/s^3]); pieces without duration are left out."""
    pieces: list[Piece] = []
    state = (start, 0.0, 0.0)
    for duration, jerk in jerks:
        if duration > 0:
            pieces.append(Piece(duration, *state, jerk))
            state = pieces[-1].end
    return pieces


_ROUNDING = 1e-12
"""A share of the ramps that only rounding makes of constant velocity."""


@dataclass(frozen=True)
class Limits:
    """Limits of a motion, SI.

    Attributes:
        velocity, acceleration, jerk: [m/s, m/s^2, m/s^3].
        where: for messages.

    Raises:
        InputError: a limit that is not above zero.
    """

    velocity: float
    acceleration: float
    jerk: float
    where: str = "trajectory"

    def __post_init__(self) -> None:
        for key in ("velocity", "acceleration", "jerk"):
            if not (getattr(self, key) > 0 and math.isfinite(getattr(self, key))):
                raise InputError(
                    f"the limit {getattr(self, key):g} is not above zero",
                    f"{self.where}.{key}",
                    "no move is possible; write a positive limit",
                )


def phases(distance: float, limits: Limits) -> tuple[float, float, float]:
    """T_j, T_a and T_v of the fastest move over a distance >= 0 [m]; all are 0 where there is none [s]."""
    big_v, big_a, big_j = limits.velocity, limits.acceleration, limits.jerk
    if distance == 0:
        return 0.0, 0.0, 0.0
    jerking = min(big_a / big_j, math.sqrt(big_v / big_j), math.cbrt(distance / (2 * big_j)))
    accelerating = 0.0
    if jerking == big_a / big_j:
        by_distance = -1.5 * jerking + math.sqrt(0.25 * jerking**2 + distance / big_a)
        accelerating = max(0.0, min(big_v / big_a - jerking, by_distance))
    reached = big_j * jerking * (accelerating + jerking)
    ramp = accelerating + 2 * jerking
    cruising = distance / reached - ramp
    return jerking, accelerating, cruising if cruising > _ROUNDING * ramp else 0.0


def move(start: float, target: float, limits: Limits) -> list[Piece]:
    """Pieces of the fastest move between two positions [m], from rest to rest; none where they are the same."""
    tj, ta, tv = phases(abs(target - start), limits)
    j = math.copysign(limits.jerk, target - start)
    return chained(start, [(tj, j), (ta, 0.0), (tj, -j), (tv, 0.0), (tj, -j), (ta, 0.0), (tj, j)])
