"""Coulomb level that differs between the two directions.

    level = Fc + dF (1 + sign v) / 2

| symbol | key | meaning | unit |
|---|---|---|---|
| dF | delta_force | level for v > 0 less level for v < 0 | N |

It equals `constant_force` dF/2 with a Coulomb level dF/2 higher: where that level is free as well, the two cannot be
told apart. Odd in velocity only together with a constant force.
Source: Armstrong-Helouvry, Dupont, Canudas de Wit, Automatica 30 (1994) 1083, section 2.
"""

from __future__ import annotations

from collections.abc import Mapping

from feeddrive.effects.base import FrictionEffect, Motion, Parameter, Port, Signature, forward, number
from feeddrive.typing import Expression


class DirectionalFriction(FrictionEffect):
    """The part of the asymmetry that is as much more forward as it is less backward, and nothing at rest.

    No effect of a plant: of an asymmetry of another form this part is another, and the mean level is not.
    """

    name = "directional_friction"
    words = "friction of a direction"
    ports = (Port.TABLE,)
    parameters = (Parameter("delta_force", "N", size=10.0),)

    def level(self, motion: Motion, p: Mapping[str, Expression]) -> Expression:
        """Level that it adds [N]."""
        return p["delta_force"] * (forward(motion.velocity) - 0.5)


class CoulombAsymmetry(FrictionEffect):
    """Direction-dependent Coulomb level."""

    name = "coulomb_asymmetry"
    words = "Coulomb friction different in the two directions"
    ports = (Port.TABLE,)
    parameters = (Parameter("delta_force", "N", size=10.0),)
    signature = Signature(
        ("motor_torque", "table_position"), "sign of table_velocity", ("constant_force", "friction_deviation")
    )
    curve_over = "table_velocity"

    @property
    def curved(self) -> DirectionalFriction:
        """Its part dF/2 that has the sign of the direction: what two directions differ by may take some speed."""
        return DirectionalFriction.of(delta_force=number(self.values["delta_force"]))

    def level(self, motion: Motion, p: Mapping[str, Expression]) -> Expression:
        """Level that it adds [N]."""
        return p["delta_force"] * forward(motion.velocity)
