"""What has no known name, as a table over one variable: a force, a torque, a travel deviation or friction.

    F = f(s);  T = f(s);  delta = f(s);  level = Fc + f(s);  viscous force = (Fv + d(s)) v

    f linear between the breakpoints, constant outside;  periodic: s - P floor((s - s_1) / P) in place of s

| symbol | key | meaning | unit |
|---|---|---|---|
| s = x | position | breakpoints along the stroke | m |
| s = v | velocity | breakpoints over the velocity of the table | m/s |
| s | angle | breakpoints over the angle of the shaft, recorded and unwrapped | rad |
| s | speed | breakpoints over the speed of the shaft | rad/s |
| s = t | time | breakpoints from the start of the recording | s |
| F, f | force | on the table, positive resists + motion; of friction what is added to the declared level | N |
| T | torque | on the shaft, positive resists + motion | N m |
| delta | travel | positive moves the nut forward | m |
| d | viscous | coefficient added to the declared one of the guide | N s/m |
| P, s_1 | period | of a periodic table; s_1 is its first breakpoint | m, rad |

Force, torque and travel over position or angle are conservative, with the energy of their integral; over speed or time
sources that may feed power in. Friction is dissipative while level and coefficient stay positive; either of its tables
may be left out.
Source: no law, what was left of a recording (`feeddrive.diagnosis.unexplained.unexplained`).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import ClassVar, Self

import casadi as ca
import numpy as np

from feeddrive.effects.base import (
    Effect,
    FrictionEffect,
    Motion,
    Parameter,
    Port,
    Signature,
    SourceEffect,
    TravelEffect,
    Value,
    listed,
)
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
    value_keys: ClassVar[tuple[str, ...]]
    """Keys that a table of values may stand under; one of them or more."""

    @classmethod
    def of(cls, port: Port | None = None, place: str = "", **values: Value) -> Self:
        """The effect with its values in SI units; a plain number is a table of one.

        Port and place are the first possible ones if not given; values are breakpoints, values at them, and the period
        of a periodic table. Raises InputError: as `Effect.of`; tables of unequal length; breakpoints that do not
        ascend, that stand under another variable's key or span the period.
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
        return self.place.removeprefix(PERIODIC)

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
        nodes, levels = p[self.breakpoint_key], p[key]
        if isinstance(at, np.ndarray):
            return interpolate(at, nodes, levels, self.period)
        return interpolate(at, _column(nodes), _column(levels), p["period"] if self.periodic else 0.0)

    def at_motion(self, motion: Motion, p: Mapping[str, Expression], key: str) -> Expression:
        """The values under `key` at a motion of the port."""
        at = {"velocity": motion.velocity, "speed": motion.velocity, "time": motion.time}
        return self.read_off(at.get(self.breakpoint_key, motion.position), p, key)


def _column(numbers: Expression) -> Expression:
    """A table as CasADi's column; symbols stay as they are."""
    return ca.DM(list(numbers)) if isinstance(numbers, tuple) else numbers


_POSITION = Parameter("position", "m", size=0.1, default=0.0, table=True)
_TIME = Parameter("time", "s", size=1.0, default=0.0, table=True)
_FORCE = Parameter("force", "N", size=10.0, default=0.0, table=True)
_PERIOD = Parameter("period", "m", 0.0, 10.0, size=0.01, default=0.0)


class TabulatedForce(Tabulated, SourceEffect):
    """Force at the table over one variable."""

    name = "tabulated_force"
    words = "a force on the table"
    ports = (Port.TABLE,)
    places = ("position", "periodic_position", "velocity", "time")
    value_keys = ("force",)
    parameters = (
        _POSITION, Parameter("velocity", "m/s", size=0.1, default=0.0, table=True), _TIME, _FORCE, _PERIOD,
    )  # fmt: skip
    signature = Signature(("motor_torque", "table_position"), "its own variable", ("position_spring", "constant_force"))

    def force(self, motion: Motion, p: Mapping[str, Expression]) -> Expression:
        """Resisting force [N]."""
        return self.at_motion(motion, p, "force")


class TabulatedTorque(Tabulated, SourceEffect):
    """Torque at a shaft over one variable."""

    name = "tabulated_torque"
    words = "a torque on a shaft"
    ports = (Port.MOTOR, Port.SCREW)
    places = ("angle", "periodic_angle", "speed", "time")
    value_keys = ("torque",)
    parameters = (
        Parameter("angle", "rad", size=1.0, default=0.0, table=True),
        Parameter("speed", "rad/s", size=10.0, default=0.0, table=True),
        _TIME,
        Parameter("torque", "N m", size=0.05, default=0.0, table=True),
        Parameter("period", "rad", 0.0, 1e4, size=1.0, default=0.0),
    )
    signature = Signature(("motor_torque",), "its own variable", ("torque_ripple",))

    def force(self, motion: Motion, p: Mapping[str, Expression]) -> Expression:
        """Resisting torque [N m]."""
        return self.at_motion(motion, p, "torque")


class TabulatedTravel(Tabulated, TravelEffect):
    """Travel deviation over one variable."""

    name = "tabulated_travel"
    words = "a travel error"
    ports = (Port.TRANSMISSION,)
    places = ("position", "periodic_position", "time")
    value_keys = ("travel",)
    parameters = (_POSITION, _TIME, Parameter("travel", "m", -0.01, 0.01, 1e-6, default=0.0, table=True), _PERIOD)
    signature = Signature(("table_position",), "its own variable", ("lead_error_periodic", "lead_error_cumulative"))

    def travel(
        self, angle: Expression, position: Expression, time: Expression, p: Mapping[str, Expression]
    ) -> Expression:
        """Travel deviation [m]."""
        return self.at_motion(Motion(position, 0.0, time), p, "travel")


class TabulatedFriction(Tabulated, FrictionEffect):
    """Friction at the table over one variable."""

    name = "tabulated_friction"
    words = "friction of the table"
    ports = (Port.TABLE,)
    places = ("position", "periodic_position", "time")
    value_keys = ("force", "viscous")
    parameters = (
        _POSITION, _TIME, _FORCE, Parameter("viscous", "N s/m", size=50.0, default=0.0, table=True), _PERIOD,
    )  # fmt: skip
    signature = Signature(("motor_torque", "table_position"), "its own variable", ("friction_vs_position",))

    def turning_points(self) -> dict[str, tuple[float, ...]]:
        """The points of the table."""
        return {self.breakpoint_key: self.breakpoints}

    def least_level(self, radius: float) -> float | None:
        """Least entry of a table that repeats along the way [N]."""
        if not self.periodic:
            return None
        return min(self.table("force")) if "force" in self.tables else 0.0

    def level(self, motion: Motion, p: Mapping[str, Expression]) -> Expression:
        """Coulomb level that it adds [N]."""
        return self.at_motion(motion, p, "force")

    def viscous(self, motion: Motion, p: Mapping[str, Expression]) -> Expression:
        """Speed-dependent force that it adds [N]."""
        return self.at_motion(motion, p, "viscous") * motion.velocity
