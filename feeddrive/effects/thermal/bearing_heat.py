"""Friction heat of the support bearings beyond what is declared.

    Q_front = c ω T_b(ω),    Q_rear = s Q_front,    T_b = T_1 + 1e-7 f_0 (ν N)^(2/3) d_m^3   [N mm, mm²/s, rev/min, mm]

| symbol | key | meaning | unit |
|---|---|---|---|
| c | factor | heat over that of the reference bearing | 1 |
| s | rear_share | heat of the rear bearing over that of the front one | 1 |
| ω, N | | speed of the screw | rad/s, rev/min |
| T_1 | | load torque of the reference bearing, 0.539 mN m | N m |
| f_0, ν, d_m | | its viscous factor 3.3 (oil bath), 32 mm²/s, 23.3 mm | |

The reference bearing is the angular contact bearing 7201C of paper 002, whose torques of table 4 these numbers give
(2.2, 3.2 and 4.0 mN m at 250, 500 and 750 rev/min). Another bearing of the kind has the same law of the speed and
another factor: read the heat in watts from the product.
Source: paper 002, equations (15) to (17) and (23); Palmgren's law in `feeddrive.parts.bearing_friction`.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from feeddrive.effects.base import Parameter, Signature, Value
from feeddrive.effects.thermal.base import FRONT, REAR, Operation, ThermalEffect, number
from feeddrive.parts.bearing_friction import viscous_torque
from feeddrive.typing import FloatArray

LOAD_TORQUE = 5.39e-4
"""T_1 of the reference bearing [N m]."""

_VISCOUS_FACTOR, _VISCOSITY, _MEAN_DIAMETER = 3.3, 32e-6, 23.3e-3


class BearingHeat(ThermalEffect):
    """Heat of the bearings at both ends."""

    name = "bearing_heat"
    parameters = (
        Parameter("factor", "1", 0.0, 1e3, size=1.0),
        Parameter("rear_share", "1", 0.0, 10.0, size=0.5, default=1.0),
    )
    signature = Signature(
        ("front_bearing_temperature", "table_growth"), "speed, at both ends", ("motor_heat", "ambient_drift")
    )

    def heats(self, run: Operation, p: Mapping[str, Value]) -> dict[str, FloatArray]:
        """Heat at both seats [W]."""
        front = number(p["factor"]) * reference_heat(run.speed)
        return {FRONT: front, REAR: number(p["rear_share"]) * front}


def reference_heat(speed: FloatArray) -> FloatArray:
    """ω T_b of the reference bearing at speeds (k,) [rad/s], (k,) [W]."""
    distinct, which = np.unique(speed, return_inverse=True)
    torques = [LOAD_TORQUE + viscous_torque(_VISCOUS_FACTOR, _VISCOSITY, float(ω), _MEAN_DIAMETER) for ω in distinct]
    return np.asarray((distinct * np.array(torques))[which])
