"""Heat of the motor flowing into the screw's end while it turns.

    Q = P (a + (1 - a) N / N_ref)    while turning, 0 at rest

| symbol | key | meaning | unit |
|---|---|---|---|
| P | power | heat into the motor-side shaft end at N_ref | W |
| N_ref | at_speed | speed at which P is given | rad/s (rev/min in files) |
| a | share_at_rest | share of P that does not depend on the speed | 1 |
| N | | speed of the screw | rad/s |

The heat enters the surface of the front seat. Source: copper and iron losses of a motor as a constant and a part
proportional to speed; paper 002 has no motor.
"""

from __future__ import annotations

from collections.abc import Mapping

import casadi as ca

from feeddrive.effects.base import Parameter, Signature
from feeddrive.effects.heat.thermal_effect import FRONT, Operation, ThermalEffect
from feeddrive.typing import Expression


class MotorHeat(ThermalEffect):
    """Heat into the motor-side end of the shaft."""

    name = "motor_heat"
    words = "heat from the motor"
    headline = ("power", "share_at_rest")
    parameters = (
        Parameter("power", "W", 0.0, 1e4, size=1.0),
        Parameter("at_speed", "rad/s", 1e-3, 1e4, size=75.0),
        Parameter("share_at_rest", "1", 0.0, 1.0, size=0.5, default=0.0),
    )
    signature = Signature(
        ("front_bearing_temperature", "table_growth"), "speed, at the motor-side end", ("bearing_heat", "ambient_drift")
    )

    def heats(self, run: Operation, p: Mapping[str, Expression]) -> dict[str, Expression]:
        """Heat at the front seat [W]."""
        P, N_ref, a = (p[key] for key in ("power", "at_speed", "share_at_rest"))
        return {FRONT: ca.if_else(run.speed > 0, P * (a + (1 - a) * run.speed / N_ref), 0.0)}
