"""Film coefficients other than declared, at every speed by the same factor.

    h = c h_0

| symbol | key | meaning | unit |
|---|---|---|---|
| c | factor | on the declared film coefficient | 1 |
| | where | "screw", "nut", or "all" (both, and the seats) | |

Source: film coefficients after paper 002, equation (30) and table 3; correlations scatter by 20 % and more.
"""

from __future__ import annotations

from collections.abc import Mapping

from feeddrive.effects.base import Parameter, Signature
from feeddrive.effects.heat.thermal_effect import ThermalEffect
from feeddrive.typing import Expression


class ConvectionDeviation(ThermalEffect):
    """Factor on film coefficients."""

    name = "convection_deviation"
    words = "convection other than declared"
    parameters = (Parameter("factor", "1", 0.02, 50.0, size=0.2),)
    signature = Signature(
        ("nut_temperature", "table_growth"),
        "rise over the surroundings",
        ("cooling", "heat_sink", "contact_conductance_deviation", "preload_growth"),
    )
    place_key = "where"
    places = ("screw", "nut", "all")

    def film_factor(self, film: str, p: Mapping[str, Expression]) -> Expression:
        """Factor on the film of "screw", "nut" or a seat."""
        return p["factor"] if self.place in (film, "all") else 1.0
