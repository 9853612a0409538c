"""Growth of the machine's frame under the scale.

    δ = (u + s x) (1 - exp(-t / τ))

| symbol | key | meaning | unit |
|---|---|---|---|
| u | growth | final growth that is the same at every position | m |
| s | slope | final growth per length from the screw's fixed end | m/m |
| τ | time_constant | of the approach, from the start of the run | s |
| x | | position of the nut from the fixed end | m |

It is counted as the recorded growth is: positive where the table's position is read larger. Temperatures do not see it.
"""

from __future__ import annotations

from collections.abc import Mapping

import casadi as ca

from feeddrive.effects.base import Parameter, Signature
from feeddrive.effects.heat.thermal_effect import ThermalEffect
from feeddrive.typing import Expression


class StructureGrowth(ThermalEffect):
    """Growth that the screw does not show."""

    name = "structure_growth"
    words = "growth of the machine frame under the scale"
    parameters = (
        Parameter("growth", "m", -0.01, 0.01, size=1e-6, default=0.0),
        Parameter("slope", "m/m", -0.01, 0.01, size=1e-5, default=0.0),
        Parameter("time_constant", "s", 1.0, 1e7, size=3600.0),
    )
    signature = Signature(("table_growth",), "time and position, no temperature", ("ambient_drift",))

    def growth(self, position: Expression, time: Expression, p: Mapping[str, Expression]) -> Expression:
        """Growth at a position [m]."""
        return (p["growth"] + p.get("slope", 0.0) * position) * (1 - ca.exp(-time / p["time_constant"]))
