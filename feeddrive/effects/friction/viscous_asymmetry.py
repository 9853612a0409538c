"""Viscous coefficient that differs between the two directions.

    F = (Fv + dFv (1 + sign v) / 2) v

| symbol | key | meaning | unit |
|---|---|---|---|
| dFv | delta_viscous | coefficient for v > 0 less that for v < 0 | N s/m |

Dissipative while Fv + dFv > 0.
Source: Armstrong-Helouvry, Dupont, Canudas de Wit, Automatica 30 (1994) 1083, section 2.
"""

from __future__ import annotations

from collections.abc import Mapping

from feeddrive.effects.base import FrictionEffect, Motion, Parameter, Port, Signature, forward
from feeddrive.typing import Expression


class ViscousAsymmetry(FrictionEffect):
    """Direction-dependent viscous coefficient."""

    name = "viscous_asymmetry"
    words = "viscous friction different in the two directions"
    ports = (Port.TABLE,)
    parameters = (Parameter("delta_viscous", "N s/m", size=50.0),)
    signature = Signature(
        ("motor_torque", "table_position"), "table_velocity", ("coulomb_asymmetry", "friction_deviation")
    )
    curve_over = "table_velocity"

    def viscous(self, motion: Motion, p: Mapping[str, Expression]) -> Expression:
        """Viscous force that it adds [N]."""
        return p["delta_viscous"] * forward(motion.velocity) * motion.velocity
