"""How well a declared value is known: by the tolerance that the file writes, else by its kind and its source.

A tolerance is two standard deviations of the logarithm of value over declared. Where a file writes none
(`tolerance = "5 %"`), it follows from the kind of value and from the words of its source:

| kind of value | from a catalogue or drawing | "assumed", "guess", "typical" | "measured" |
|---|---|---|---|
| stiffness of nut, bearing, coupling, shaft | 20 % | 50 % | 2 % |
| diameter that carries (no root diameter is declared) | 5 % | 5 % | 2 % |
| root diameter, lengths | 1 % | 20 % | 2 % |
| mass, inertia | 5 % | 30 % | 2 % |
| friction | 30 % | 50 % | 2 % |
| damping | 100 % | 100 % | 20 % |
| torque constant | 5 % | 10 % | 2 % |
| what no file declares: bracket and housing, as a share of the whole compliance | 5 % | | |

A source that says "simulated" declares the numbers that a simulation ran with: they are exact.

The shares are judgements of what a catalogue, a drawing or an assumption is worth, taken from no standard; they decide
from which difference on a value is called other than declared, so a tolerance that is written takes their place.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from feeddrive.errors import InputError
from feeddrive.units.quantity import parse

WIDEST = math.log(4.0)
"""Logarithm of the widest factor by which a value misses, either way; more is another machine or a slip of a unit."""

BEYOND = WIDEST / 1.96
"""Standard deviation of the logarithm of a value beyond its tolerance."""

SURE = 3.0
"""Deviations that are more than chance: one of 400 either way, one of 700 one way. So far beyond their tolerances
declared values are called other than declared, a measured number is contradicted and a recorder is suspected, and so
many of its own scatter a gain must reach where several were tried."""

ASSERTED = 20 / 21
"""Odds of 20 to 1 (Royall, Statistical Evidence (1997), section 1.6)."""

_UNSURE = ("assumed", "guess", "typical", "estimate")
_EXACT = "simulated"


@dataclass(frozen=True)
class Kind:
    """How well a kind of value is known: shares, from a catalogue, where its source is unsure, and measured."""

    catalogue: float
    unsure: float
    measured: float = 0.02

    def usual(self, source: str) -> float:
        """The tolerance of a value with this source, a share; 0 where it is exact."""
        words = source.lower()
        if _EXACT in words:
            return 0.0
        if any(word in words for word in _UNSURE):
            return self.unsure
        return self.measured if words.startswith("measured") else self.catalogue


STIFFNESS, CARRYING, LENGTH = Kind(0.20, 0.50), Kind(0.05, 0.05), Kind(0.01, 0.20)
MASS, FRICTION, MISSING = Kind(0.05, 0.30), Kind(0.30, 0.50), Kind(0.05, 0.05)
DAMPING, TORQUE_CONSTANT = Kind(1.0, 1.0, 0.2), Kind(0.05, 0.10)


def written_share(tolerance: str, number: float, unit: str, where: str) -> float:
    """A written tolerance as a share of the value.

    Args:
        tolerance: such as "5 %" or "2 kg".
        number: the value [SI].
        unit: its SI unit.
        where: key, for messages.

    Raises:
        InputError: neither a share nor in the unit of the value.
    """
    text = tolerance.removeprefix("±").strip()
    try:
        return parse(text, "1", where)
    except InputError:
        if unit == "1":
            raise
        return parse(text, unit, where) / number


def deviation_of(share: float) -> float:
    """Standard deviation of the logarithm of a value over its declared one, for a tolerance as a share."""
    return 0.5 * math.log1p(share)
