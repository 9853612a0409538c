"""Weight of what an axis that is not level carries beyond its declared mass.

    F = g_x (m - m0)

| symbol | key | meaning | unit |
|---|---|---|---|
| F | | force on the table, positive resists + motion | N |
| g_x | fall | acceleration of fall along the axis, g sin(inclination) | m/s^2 |
| m | | mass of the table as it is, with what swings on it | kg |
| m0 | weighed | declared mass, whose weight stands among the declared forces | kg |

A payload, a mode's mass and a declared mass that is corrected hang as well: without their weight each would bring a
constant force of its own.
"""

from __future__ import annotations

from collections.abc import Mapping

from feeddrive.effects.base import Motion, Parameter, Port, Signature, SourceEffect
from feeddrive.typing import Expression


class HangingMass(SourceEffect):
    """Weight beyond the declared one.

    No finding: `inclination` of a plant file declares it.
    """

    name = "hanging_mass"
    words = "weight of what is carried beyond the declared mass"
    ports = (Port.TABLE,)
    parameters = (Parameter("fall", "m/s^2", size=1.0), Parameter("weighed", "kg", 0.0, size=10.0))
    signature = Signature(("motor_torque", "table_position"), "nothing: it is there always", ("constant_force",))
    additive = True

    def force(self, motion: Motion, p: Mapping[str, Expression]) -> Expression:
        """Resisting force [N]."""
        return p["fall"] * (motion.mass - p["weighed"])
