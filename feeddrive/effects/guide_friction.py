"""Declared friction of the linear guide on the table.

    F = Fc tanh(v / v0) + Fv v

| symbol | key | meaning | unit |
|---|---|---|---|
| Fc | coulomb | Coulomb level | N |
| v0 | smoothing_velocity | velocity at which tanh turns | m/s |
| Fv | viscous | viscous coefficient | N s/m |

The tanh creeps under a static load F < Fc at v0 atanh(F/Fc); where sticking matters, add `presliding`.
Source: Armstrong-Helouvry, Dupont, Canudas de Wit, Automatica 30 (1994) 1083, section 2.
"""

from __future__ import annotations

from collections.abc import Mapping

import casadi as ca

from feeddrive.effects.base import FrictionEffect, Motion, Parameter, Port, Signature
from feeddrive.typing import Expression


class GuideFriction(FrictionEffect):
    """Coulomb and viscous friction of the guide."""

    name = "guide_friction"
    ports = (Port.TABLE,)
    parameters = (
        Parameter("coulomb", "N", 0.0, size=50.0),
        Parameter("smoothing_velocity", "m/s", 1e-7, 1.0, size=1e-3),
        Parameter("viscous", "N s/m", 0.0, size=100.0, default=0.0),
    )
    signature = Signature(("motor_torque", "table_position"), "table_velocity", ("friction_deviation",))
    declared = True

    def shape(self, motion: Motion, p: Mapping[str, Expression]) -> Expression:
        """tanh(v / v0)."""
        return ca.tanh(motion.velocity / p["smoothing_velocity"])

    def level(self, motion: Motion, p: Mapping[str, Expression]) -> Expression:
        """Coulomb level [N]."""
        return p["coulomb"]

    def viscous(self, motion: Motion, p: Mapping[str, Expression]) -> Expression:
        """Viscous force [N]."""
        return p["viscous"] * motion.velocity
