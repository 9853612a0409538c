"""Preload, and with it the load torque, growing as the nut warms.

    T_1 = T_1,0 (1 + β ΔT)

| symbol | key | meaning | unit |
|---|---|---|---|
| β | coefficient | rise of the load torque per kelvin | 1/K |
| ΔT | | rise of the nut's surface over the start of the run | K |

The viscous torque is untouched. Source: paper 002, equations (18) to (22); the preload of a double nut rises where the
nut warms more than the screw (`feeddrive.thermal.thermal_coupling`).
"""

from __future__ import annotations

from collections.abc import Mapping

import casadi as ca

from feeddrive.effects.base import Parameter, Signature
from feeddrive.effects.heat.thermal_effect import ThermalEffect
from feeddrive.typing import Expression


class PreloadGrowth(ThermalEffect):
    """Load torque that follows the nut's temperature."""

    name = "preload_growth"
    words = "preload torque growing as the nut warms"
    parameters = (Parameter("coefficient", "1/K", -1.0, 1.0, size=0.01),)
    signature = Signature(
        ("nut_temperature", "table_growth"),
        "speed and rise of the nut",
        ("viscosity_temperature", "convection_deviation"),
    )

    def load_factor(self, rise: Expression, p: Mapping[str, Expression]) -> Expression:
        """Factor on the load torque, not below zero."""
        return ca.fmax(1.0 + p["coefficient"] * rise, 0.0)
