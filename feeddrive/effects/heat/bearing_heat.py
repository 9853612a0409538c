"""Friction heat of the support bearings beyond what is declared.

    Q_front = c ω T_b(ω),    Q_rear = s Q_front

| symbol | key | meaning | unit |
|---|---|---|---|
| c | factor | heat over that of the machine's front bearing | 1 |
| s | rear_share | heat of the rear bearing over that of the front one | 1 |
| ω | | speed of the screw | rad/s |
| T_b | | torque of the front bearing as the plant declares it in `[thermal.front_bearing]` | N m |

A plant that declares no bearing gets a small one in its place, the angular contact bearing 7201C of paper 002, table 4
(2.2, 3.2 and 4.0 mN m at 250, 500 and 750 rev/min): read the heat in watts from the product.
Source: paper 002, equations (15) to (17) and (23); Palmgren's law in `feeddrive.parts.bearings.bearing_friction`.
"""

from __future__ import annotations

from collections.abc import Mapping

from feeddrive.effects.base import Parameter, Signature
from feeddrive.effects.heat.thermal_effect import FRONT, REAR, Operation, ThermalEffect
from feeddrive.parts.bearings.bearing_friction import palmgren_torque
from feeddrive.typing import Expression

LOAD_TORQUE = 5.39e-4
"""T_1 of the reference bearing [N m]."""

_VISCOUS_FACTOR, _VISCOSITY, _MEAN_DIAMETER = 3.3, 32e-6, 23.3e-3
"""Its f_0 in an oil bath [1], oil [m²/s] and mean diameter [m]."""


class BearingHeat(ThermalEffect):
    """Heat of the bearings at both ends."""

    name = "bearing_heat"
    words = "heat from the bearings"
    headline = ("factor", "rear_share")
    parameters = (
        Parameter("factor", "1", 0.0, 1e3, size=1.0),
        Parameter("rear_share", "1", 0.0, 10.0, size=0.5, default=1.0),
    )
    signature = Signature(
        ("front_bearing_temperature", "table_growth"), "speed, at both ends", ("motor_heat", "ambient_drift")
    )

    def heats(self, run: Operation, p: Mapping[str, Expression]) -> dict[str, Expression]:
        """Heat at both seats [W]."""
        front = p["factor"] * run.speed * run.bearing
        return {FRONT: front, REAR: p["rear_share"] * front}


def reference_torque(speed: Expression) -> Expression:
    """Friction torque of the reference bearing at a speed, not negative [rad/s], [N m]."""
    return LOAD_TORQUE + palmgren_torque(_VISCOUS_FACTOR, _VISCOSITY, speed, _MEAN_DIAMETER)
