"""Drag on the screw that rises with the force that the nut transmits.

    level = Tc + c |F| r

| symbol | key | meaning | unit |
|---|---|---|---|
| c | coefficient | friction torque over the ideal torque of the transmitted force; resists motion where positive | 1 |
| F | (motion) | transmitted force of the nut | N |
| r | (chain) | lead / 2 pi | m/rad |
| Tc | (declared) | Coulomb torque declared at the screw | N m |

c is the mean of the losses 1/eta_a - 1 and 1 - eta_b, which `nut_friction` tells apart by the sign of the power; 0.07
is an efficiency of 93 %. The torque has the shape of the declared drag at the screw.
Dissipative: c is not negative. The slope over F has a corner at F = 0.
Source: paper 000, eqs. (5), (6), to first order in f.
"""

from __future__ import annotations

from collections.abc import Mapping

import casadi as ca

from feeddrive.effects.base import FrictionEffect, Motion, Parameter, Port, Signature
from feeddrive.typing import Expression


class LoadDependentFriction(FrictionEffect):
    """Coulomb torque proportional to the transmitted force."""

    name = "load_dependent_friction"
    words = "friction rising with the transmitted force"
    ports = (Port.SCREW,)
    parameters = (Parameter("coefficient", "1", 0.0, 10.0, size=0.02),)
    signature = Signature(
        ("motor_torque", "table_position"), "transmitted force", ("friction_deviation", "nut_friction", "payload")
    )
    reads_force = True
    curve_over = "motor_torque"

    def least_level(self, radius: float) -> float:
        """0 N m, without load."""
        return 0.0

    def level(self, motion: Motion, p: Mapping[str, Expression]) -> Expression:
        """Torque that it adds [N m]."""
        return p["coefficient"] * ca.fabs(motion.force) * motion.radius
