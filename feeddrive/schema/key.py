"""A key of a file: what it means, its unit, range, default, and whether it must stand there."""

from __future__ import annotations

import math
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
