"""Ripple of the nut drag, locked to the screw angle: balls entering and leaving the nut.

    level = level0 + A sin(n phi + phase)

| symbol | key | meaning | unit |
|---|---|---|---|
| A | amplitude | of the drag; it resists motion, so it changes sign with the direction | N m |
| n | order | periods per screw revolution, in general no whole number | 1 |
| phase | phase | at recorded, unwrapped screw angle 0 | rad |

Dissipative while A stays below the declared level of the screw. A torque ripple keeps its sign when the axis turns.
"""

from __future__ import annotations

from collections.abc import Mapping

import casadi as ca

from feeddrive.effects.base import FrictionEffect, Motion, Parameter, Port, Signature, number
from feeddrive.typing import Expression


class BallPassRipple(FrictionEffect):
    """Sinusoidal drag over the screw angle."""

    name = "ball_pass_ripple"
    words = "drag ripple from the balls passing"
    headline = ("amplitude", "order")
    ports = (Port.SCREW,)
    parameters = (
        Parameter("amplitude", "N m", 0.0, size=0.05),
        Parameter("order", "1", 1e-3, 1e4, size=1.0),
        Parameter("phase", "rad", size=1.0, default=0.0),
    )
    signature = Signature(("motor_torque",), "screw angle and direction", ("torque_ripple",))
    repeatable = True
    additive = True

    def least_level(self, radius: float) -> float:
        """-A [N m]: a turn of the screw passes every phase."""
        return -number(self.values["amplitude"])

    def level(self, motion: Motion, p: Mapping[str, Expression]) -> Expression:
        """Level beyond the declared drag [N m]."""
        return p["amplitude"] * ca.sin(p["order"] * motion.position + p["phase"])
