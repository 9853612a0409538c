"""Growth of the screw while it warms during the recording.

    delta = eps (1 - exp(-t / tau)) x

| symbol | key | meaning | unit |
|---|---|---|---|
| eps | strain | final strain; x counts from the fixed end, t from the start of the recording | m/m |
| tau | time_constant | of the approach | s |

Source: paper 002, section 9: strain follows the mean temperature rise of the screw between fixed end and nut.
"""

from __future__ import annotations

from collections.abc import Mapping

import casadi as ca

from feeddrive.effects.base import Parameter, Signature, TravelEffect
from feeddrive.typing import Expression


class ThermalGrowth(TravelEffect):
    """Travel deviation proportional to position that settles with time."""

    name = "thermal_growth"
    words = "thermal growth of the screw"
    headline = ("strain", "time_constant")
    parameters = (
        Parameter("strain", "m/m", -0.01, 0.01, size=1e-5),
        Parameter("time_constant", "s", 0.1, 1e6, size=100.0),
    )
    signature = Signature(("table_position",), "table position and time", ("lead_error_cumulative",))
    curve_scale = "time_constant"

    def travel(
        self, angle: Expression, position: Expression, time: Expression, p: Mapping[str, Expression]
    ) -> Expression:
        """Travel deviation [m]."""
        return p["strain"] * (1 - ca.exp(-time / p["time_constant"])) * position
