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

import numpy as np

from feeddrive.effects.base import Parameter, Signature, Value
from feeddrive.effects.thermal.base import Operation, ThermalEffect, curve, number
from feeddrive.typing import FloatArray


class AmbientDrift(ThermalEffect):
    """Drift of the surroundings."""

    name = "ambient_drift"
    parameters = (
        Parameter("amplitude", "K", -50.0, 50.0, size=1.0),
        Parameter("period", "s", 60.0, 1e7, size=2e4, default=86400.0),
        Parameter("time", "s", 0.0, 1e7, size=3600.0, default=0.0, table=True),
        Parameter("shape", "1", -1e3, 1e3, size=1.0, default=0.0, table=True),
    )
    signature = Signature(
        ("front_bearing_temperature", "nut_temperature", "table_growth"), "time", ("convection_deviation", "heat_sink")
    )

    def surroundings(self, run: Operation, p: Mapping[str, Value]) -> FloatArray | float:
        """Rise of the surroundings [K]."""
        A, nodes, shape = number(p["amplitude"]), curve(p["time"]), curve(p["shape"])
        if len(nodes) > 1:
            return np.asarray(A * np.interp(run.middle, nodes, shape))
        return np.asarray(A * np.sin(2 * np.pi * run.middle / number(p["period"])))
