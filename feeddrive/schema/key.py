"""A key of a file: what it means, its unit, range, default, and whether it must stand there.

Keys are declared in tables, one a line, cells between bars:

    velocity | m/s       | > 0                         | required | greatest velocity
    repeat   | whole     | [0, 10000]                  | = 1      | how often all targets are gone through
    at       | text      | torque, speed               | = torque | where the filter acts
    ratio    | 1         | [0, 1] usual 0.01 to 0.05   |          | damping ratio | where it counts
    targets  | m list    |                             | required | positions in their order

name | SI unit, or text, words, whole, switch | range or choices | required or default | meaning | when it counts.
Ranges: > a, >= a, (a, b) without its ends, [a, b] with them.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass
from enum import StrEnum

from feeddrive.units.quantity import format_quantity


class Kind(StrEnum):
    """What a key holds."""

    QUANTITY = "quantity"
    QUANTITIES = "list of quantities"
    TEXT = "text"
    WORDS = "list of words"
    WHOLE = "whole number"
    SWITCH = "true or false"


@dataclass(frozen=True)
class Key:
    """One key of a section.

    Attributes:
        name: in the file.
        meaning: in a few words.
        unit: SI unit of a quantity, "1" for a number without unit; "" for what is none, or depends on another key.
        kind: what it holds.
        minimum, maximum: possible range [unit].
        open_ends: whether the ends of the possible range are impossible themselves.
        usual: range in which it usually lies [unit]; None where anything possible is usual.
        default: what is meant where it is left out, as written in a file; None where that needs no value.
        required: whether it must stand there.
        choices: words that it may be; none where any text may stand.
        when: under which circumstances it counts; "" for always.
    """

    name: str
    meaning: str
    unit: str = ""
    kind: Kind = Kind.QUANTITY
    minimum: float = -math.inf
    maximum: float = math.inf
    open_ends: bool = False
    usual: tuple[float, float] | None = None
    default: str | None = None
    required: bool = False
    choices: tuple[str, ...] = ()
    when: str = ""

    @property
    def range(self) -> str:
        """The possible range in words, or the choices; "" where anything may stand."""
        if self.choices:
            return ", ".join(self.choices)
        low, high = (format_quantity(end, self.unit or "1") for end in (self.minimum, self.maximum))
        if math.isfinite(self.minimum) and math.isfinite(self.maximum):
            return f"{'between ' if self.open_ends else ''}{low} {'and' if self.open_ends else 'to'} {high}"
        if math.isfinite(self.minimum):
            return f"above {low}" if self.open_ends else f"{low} or more"
        return f"{high} or less" if math.isfinite(self.maximum) else ""

    @property
    def usual_range(self) -> str:
        """The usual range in words; "" where there is none."""
        if self.usual is None:
            return ""
        return " to ".join(format_quantity(end, self.unit) for end in self.usual)

    @property
    def needed(self) -> str:
        """ "required", its default, or "optional"."""
        if self.required:
            return "required"
        return f"default {self.default}" if self.default is not None else "optional"

    def says(self) -> str:
        """Meaning, unit and range in one line, for an error."""
        unit = f" [{self.unit}]" if self.unit not in ("", "1") else ""
        ends = self.range if not self.choices else ""
        parts = [f"{self.name}{unit} is {self.meaning}", ends, f"usual {self.usual_range}" if self.usual else ""]
        return ", ".join(part for part in parts if part)


@dataclass(frozen=True)
class Bounds:
    """The range cell of a table: possible range, whether its ends are impossible themselves, usual range."""

    minimum: float = -math.inf
    maximum: float = math.inf
    open_ends: bool = False
    usual: tuple[float, float] | None = None


_NUMBER = r"([-+.\de]+)"
_RANGE = re.compile(rf"(?:(>=?) {_NUMBER}|([(\[]){_NUMBER}, {_NUMBER}[)\]])?(?: ?usual {_NUMBER} to {_NUMBER})?")


def bounds(cell: str) -> Bounds | None:
    """What a range cell says; None where it holds no range."""
    match = _RANGE.fullmatch(cell)
    if match is None:
        return None
    sign, least, bracket, low, high, *usual = match.groups()
    ends = (float(least), math.inf) if least else (float(low), float(high)) if low else (-math.inf, math.inf)
    return Bounds(*ends, sign == ">" or bracket == "(", (float(usual[0]), float(usual[1])) if usual[0] else None)


def table_rows(table: str) -> Iterator[list[str]]:
    """The cells of each line that is not empty."""
    for line in table.splitlines():
        if line.strip():
            yield [cell.strip() for cell in line.split("|")]


_KINDS = {str(kind).split()[0]: kind for kind in (Kind.TEXT, Kind.WHOLE)} | {"words": Kind.WORDS, "switch": Kind.SWITCH}


def keys(table: str) -> tuple[Key, ...]:
    """The keys that a table declares, in its order; its form is that of the module."""
    return tuple(_key(*cells) for cells in table_rows(table))


def _key(name: str, holds: str, ends: str, needed: str, meaning: str, when: str = "") -> Key:
    kind, unit = _KINDS.get(holds, Kind.QUANTITY), "" if holds in _KINDS else holds
    if holds.endswith(" list"):
        kind, unit = Kind.QUANTITIES, holds.removesuffix(" list")
    found = bounds(ends)
    choices = tuple(ends.split(", ")) if found is None else ()
    found = found or Bounds()
    default = needed.removeprefix("=").strip() if needed.startswith("=") else None
    return Key(
        name, meaning, "1" if kind is Kind.WHOLE else unit, kind, found.minimum, found.maximum, found.open_ends,
        found.usual, default, needed == "required", choices, when,
    )  # fmt: skip


SOURCE = "source | text | | | where the values come from, of every value here that names none itself"
"""Row of the key that names the source of a whole section."""
