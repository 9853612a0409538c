"""Drag on the screw that rises with the force that the nut transmits.

    level = Tc + c |F| (|F| / F0)^b r

| symbol | key | meaning | unit |
|---|---|---|---|
| c | coefficient | friction torque over the ideal torque of the transmitted force, at F0; it resists motion | 1 |
| b | bend | power of the force beyond the first; 0 where friction is in proportion, 1/3 of rolling contacts | 1 |
| F0 | at_force | transmitted force at which c holds, 1 kN if left out; of no meaning where b is 0 | N |
| F | (motion) | transmitted force of the nut | N |
| r | (chain) | lead / 2 pi | m/rad |
| Tc | (declared) | Coulomb torque declared at the screw | N m |

c is the mean of the losses 1/eta_a - 1 and 1 - eta_b, which `nut_friction` tells apart by the sign of the power; 0.07
is an efficiency of 93 %. The torque has the shape of the declared drag at the screw.
Balls that roll under a Hertzian pressure resist by the 4/3 power of the force, b = 1/3. A diagnosis fits c, and b where
that is likelier, F0 being the rms of the recorded force. Within a thousandth of F0 about no force the power is that of
a first one, so that the slope stays finite where b is negative.
Dissipative: c is not negative. The slope over F has a corner at F = 0.
Source: paper 000, eqs. (5), (6), to first order in f. The power is an extension of our own.
"""

from __future__ import annotations

from collections.abc import Mapping

import casadi as ca

from feeddrive.effects.base import FrictionEffect, Motion, Parameter, Port, Signature
from feeddrive.typing import Expression

FIRST_POWER = 1e-3
"""Share of F0 about no force within which the power is the first."""


class LoadDependentFriction(FrictionEffect):
    """Coulomb torque that goes with the transmitted force, or with a power of it."""

    name = "load_dependent_friction"
    words = "friction rising with the transmitted force"
    ports = (Port.SCREW,)
    parameters = (
        Parameter("coefficient", "1", 0.0, 10.0, size=0.02),
        Parameter("bend", "1", -0.9, 2.0, size=0.3, default=0.0),
        Parameter("at_force", "N", 1e-3, 1e9, size=1000.0, default=1000.0),
    )
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
        over = (motion.force / p["at_force"]) ** 2 + FIRST_POWER**2
        return p["coefficient"] * ca.fabs(motion.force) * over ** (p["bend"] / 2) * motion.radius
