"""The weight of what moves on an inclined axis, less its counterbalance.

    F = M g sin(a) - C sign(a)

| symbol | key | meaning | unit |
|---|---|---|---|
| a | inclination | of the + direction above the horizontal | rad |
| C | counterbalance | force against the weight | N |
| M, g | (chain) | all that moves with the table, payload included; acceleration of fall | kg, m/s^2 |

Conservative: its energy is F x. No finding: the table of a plant file declares it, and it follows the mass whatever
changes that.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

import casadi as ca

from feeddrive.effects.base import Motion, Parameter, Port, Signature, SourceEffect
from feeddrive.typing import Expression

GRAVITY = 9.80665
"""Standard acceleration of fall [m/s^2]."""


class Weight(SourceEffect):
    """Weight of what moves with the table, less a counterbalance."""

    name = "weight"
    words = "weight, less the counterbalance"
    ports = (Port.TABLE,)
    parameters = (
        Parameter("inclination", "rad", -math.pi / 2, math.pi / 2),
        Parameter("counterbalance", "N", 0.0, default=0.0),
    )
    signature = Signature(("motor_torque", "table_position"), "nothing: it is there always")

    def force(self, motion: Motion, p: Mapping[str, Expression]) -> Expression:
        """Resisting force [N]."""
        angle = p["inclination"]
        return motion.mass * GRAVITY * ca.sin(angle) - p["counterbalance"] * ca.sign(angle)
