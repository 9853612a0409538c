"""A spring between table and frame: cable chain, bellows, hose.

    F = k (x - x0)

| symbol | key | meaning | unit |
|---|---|---|---|
| k | stiffness | of the spring | N/m |
| x0 | zero | table position at which it pulls nowhere | m |

Conservative: its energy is k (x - x0)^2 / 2.
"""

from __future__ import annotations

from collections.abc import Mapping

from feeddrive.effects.base import Motion, Parameter, Port, Signature, SourceEffect
from feeddrive.typing import Expression


class PositionSpring(SourceEffect):
    """Force on the table that grows with its position."""

    name = "position_spring"
    words = "spring force on the table (cable chain, bellows)"
    ports = (Port.TABLE,)
    parameters = (Parameter("stiffness", "N/m", size=50.0), Parameter("zero", "m", size=0.1))
    signature = Signature(("motor_torque", "table_position"), "table position", ("constant_force",))
    curve_over = "table_position"

    def force(self, motion: Motion, p: Mapping[str, Expression]) -> Expression:
        """Resisting force [N]."""
        return p["stiffness"] * (motion.position - p["zero"])
