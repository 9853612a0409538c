"""Coulomb level that changes at low speed.

    level = Fc + dF exp(-(v / vs)^2)

| symbol | key | meaning | unit |
|---|---|---|---|
| dF | delta_force | level near rest less Coulomb level; negative for a low-speed drop | N |
| vs | velocity | Stribeck velocity | m/s |

Dissipative while Fc + dF > 0.
Source: Stribeck, VDI-Z 46 (1902); Bo and Pavelescu, Wear 82 (1982) 277 (exponential form).
"""

from __future__ import annotations

from collections.abc import Mapping

import casadi as ca

from feeddrive.effects.base import FrictionEffect, Motion, Parameter, Port, Signature, number
from feeddrive.typing import Expression


class Stribeck(FrictionEffect):
    """Low-speed rise or drop of the Coulomb level."""

    name = "stribeck"
    words = "Stribeck friction at low speed"
    headline = ("delta_force", "velocity")
    ports = (Port.TABLE,)
    parameters = (
        Parameter("delta_force", "N", size=10.0),
        Parameter("velocity", "m/s", 1e-6, 10.0, size=0.02),
    )
    signature = Signature(("motor_torque", "table_position"), "table_velocity", ("friction_deviation", "presliding"))
    curve_scale = "velocity"

    def turning_points(self) -> dict[str, tuple[float, ...]]:
        """At rest, and where the exponential has gone."""
        velocity = number(self.values["velocity"])
        return {"speed": (0.0, 6.0 * velocity)}

    def level(self, motion: Motion, p: Mapping[str, Expression]) -> Expression:
        """Level that it adds [N]."""
        return p["delta_force"] * ca.exp(-((motion.velocity / p["velocity"]) ** 2))
