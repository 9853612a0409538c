"""A mass on the nut that takes heat from it: housing, bracket or table.

    C dθ_s/dt = G (θ_nut - θ_s)

| symbol | key | meaning | unit |
|---|---|---|---|
| G | conductance | from the nut's outer surface to the mass | W/K |
| C | capacity | of the mass | J/K |
| θ_s | | temperature of the mass, cold at the start; it loses no heat to the air | degC |
"""

from __future__ import annotations

from collections.abc import Mapping

from feeddrive.effects.base import Parameter, Signature
from feeddrive.effects.heat.thermal_effect import ThermalEffect
from feeddrive.typing import Expression


class HeatSink(ThermalEffect):
    """A body on the nut."""

    name = "heat_sink"
    words = "attached mass taking heat from the nut"
    headline = ("conductance", "capacity")
    parameters = (
        Parameter("conductance", "W/K", 0.0, 1e3, size=0.1),
        Parameter("capacity", "J/K", 1e-3, 1e7, size=300.0),
    )
    signature = Signature(
        ("nut_temperature", "table_growth"), "time and rise of the nut", ("convection_deviation", "cooling")
    )

    def attached(self, p: Mapping[str, Expression]) -> tuple[Expression, Expression] | None:
        """Conductance and capacity."""
        return p["conductance"], p["capacity"]
