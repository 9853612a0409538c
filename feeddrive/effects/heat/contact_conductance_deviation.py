"""Contact conductance between nut and screw other than declared.

    g = c g_0

| symbol | key | meaning | unit |
|---|---|---|---|
| c | factor | on the declared contact conductance | 1 |

Source: paper 002, equations (11), (12) and table 5: it follows the load, and is known to a factor at best.
"""

from __future__ import annotations

from collections.abc import Mapping

from feeddrive.effects.base import Parameter, Signature
from feeddrive.effects.heat.thermal_effect import ThermalEffect
from feeddrive.typing import Expression


class ContactConductanceDeviation(ThermalEffect):
    """Factor on the contact conductance."""

    name = "contact_conductance_deviation"
    words = "nut to screw contact other than declared"
    parameters = (Parameter("factor", "1", 0.02, 50.0, size=0.2),)
    signature = Signature(
        ("nut_temperature", "table_growth"), "difference of nut and screw", ("convection_deviation", "heat_sink")
    )

    def contact_factor(self, p: Mapping[str, Expression]) -> Expression:
        """Factor on the contact conductance."""
        return p["factor"]
