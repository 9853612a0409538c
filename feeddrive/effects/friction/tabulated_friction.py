"""Friction of the table of no known name, as a table of its Coulomb level or viscous coefficient over position or time.

    level = Fc + f(s),    viscous force = Fv v + d(s) v,    s = x, x within a period, or t

| symbol | key | meaning | unit |
|---|---|---|---|
| s = x | position | breakpoints along the stroke | m |
| s = t | time | breakpoints from the start of the recording | s |
| f | force | level added to the declared one of the guide, with its direction | N |
| d | viscous | coefficient added to the declared one | N s/m |
| P | period | of a periodic table | m |

Either of the tables may be left out. Dissipative while level and coefficient stay positive.
Source: no law, what was left of a recording (`feeddrive.diagnosis.unexplained.unexplained`).
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar

from feeddrive.effects.base import FrictionEffect, Motion, Parameter, Port, Signature
from feeddrive.effects.tabulated import Tabulated
from feeddrive.typing import Expression


class TabulatedFriction(Tabulated, FrictionEffect):
    """Friction at the table over one variable."""

    name = "tabulated_friction"
    ports = (Port.TABLE,)
    places = ("position", "periodic_position", "time")
    breakpoint_keys: ClassVar[dict[str, str]] = {
        "position": "position",
        "periodic_position": "position",
        "time": "time",
    }
    value_keys = ("force", "viscous")
    parameters = (
        Parameter("position", "m", size=0.1, default=0.0, table=True),
        Parameter("time", "s", size=1.0, default=0.0, table=True),
        Parameter("force", "N", size=10.0, default=0.0, table=True),
        Parameter("viscous", "N s/m", size=50.0, default=0.0, table=True),
        Parameter("period", "m", 0.0, 10.0, size=0.01, default=0.0),
    )
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
        return self.read_off(self._variable(motion), p, "force")

    def viscous(self, motion: Motion, p: Mapping[str, Expression]) -> Expression:
        """Speed-dependent force that it adds [N]."""
        return self.read_off(self._variable(motion), p, "viscous") * motion.velocity

    def _variable(self, motion: Motion) -> Expression:
        return motion.time if self.breakpoint_key == "time" else motion.position
