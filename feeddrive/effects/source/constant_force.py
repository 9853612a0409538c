"""A constant force on the table: gravity, counterbalance, a hanging cable.

    F = F0

| symbol | key | meaning | unit |
|---|---|---|---|
| F0 | force | positive resists + motion | N |

Conservative: its energy is F0 x.
"""

from __future__ import annotations

from collections.abc import Mapping

from feeddrive.effects.base import Motion, Parameter, Port, Signature, SourceEffect
from feeddrive.typing import Expression


class ConstantForce(SourceEffect):
    """Constant force on the table."""

    name = "constant_force"
    words = "constant force (gravity, counterbalance)"
    ports = (Port.TABLE,)
    parameters = (Parameter("force", "N", size=10.0),)
    signature = Signature(("motor_torque", "table_position"), "nothing: it is there always", ("coulomb_asymmetry",))
    additive = True

    def force(self, motion: Motion, p: Mapping[str, Expression]) -> Expression:
        """Resisting force [N]."""
        return p["force"]
