"""What a series of values may do: jump, begin to change, settle, or be odd in one recording.

| kind | course, 0 before its date | |
|---|---|---|
| jump | 1 from its date on | a part gave way, was exchanged, was adjusted |
| slope | (t - date) ((t - date) / (end - date))^(power - 1): its size is the mean rate | wear, loss of preload |
| settling | 1 - exp(-(t - date) / time constant) | warming, running in |
| odd | 1 in one recording | it stands alone: another load, another programme |
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from feeddrive.typing import FloatArray

JUMP, SLOPE, SETTLING, ODD = "jump", "slope", "settling", "odd"

FEWEST_AFTER = 2
"""Recordings that a jump or a slope needs on either side: one alone cannot be distinguished from an odd recording."""

POWERS = (1.0, 1.5, 2.0)
"""How slopes rise: wear is even, but what it moves is seldom linear in it (compliance goes with 1 / stiffness), and a
line through a curve that steepens begins too late."""

SETTLING_DATES = 24
TIME_CONSTANTS = 10
"""Dates and time constants that are tried for a course that settles; it is refined from the best."""


@dataclass(frozen=True)
class Atom:
    """One course.

    Attributes:
        kind: see above.
        date: where it begins, in the time of the series.
        time_constant: of a course that settles; 0 else.
        power: of a slope: 1 for an even one, above for one that gets steeper.
    """

    kind: str
    date: float
    time_constant: float = 0.0
    power: float = 1.0

    def course(self, time: FloatArray) -> FloatArray:
        """Its values, (n,)."""
        since = time - self.date
        if self.kind == JUMP:
            return np.where(since >= 0, 1.0, 0.0)
        if self.kind == ODD:
            return np.where(since == 0, 1.0, 0.0)
        after = np.clip(since, 0.0, None)
        if self.kind == SETTLING:
            settled: FloatArray = -np.expm1(-after / self.time_constant)
            return settled
        steeper: FloatArray = after * (after / max(float(after[-1]), 1e-300)) ** (self.power - 1)
        return steeper


def candidates(time: FloatArray) -> tuple[Atom, ...]:
    """All that are tried for a series at times (n,), ascending."""
    count = len(time)
    inner = time[FEWEST_AFTER : count - FEWEST_AFTER + 1]
    found = [Atom(JUMP, float(date)) for date in inner]
    found += [Atom(SLOPE, float(date), 0.0, power) for date in time[: count - FEWEST_AFTER] for power in POWERS]
    found += [Atom(ODD, float(date)) for date in time]
    usual, span = float(np.median(np.diff(time))), float(time[-1] - time[0])
    dates = time[np.unique(np.linspace(0, count - 1 - FEWEST_AFTER, SETTLING_DATES).astype(int))]
    for date in dates:
        left = float(time[-1] - date)
        # one that settles within a file is a jump, one that takes longer than there are files is a slope
        constants = np.geomspace(1.5 * usual, 2 * span, TIME_CONSTANTS)
        found += [Atom(SETTLING, float(date), float(tau)) for tau in constants if tau <= 2 * left]
    return tuple(found)


def courses(atoms: tuple[Atom, ...] | list[Atom], time: FloatArray) -> FloatArray:
    """Their values side by side, (n, k)."""
    if not atoms:
        return np.zeros((len(time), 0))
    return np.column_stack([atom.course(time) for atom in atoms])
