"""A torque on motor or screw of no known name, as a table over angle, speed or time.

    T = f(s),  s = angle, angle within a period, speed, or t

| symbol | key | meaning | unit |
|---|---|---|---|
| s | angle | breakpoints over the angle of the shaft, recorded and unwrapped | rad |
| s | speed | breakpoints over the speed of the shaft | rad/s |
| s = t | time | breakpoints from the start of the recording | s |
| T | torque | at the breakpoints; positive resists + motion | N m |
| P | period | of a periodic table | rad |

Over the angle conservative, with the energy of its integral; over speed or time a source: it may feed power in.
Source: no law, what was left of a recording (`feeddrive.diagnosis.unexplained.unexplained`).
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar

from feeddrive.effects.base import Motion, Parameter, Port, Signature, SourceEffect
from feeddrive.effects.tabulated import Tabulated
from feeddrive.typing import Expression


class TabulatedTorque(Tabulated, SourceEffect):
    """Torque at a shaft over one variable."""

    name = "tabulated_torque"
    ports = (Port.MOTOR, Port.SCREW)
    places = ("angle", "periodic_angle", "speed", "time")
    breakpoint_keys: ClassVar[dict[str, str]] = {
        "angle": "angle",
        "periodic_angle": "angle",
        "speed": "speed",
        "time": "time",
    }
    value_keys = ("torque",)
    parameters = (
        Parameter("angle", "rad", size=1.0, default=0.0, table=True),
        Parameter("speed", "rad/s", size=10.0, default=0.0, table=True),
        Parameter("time", "s", size=1.0, default=0.0, table=True),
        Parameter("torque", "N m", size=0.05, default=0.0, table=True),
        Parameter("period", "rad", 0.0, 1e4, size=1.0, default=0.0),
    )
    signature = Signature(("motor_torque",), "its own variable", ("torque_ripple",))

    def force(self, motion: Motion, p: Mapping[str, Expression]) -> Expression:
        """Resisting torque [N m]."""
        at = {"speed": motion.velocity, "time": motion.time}.get(self.breakpoint_key, motion.position)
        return self.read_off(at, p, "torque")
