"""A force on the table of no known name, as a table over position, velocity or time.

    F = f(s),  s = x, x within a period, v, or t

| symbol | key | meaning | unit |
|---|---|---|---|
| s = x | position | breakpoints along the stroke | m |
| s = v | velocity | breakpoints over the velocity of the table | m/s |
| s = t | time | breakpoints from the start of the recording | s |
| F | force | at the breakpoints; positive resists + motion | N |
| P | period | of a periodic table | m |

Over position conservative, with the energy of its integral; over velocity or time a source: it may feed power in.
Source: no law, what was left of a recording (`feeddrive.diagnosis.unexplained.unexplained`).
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar

from feeddrive.effects.base import Motion, Parameter, Port, Signature, SourceEffect
from feeddrive.effects.tabulated import Tabulated
from feeddrive.typing import Expression


class TabulatedForce(Tabulated, SourceEffect):
    """Force at the table over one variable."""

    name = "tabulated_force"
    ports = (Port.TABLE,)
    places = ("position", "periodic_position", "velocity", "time")
    breakpoint_keys: ClassVar[dict[str, str]] = {
        "position": "position",
        "periodic_position": "position",
        "velocity": "velocity",
        "time": "time",
    }
    value_keys = ("force",)
    parameters = (
        Parameter("position", "m", size=0.1, default=0.0, table=True),
        Parameter("velocity", "m/s", size=0.1, default=0.0, table=True),
        Parameter("time", "s", size=1.0, default=0.0, table=True),
        Parameter("force", "N", size=10.0, default=0.0, table=True),
        Parameter("period", "m", 0.0, 10.0, size=0.01, default=0.0),
    )
    signature = Signature(("motor_torque", "table_position"), "its own variable", ("position_spring", "constant_force"))

    def force(self, motion: Motion, p: Mapping[str, Expression]) -> Expression:
        """Resisting force [N]."""
        at = {"velocity": motion.velocity, "time": motion.time}.get(self.breakpoint_key, motion.position)
        return self.read_off(at, p, "force")
