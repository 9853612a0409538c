"""Viscous torque of the nut falling as its lubricant warms.

    T_v = T_v,0 exp(-β ΔT)

| symbol | key | meaning | unit |
|---|---|---|---|
| β | coefficient | share of the viscous torque lost per kelvin | 1/K |
| ΔT | | rise of the nut's surface over the start of the run | K |

Source: exponential law of viscosity (Reynolds), T_v with the power 2/3 of the viscosity (paper 002, equation (24)), so
that β is two thirds of the coefficient of the oil, 0.02 to 0.04 per kelvin near room temperature.
"""

from __future__ import annotations

from collections.abc import Mapping

import casadi as ca

from feeddrive.effects.base import Parameter, Signature
from feeddrive.effects.heat.thermal_effect import ThermalEffect
from feeddrive.typing import Expression


class ViscosityTemperature(ThermalEffect):
    """Viscous torque that follows the nut's temperature."""

    name = "viscosity_temperature"
    words = "viscous torque falling with the nut temperature"
    parameters = (Parameter("coefficient", "1/K", 0.0, 1.0, size=0.02),)
    signature = Signature(
        ("nut_temperature", "table_growth"), "speed and rise of the nut", ("preload_growth", "convection_deviation")
    )

    def viscous_factor(self, rise: Expression, p: Mapping[str, Expression]) -> Expression:
        """Factor on the viscous torque."""
        return ca.exp(-ca.fmin(ca.fmax(p["coefficient"] * rise, -50.0), 50.0))
