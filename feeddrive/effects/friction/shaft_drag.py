"""Declared drag of the preloaded nut and of the support bearings on the screw.

    T = Tc tanh(w / w0) + Tv sign(w) |w|^(2/3)

| symbol | key | meaning | unit |
|---|---|---|---|
| Tc | coulomb | load-dependent (Coulomb) torque | N m |
| w0 | smoothing_speed | speed at which tanh turns | rad/s |
| Tv | viscous | coefficient of the lubricant torque | N m/(rad/s)^(2/3) |

The exponent 2/3 is that of the lubricant torque of rolling bearings (Palmgren). Its slope at rest is infinite; it is
written w (w^2 + eps^2)^(-1/6), which differs by less than 1e-3 Tv below 10 eps and has a finite slope.
Source: Palmgren, Ball and Roller Bearing Engineering (1959); paper 002, friction torque of the nut.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar

import casadi as ca

from feeddrive.effects.base import FrictionEffect, Motion, Parameter, Port, Signature
from feeddrive.typing import Expression

REST_SPEED = 1e-2
"""eps [rad/s]: below this speed the lubricant torque is linear."""


class ShaftDrag(FrictionEffect):
    """Coulomb and lubricant torque on the screw."""

    ports = (Port.SCREW,)
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter("coulomb", "N m", 0.0, size=0.2),
        Parameter("smoothing_speed", "rad/s", 1e-5, 100.0, size=0.1),
        Parameter("viscous", "N m/(rad/s)^(2/3)", 0.0, size=0.02, default=0.0),
    )
    signature = Signature(("motor_torque", "table_position"), "motor_speed", ("friction_deviation",))
    declared = True

    def shape(self, motion: Motion, p: Mapping[str, Expression]) -> Expression:
        """tanh(w / w0)."""
        return ca.tanh(motion.velocity / p["smoothing_speed"])

    def level(self, motion: Motion, p: Mapping[str, Expression]) -> Expression:
        """Coulomb torque [N m]."""
        return p["coulomb"]

    def viscous(self, motion: Motion, p: Mapping[str, Expression]) -> Expression:
        """Lubricant torque [N m]."""
        speed = motion.velocity
        # the power as an exponential is its own derivative, which spares Newton a second power
        return p["viscous"] * speed * ca.exp(ca.log(speed**2 + REST_SPEED**2) / -6)


class NutDrag(ShaftDrag):
    """Drag torque of the preloaded nut."""

    name = "nut_drag"


class BearingDrag(ShaftDrag):
    """Drag torque of the support bearings."""

    name = "bearing_drag"
