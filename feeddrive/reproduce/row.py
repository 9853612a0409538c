"""One number or checkable claim of a source paper beside what the program computes.

The status is never written down. It follows from what the row holds: the law of the package that gives the value, what
was assumed, what was fitted, and the comparison. A number agrees when it lies within half a unit of the last printed
digit, or within the stated tolerance; a range when it holds the computed value; a claim when it holds.

| status | law of the package | fitted to the compared value | assumed beside the print | agrees |
|---|---|---|---|---|
| reproduced | yes | no | no | yes |
| with a stated assumption | yes | no | yes | yes |
| fitted | yes | yes | - | yes |
| contradicted | yes | - | - | no |
| about the paper only | no | - | - | - |
| not possible | - | - | - | nothing is computed |
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum, StrEnum
from typing import Any


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
    """A law of the package gives the printed value from printed ones alone."""

    ASSUMPTION = "with a stated assumption"
    """A law of the package gives the printed value; something that is not printed had to be assumed."""

    FITTED = "fitted"
    """A law of the package can take the printed value, as a value of it was chosen so that it does."""

    PAPER_ONLY = "about the paper only"
    """Arithmetic on printed numbers, or printed equations among themselves: no law of the package takes part."""

    CONTRADICTED = "contradicted"
    """A law of the package gives another value."""

    NOT_POSSIBLE = "not possible"
    """Nothing can be computed."""


Law = Callable[..., Any]
"""A function, method or class of the package outside this folder, which gives the computed value."""

_NO_LAW = "printed numbers and equations among themselves"
"""Reason of a row without a law that agrees and says nothing else."""


@dataclass(frozen=True, kw_only=True)
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
        agrees: whether printed and computed value agree; None where nothing is computed.
        law: function of the package that gives the computed value, "module.name"; "" where none takes part.
        assumed: what is not printed and had to be assumed.
        fitted: what was chosen so that the computed value is the printed one.
        otherwise: why it does not agree, or cannot be computed.
    """

    paper: Paper
    place: str
    quantity: str
    unit: str
    printed: str
    computed: str = ""
    deviation: float | None = None
    agrees: bool | None = None
    law: str = ""
    assumed: str = ""
    fitted: str = ""
    otherwise: str = ""

    def __post_init__(self) -> None:
        where = f"{self.paper.number} {self.place} {self.quantity}"
        if self.status is not Status.REPRODUCED and not self.reason:
            raise ValueError(f"{where}: {self.status} needs a reason")
        if "\n" in self.reason:
            raise ValueError(f"{where}: the reason is one line")
        if self.law.startswith(_HERE) or (self.law and not self.law.startswith("feeddrive.")):
            raise ValueError(f"{where}: {self.law} is no law of the package")

    @property
    def status(self) -> Status:
        """What became of it."""
        if self.agrees is None:
            return Status.NOT_POSSIBLE
        if not self.law:
            return Status.PAPER_ONLY
        if not self.agrees:
            return Status.CONTRADICTED
        if self.fitted:
            return Status.FITTED
        return Status.ASSUMPTION if self.assumed else Status.REPRODUCED

    @property
    def reason(self) -> str:
        """One line on the status; "" where it is reproduced."""
        stated = "; ".join(text for text in (self.fitted, self.assumed) if text)
        if not self.agrees:
            return self.otherwise or stated
        return stated or ("" if self.law else _NO_LAW)


_HERE = __name__.rpartition(".")[0] + "."


def number(
    paper: Paper, place: str, quantity: str, unit: str, printed: str, computed: float, *, law: Law | None,
    within: float | None = None, assumption: str = "", fitted: str = "", otherwise: str = "",
) -> Row:  # fmt: skip
    """A printed number.

    Args:
        paper: source.
        place: equation, table, figure or section.
        quantity: what it is.
        unit: of both.
        printed: exactly as printed, with its digits ("244.7").
        computed: the same quantity, in `unit`.
        law: of the package that gives `computed`; None for arithmetic on printed numbers.
        within: relative tolerance in place of half a unit of the last printed digit.
        assumption: what is not printed and had to be assumed.
        fitted: what was chosen so that the printed value comes out.
        otherwise: why it is contradicted, where it does not agree.
    """
    value = float(printed)
    margin = abs(value) * within if within is not None else 0.5 * last_digit(printed)
    return Row(
        paper=paper, place=place, quantity=quantity, unit=unit, printed=printed,
        computed=f"{computed:.{significant_digits(printed) + 1}g}",
        deviation=(computed - value) / value if value else None,
        agrees=math.isfinite(computed) and abs(computed - value) <= margin * (1 + 1e-9),
        law=name_of(law), assumed=assumption, fitted=fitted, otherwise=otherwise,
    )  # fmt: skip


def span(
    paper: Paper, place: str, quantity: str, unit: str, low: float, high: float, computed: float | tuple[float, ...], *,
    law: Law | None, slack: float = 0.0, assumption: str = "", fitted: str = "", otherwise: str = "",
) -> Row:  # fmt: skip
    """A printed range that must hold one or several computed values, to within `slack` [unit] at its ends."""
    values = computed if isinstance(computed, tuple) else (computed,)
    return Row(
        paper=paper, place=place, quantity=quantity, unit=unit, printed=f"{low:g} to {high:g}",
        computed=" to ".join(f"{value:.4g}" for value in dict.fromkeys((min(values), max(values)))),
        agrees=all(low - slack <= value <= high + slack for value in values),
        law=name_of(law), assumed=assumption, fitted=fitted, otherwise=otherwise,
    )  # fmt: skip


def claim(
    paper: Paper, place: str, quantity: str, printed: str, computed: str, holds: bool, *, law: Law | None,
    unit: str = "", assumption: str = "", fitted: str = "", otherwise: str = "",
) -> Row:  # fmt: skip
    """A claim in words: what is claimed, what is computed, and whether that makes it true."""
    return Row(
        paper=paper, place=place, quantity=quantity, unit=unit, printed=printed, computed=computed, agrees=bool(holds),
        law=name_of(law), assumed=assumption, fitted=fitted, otherwise=otherwise,
    )  # fmt: skip


def misprint(paper: Paper, place: str, quantity: str, printed: str, needed: str, why: str) -> Row:
    """A letter, sign or unit that the paper prints beside the one that its other equations or numbers need."""
    return claim(paper, place, quantity, printed, needed, printed == needed, law=None, otherwise=why)


def not_possible(paper: Paper, place: str, quantity: str, unit: str, printed: str, reason: str) -> Row:
    """Something printed that no computation can reach, and why."""
    return Row(paper=paper, place=place, quantity=quantity, unit=unit, printed=printed, otherwise=reason)


def name_of(law: Law | None) -> str:
    """Module and name of a law of the package, "" for none."""
    return "" if law is None else f"{law.__module__}.{law.__qualname__}"


def significant_digits(printed: str) -> int:
    """Digits of a printed number that count."""
    digits = printed.lower().split("e")[0].lstrip("+-").replace(".", "").lstrip("0")
    return max(len(digits), 1)


def last_digit(printed: str) -> float:
    """One unit of the last printed digit."""
    mantissa, _, exponent = printed.lower().partition("e")
    places = len(mantissa.partition(".")[2])
    return float(10.0 ** (int(exponent or 0) - places))
