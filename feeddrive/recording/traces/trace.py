"""What every reader of a trace file returns: signals with their own times, before anything is taken for a channel."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from feeddrive.typing import FloatArray

_LONGEST_NAME = 120  # of a name that is shown; a damaged file can hold a megabyte of it


@dataclass(frozen=True, eq=False)
class Signal:
    """One signal of a trace file.

    Attributes:
        name: as the file writes it, without control characters; unique in its trace.
        time: time stamps of its own, (n,) [s], increasing; the same array object for signals sampled together.
        values: (n,), in `unit`.
        unit: as the file says it; empty where it does not.
        axis: machine axis that it belongs to, as the file names it; empty if the file names none.
        about: description in the file; empty if there is none.
        kind: class of the unit where the file gives no more than that (`position`, `velocity`, `current`, ...).
        timed: whether the file tells its times; if not, `time` counts samples, or sample times once one is given.
    """

    name: str
    time: FloatArray
    values: FloatArray
    unit: str = ""
    axis: str = ""
    about: str = ""
    kind: str = ""
    timed: bool = True

    @property
    def step(self) -> float:
        """Usual distance of its samples [s]; 0 for fewer than two."""
        return float(np.median(np.diff(self.time))) if self.time.size > 1 else 0.0


@dataclass(frozen=True, eq=False)
class Trace:
    """Signals of one file.

    Attributes:
        format: what the file is, for people.
        signals: in the order of the file.
        notes: what was found and assumed on reading.
    """

    format: str
    signals: tuple[Signal, ...]
    notes: tuple[str, ...] = field(default=())

    @property
    def axes(self) -> tuple[str, ...]:
        """Axes in the order in which they come, each once; without the empty one."""
        return tuple(dict.fromkeys(signal.axis for signal in self.signals if signal.axis))


def clean(text: str) -> str:
    """Return a name of a file fit for a terminal: no control characters, no line ends, no more than 120 letters."""
    kept = "".join(letter if letter.isprintable() else "?" for letter in text.strip())
    return kept if len(kept) <= _LONGEST_NAME else kept[: _LONGEST_NAME - 1] + "…"


def unique_names(names: Sequence[str]) -> list[str]:
    """Return cleaned names, each once: a name that comes again is numbered as in `speed (2)`."""
    taken: set[str] = set()
    found = []
    for number, given in enumerate(names, start=1):
        plain = clean(given) or f"signal {number}"
        name, count = plain, 2
        while name in taken:
            name, count = f"{plain} ({count})", count + 1
        taken.add(name)
        found.append(name)
    return found
