"""Set-point motions: position with its exact derivatives at any time, and the pieces they are made of."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

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
