"""A bristle before break-away, in place of the tanh shape of the port's friction law.

    dz/dt = v (1 - alpha(z, v) s0 z / (level sign v)),   F = s0 z + s1 dz/dt

alpha is 1 without a break-away share (the bristle slips from the start: Dahl, LuGre). With one it is 0 below that
share of the steady deflection or when z and v disagree in sign, 1 in steady sliding, and a smooth step between.

| symbol | key | meaning | unit |
|---|---|---|---|
| s0 | stiffness | bristle stiffness | N/m |
| s1 | damping | bristle damping | N s/m |
| b | break_away | deflection at which slip begins, over the steady one; 0 for none | 1 |
| z | (state) | bristle deflection, 0 at the start | m |

With a break-away share it sticks, and does not drift under vibration; without, it drifts slowly. Dissipative while
s1 <= 4 level / |v| (Barahanov and Ortega); the damping here is small.
Source: Dupont, Hayward, Armstrong, Altpeter, IEEE Trans. Automat. Contr. 47 (2002) 787, eqs. (8)-(12);
Canudas de Wit, Olsson, Astrom, Lischinsky, IEEE Trans. Automat. Contr. 40 (1995) 419.
"""

from __future__ import annotations

from collections.abc import Mapping

import casadi as ca

from feeddrive.effects.base import BristleEffect, Motion, Parameter, Port, Signature
from feeddrive.typing import Expression


class Presliding(BristleEffect):
    """Elasto-plastic bristle."""

    name = "presliding"
    words = "presliding (elastic bristles before break-away)"
    ports = (Port.TABLE,)
    parameters = (
        Parameter("stiffness", "N/m", 1e2, 1e12, size=1e7),
        Parameter("damping", "N s/m", 0.0, 1e8, size=1e3, default=0.0),
        Parameter("break_away", "1", 0.0, 0.98, size=0.1, default=0.0),
    )
    signature = Signature(("table_position", "motor_torque"), "displacement since reversal", ("backlash", "stribeck"))

    def deflection_rate(
        self, z: Expression, motion: Motion, level: Expression, p: Mapping[str, Expression]
    ) -> Expression:
        """Rate of the bristle deflection [m/s]."""
        v = motion.velocity
        share = p["stiffness"] * z / level  # z over its steady-state value, with sign
        return v - _slipping(ca.fabs(share), share * v, p["break_away"]) * ca.fabs(v) * share

    def force(
        self, z: Expression, rate: Expression, motion: Motion, level: Expression, p: Mapping[str, Expression]
    ) -> Expression:
        """Friction force [N]."""
        return p["stiffness"] * z + p["damping"] * rate

    def energy(self, z: Expression, p: Mapping[str, Expression]) -> Expression:
        """s0 z^2 / 2 [J]."""
        return 0.5 * p["stiffness"] * z**2


def _slipping(share: Expression, agreement: Expression, break_away: Expression) -> Expression:
    """alpha: share of the motion that slips, from |z|/z_ss, the sign of z v, and where slip begins."""
    inside = ca.fmin(ca.fmax((share - break_away) / (1 - break_away), 0), 1)
    elastoplastic = ca.if_else(agreement > 0, 0.5 - 0.5 * ca.cos(ca.pi * inside), 0)
    return ca.if_else(break_away > 0, elastoplastic, 1)
