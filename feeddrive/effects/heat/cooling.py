"""Coolant at the nut from a time on.

    Q = G (θ_nut - θ_c)    for t >= t_0

| symbol | key | meaning | unit |
|---|---|---|---|
| G | conductance | from the nut's outer surface to the coolant | W/K |
| t_0 | start | from the start of the run | s |
| θ_c | | temperature of the coolant: that of the start of the run | degC |

A row in which the coolant starts has the share of G that its time has.
"""

from __future__ import annotations

from collections.abc import Mapping

import casadi as ca

from feeddrive.effects.base import Parameter, Signature
from feeddrive.effects.heat.thermal_effect import Operation, ThermalEffect
from feeddrive.typing import Expression


class Cooling(ThermalEffect):
    """Heat taken from the nut by a coolant."""

    name = "cooling"
    words = "cooling of the nut"
    headline = ("conductance", "start")
    parameters = (
        Parameter("conductance", "W/K", 0.0, 100.0, size=0.1),
        Parameter("start", "s", 0.0, 1e6, size=1000.0, default=0.0),
    )
    signature = Signature(
        ("nut_temperature", "table_growth"), "time and rise of the nut", ("convection_deviation", "heat_sink")
    )

    def coolant_conductance(self, run: Operation, p: Mapping[str, Expression]) -> Expression:
        """Conductance to the coolant [W/K]."""
        share = (run.start + run.step - p["start"]) / run.step
        return p["conductance"] * ca.fmin(ca.fmax(share, 0), 1)
