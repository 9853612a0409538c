"""One number or checkable claim of a source paper beside what the program computes.

The status is never written down, it follows from the comparison: a number agrees when it lies within half a unit of the
last printed digit, or within the stated tolerance; a range when it holds the computed value; a claim when it holds.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import Enum, StrEnum


class Paper(Enum):
    """The source papers: number and citation."""

    EFFICIENCY = ("000", "Kim, Park, Lee: efficiency of ball screws from an estimated friction coefficient")
    LIFE = ("001", "Kim, Park, Cha et al.: life of ball screws")
    HEAT = ("002", "Min, Park, Chung: explicit finite-difference thermal analysis of a ball screw")
    GUIDE = ("003", "Oh, Khim, Park, Chung: friction force of LM ball guides")
    STIFFNESS = ("004", "Lee, Park, Ro, Lee: axial-torsional combined stiffness of a feed drive")

    @property
    def number(self) -> str:
        """Number under which the project cites it."""
        return self.value[0]

    @property
    def citation(self) -> str:
        """Authors and subject."""
        return self.value[1]


class Status(StrEnum):
    """What became of a printed number or claim."""

    REPRODUCED = "reproduced"
    ASSUMPTION = "with a stated assumption"
    CONTRADICTED = "contradicted"
    NOT_POSSIBLE = "not possible"


@dataclass(frozen=True)
class Row:
    """A line of the comparison.

    Attributes:
        paper: source.
        place: equation, table, figure or section.
        quantity: what it is.
        unit: of printed and computed value, as people write it; "" for none.
        printed: as the paper prints it.
        computed: as the program computes it; "" where it cannot.
        deviation: (computed - printed) / printed; None where there is no such number.
        status: what became of it.
        reason: one line, required for every status but `REPRODUCED`.
    """

    paper: Paper
    place: str
    quantity: str
    unit: str
    printed: str
    computed: str
    deviation: float | None
    status: Status
    reason: str = ""

    def __post_init__(self) -> None:
        if self.status is not Status.REPRODUCED and not self.reason:
            raise ValueError(f"{self.paper.number} {self.place} {self.quantity}: {self.status} needs a reason")
        if "\n" in self.reason:
            raise ValueError(f"{self.paper.number} {self.place} {self.quantity}: the reason is one line")


def number(
    paper: Paper, place: str, quantity: str, unit: str, printed: str, computed: float, *,
    within: float | None = None, assumption: str = "", otherwise: str = "",
) -> Row:  # fmt: skip
    """A printed number.

    Args:
        paper: source.
        place: equation, table, figure or section.
        quantity: what it is.
        unit: of both.
        printed: exactly as printed, with its digits ("244.7").
        computed: the same quantity, in `unit`.
        within: relative tolerance in place of half a unit of the last printed digit.
        assumption: what had to be assumed to reproduce it.
        otherwise: why it is contradicted, where it does not agree.
    """
    value = float(printed)
    margin = abs(value) * within if within is not None else 0.5 * last_digit(printed)
    agrees = math.isfinite(computed) and abs(computed - value) <= margin * (1 + 1e-9)
    deviation = (computed - value) / value if value else None
    shown = f"{computed:.{significant_digits(printed) + 1}g}"
    return _row(paper, place, quantity, unit, printed, shown, deviation, agrees, assumption, otherwise)


def span(
    paper: Paper, place: str, quantity: str, unit: str, low: float, high: float, computed: float | tuple[float, ...], *,
    slack: float = 0.0, assumption: str = "", otherwise: str = "",
) -> Row:  # fmt: skip
    """A printed range that must hold one or several computed values, to within `slack` [unit] at its ends."""
    values = computed if isinstance(computed, tuple) else (computed,)
    agrees = all(low - slack <= value <= high + slack for value in values)
    shown = " to ".join(f"{value:.4g}" for value in dict.fromkeys((min(values), max(values))))
    return _row(paper, place, quantity, unit, f"{low:g} to {high:g}", shown, None, agrees, assumption, otherwise)


def claim(
    paper: Paper, place: str, quantity: str, printed: str, computed: str, holds: bool, *,
    unit: str = "", assumption: str = "", otherwise: str = "",
) -> Row:  # fmt: skip
    """A claim in words: what is claimed, what is computed, and whether that makes it true."""
    return _row(paper, place, quantity, unit, printed, computed, None, bool(holds), assumption, otherwise)


def not_possible(paper: Paper, place: str, quantity: str, unit: str, printed: str, reason: str) -> Row:
    """Something printed that no computation can reach, and why."""
    return Row(paper, place, quantity, unit, printed, "", None, Status.NOT_POSSIBLE, reason)


def significant_digits(printed: str) -> int:
    """Digits of a printed number that count."""
    digits = printed.lower().split("e")[0].lstrip("+-").replace(".", "").lstrip("0")
    return max(len(digits), 1)


def last_digit(printed: str) -> float:
    """One unit of the last printed digit."""
    mantissa, _, exponent = printed.lower().partition("e")
    places = len(mantissa.partition(".")[2])
    return float(10.0 ** (int(exponent or 0) - places))


def _row(
    paper: Paper, place: str, quantity: str, unit: str, printed: str, shown: str, deviation: float | None,
    agrees: bool, assumption: str, otherwise: str,
) -> Row:  # fmt: skip
    if not agrees:
        reason = otherwise or assumption
        return Row(paper, place, quantity, unit, printed, shown, deviation, Status.CONTRADICTED, reason)
    status = Status.ASSUMPTION if assumption else Status.REPRODUCED
    return Row(paper, place, quantity, unit, printed, shown, deviation, status, assumption)
