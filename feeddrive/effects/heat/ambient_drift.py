"""Surroundings other than recorded, as a curve over the time from the start of the run.

    Δθ = A sin(2π t / T)        or, where a table is given,    Δθ = A s(t), s from straight lines between its nodes

| symbol | key | meaning | unit |
|---|---|---|---|
| A | amplitude | size of the drift; with a table the value at its s = ±1 | K |
| T | period | of the sine | s |
| t_i, s_i | time, shape | nodes of the table, the last one held; empty lists for the sine | s, 1 |

The drift is that of the air around screw and nut, and starts from zero: the machine is cold at what is recorded.
"""

from __future__ import annotations

from collections.abc import Mapping

import casadi as ca

from feeddrive.effects.base import Parameter, Signature
from feeddrive.effects.heat.thermal_effect import Operation, ThermalEffect
from feeddrive.typing import Expression


class AmbientDrift(ThermalEffect):
    """Drift of the surroundings."""

    name = "ambient_drift"
    words = "surroundings other than recorded"
    headline = ("amplitude",)
    parameters = (
        Parameter("amplitude", "K", -50.0, 50.0, size=1.0),
        Parameter("period", "s", 60.0, 1e7, size=2e4, default=86400.0),
        Parameter("time", "s", 0.0, 1e7, size=3600.0, default=0.0, table=True),
        Parameter("shape", "1", -1e3, 1e3, size=1.0, default=0.0, table=True),
    )
    signature = Signature(
        ("front_bearing_temperature", "nut_temperature", "table_growth"), "time", ("convection_deviation", "heat_sink")
    )

    def surroundings(self, run: Operation, p: Mapping[str, Expression]) -> Expression:
        """Rise of the surroundings [K]."""
        if isinstance(self.values["time"], tuple) and len(self.values["time"]) > 1:
            return p["amplitude"] * _straight(run.middle, p["time"], p["shape"])
        return p["amplitude"] * ca.sin(2 * ca.pi * run.middle / p["period"])


def _straight(time: Expression, nodes: Expression, values: Expression) -> Expression:
    """Straight lines between nodes, (k, 1) each, the last one held."""
    shown = values[0]
    for i in range(nodes.numel() - 1):
        share = (time - nodes[i]) / (nodes[i + 1] - nodes[i])
        shown += (values[i + 1] - values[i]) * ca.fmin(ca.fmax(share, 0), 1)
    return shown
