"""What the tabulated effects share: a table over one variable, checked, and read off as an expression.

A term of no known name is carried in the plant as what it is: numbers over a variable.

    f(s) = linear between the breakpoints, constant outside;  periodic: s - P floor((s - s_1) / P) in place of s

| symbol | meaning |
|---|---|
| s | variable: position, velocity or time at the port |
| s_1 | first breakpoint |
| P | period |
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import ClassVar, Self

import casadi as ca
import numpy as np

from feeddrive.effects.base import Effect, Port, Value, listed
from feeddrive.effects.friction.friction_vs_position import interpolate
from feeddrive.errors import InputError
from feeddrive.typing import Expression

PERIODIC = "periodic_"
"""Begins the word of a variable that is taken within one period."""


@dataclass(frozen=True)
class Tabulated(Effect):
    """An effect whose values stand in a table over the variable that `place` names."""

    place_key = "variable"
    additive = True
    breakpoint_keys: ClassVar[dict[str, str]]
    """Word of the variable to the key of its breakpoints."""
    value_keys: ClassVar[tuple[str, ...]]
    """Keys that a table of values may stand under; one of them or more."""

    @classmethod
    def of(cls, port: Port | None = None, place: str = "", **values: Value) -> Self:
        """The effect with its values in SI units; a plain number is a table of one.

        Args:
            port: where it acts; the first possible port if not given.
            place: the word of the variable; the first if not given.
            values: key to breakpoints, values at them, and the period of a periodic table.

        Raises:
            InputError: as `Effect.of`; tables of unequal length; breakpoints that do not ascend, that stand under
                another variable's key or span the period.
        """
        made = super().of(port, place or cls.places[0], **values)
        wanted = {made.breakpoint_key, *cls.value_keys, *(["period"] if made.periodic else [])}
        for key, value in made.values.items():
            if key not in wanted and value != 0.0:
                mend = f"give {made.breakpoint_key} alone, or name another variable"
                raise InputError(f"{key} is given, and the variable is {made.place}", cls.name, mend)
        given = [key for key in cls.value_keys if made.values[key] != 0.0] or [cls.value_keys[0]]
        tables = {key: listed(made.values[key]) for key in (made.breakpoint_key, *given)}
        period = {"period": made.values["period"]} if made.periodic else {}
        made = replace(made, values={**tables, **period})
        made._refuse_what_is_no_table()
        return made

    def _refuse_what_is_no_table(self) -> None:
        lengths = {key: len(self.table(key)) for key in (self.breakpoint_key, *self.tables)}
        if len(set(lengths.values())) > 1:
            what = " and ".join(f"{key} has {length}" for key, length in lengths.items())
            raise InputError(f"{what} values", self.name, "write lists of equal length")
        if any(b <= a for a, b in pairwise(self.breakpoints)):
            raise InputError(f"{self.breakpoint_key} does not ascend", self.name, "write it in ascending order")
        if self.periodic and not self.breakpoints[-1] - self.breakpoints[0] < self.period:
            mend = "write a period, and breakpoints of one period, its end left out"
            raise InputError("the breakpoints span the period or more", self.name, mend)

    @property
    def breakpoint_key(self) -> str:
        """Key of the breakpoints."""
        return self.breakpoint_keys[self.place]

    @property
    def breakpoints(self) -> tuple[float, ...]:
        """Breakpoints in the variable's SI unit, (k,)."""
        return self.table(self.breakpoint_key)

    @property
    def tables(self) -> tuple[str, ...]:
        """Keys of the values that are given."""
        return tuple(key for key in self.value_keys if key in self.values)

    def table(self, key: str) -> tuple[float, ...]:
        """The list under a key."""
        return listed(self.values[key])

    @property
    def periodic(self) -> bool:
        """Whether the table repeats."""
        return self.place.startswith(PERIODIC)

    @property
    def period(self) -> float:
        """Period in the variable's SI unit; 0 where it does not repeat."""
        value = self.values.get("period", 0.0)
        return 0.0 if isinstance(value, tuple) else float(value)

    def read_off(self, at: Expression, p: Mapping[str, Expression], key: str) -> Expression:
        """The values under `key` at a variable, an expression or an array of shape (n,); 0 where none are given."""
        if key not in self.tables:
            return 0.0
        nodes, levels = _column(p[self.breakpoint_key]), _column(p[key])
        if isinstance(at, np.ndarray):
            at = ca.DM(at)
        if self.periodic:
            at = at - p["period"] * ca.floor((at - nodes[0]) / p["period"])
            # the first point again, a period later, so that the curve closes
            nodes, levels = ca.vertcat(nodes, nodes[0] + p["period"]), ca.vertcat(levels, levels[0])
        return interpolate(at, nodes, levels)


def _column(numbers: Expression) -> Expression:
    """A table as CasADi's column; symbols stay as they are."""
    return ca.DM(list(numbers)) if isinstance(numbers, tuple) else numbers
