"""Friction torque of a ball nut that grows with the force it transmits, from slipping balls.

    T = T_f tanh(w / w0) + Tv sign(w) |w|^(2/3)
    T_f = r (F_A l_a + F_B l_b)  for w > 0,    T_f = r (F_A l_b + F_B l_a)  for w < 0
    l_a = 1/eta_a - 1 = f / (a_n - f b_n),     l_b = 1 - eta_b = f / (a_n + f b_n)

| symbol | key | meaning | unit |
|---|---|---|---|
| f | friction_coefficient | effective Coulomb coefficient of the balls | 1 |
| beta | contact_angle | contact angle, from the radial direction | rad |
| d_m | pitch_diameter | diameter of the circle of ball centres | m |
| F_0 | preload | preload of a double nut with spacer or oversize balls; 0 for a single nut | N |
| w0 | smoothing_speed | speed at which tanh turns | rad/s |
| Tv | viscous | coefficient of the lubricant torque | N m/(rad/s)^(2/3) |
| r | (chain) | lead / 2 pi; tan(alpha) = 2 r / d_m | m/rad |
| F | (motion) | transmitted force, shared as F = F_A - F_B, neither negative: `parts.screw.double_nut` | N |

A single nut takes F r / eta_a while it drives (F w > 0) and gives F r eta_b while it is driven (F w < 0). The lead
stays as it is: the torque acts on the screw beside the reaction F r of the nut, so power is lost and never created:
T_f >= 0 for every F while f < a_n/b_n, which is 0.37 or more up to lead angles of 45 deg.
Smoothing: tanh at rest, where a static load creeps as with `guide_friction`; T_f changes with the sign of w, where
tanh is 0, so T is continuous. Its slope over F has a corner at F = 0 for a single nut, and none with preload.
`nut_drag` is a drag torque declared as a number, whatever the load; this one follows from f, angles and preload. Where
both are given they add: `nut_drag` then holds only what the preload does not cause (seals, return tubes).
Source: paper 000, eqs. (5)-(7), after Lin (1989); carried on to all quadrants in `feeddrive.parts.screw.double_nut`.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import ClassVar

from feeddrive.effects.base import Motion, Parameter, Signature, forward, number
from feeddrive.effects.friction.shaft_drag import ShaftDrag
from feeddrive.parts.elementary import cosine, sine
from feeddrive.parts.screw.double_nut import friction_torque_backward, friction_torque_forward, rigid_sharing
from feeddrive.parts.screw.screw_efficiency import back_driving_loss, driving_loss
from feeddrive.parts.screw.slip_angle import Groove
from feeddrive.typing import Expression


class NutFriction(ShaftDrag):
    """Load-dependent Coulomb torque and lubricant torque of the nut."""

    name = "nut_friction"
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter("friction_coefficient", "1", 0.0, 0.3, size=0.01),
        Parameter("contact_angle", "rad", math.radians(30), math.radians(80), size=0.1, default=math.pi / 4),
        Parameter("pitch_diameter", "m", 1e-3, 1.0, size=0.01),
        Parameter("preload", "N", 0.0, 1e7, size=1e3, default=0.0),
        Parameter("smoothing_speed", "rad/s", 1e-5, 100.0, size=0.1),
        Parameter("viscous", "N m/(rad/s)^(2/3)", 0.0, size=0.02, default=0.0),
    )
    signature = Signature(
        ("motor_torque", "table_position"), "transmitted force", ("load_dependent_friction", "friction_deviation")
    )
    reads_force = True

    def least_level(self, radius: float) -> float:
        """2 r F_0 l_b [N m]: l_b is the smaller loss, and F_A + F_B is least without load."""
        angle = number(self.values["contact_angle"])
        groove = Groove(2 * radius / number(self.values["pitch_diameter"]), math.sin(angle), math.cos(angle))
        lost = back_driving_loss(groove, number(self.values["friction_coefficient"]))
        return float(2 * radius * number(self.values["preload"]) * lost)

    def level(self, motion: Motion, p: Mapping[str, Expression]) -> Expression:
        """T_f [N m] of the present direction."""
        angle = p["contact_angle"]
        groove = Groove(2 * motion.radius / p["pitch_diameter"], sine(angle), cosine(angle))
        losses = [loss(groove, p["friction_coefficient"]) for loss in (driving_loss, back_driving_loss)]
        loads = rigid_sharing(motion.force, p["preload"])
        ahead = friction_torque_forward(*loads, motion.radius, *losses)
        back = friction_torque_backward(*loads, motion.radius, *losses)
        return back + forward(motion.velocity) * (ahead - back)
