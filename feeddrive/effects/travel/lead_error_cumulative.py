"""Travel deviation that grows with the distance from the screw's fixed end: lead off its nominal value.

    delta = s x

| symbol | key | meaning | unit |
|---|---|---|---|
| s | slope | travel beyond the nominal one per length; x counts from the fixed end | m/m |

Source: ISO 3408-3 (mean travel deviation e_0a).
"""

from __future__ import annotations

from collections.abc import Mapping

from feeddrive.effects.base import Parameter, Signature, TravelEffect
from feeddrive.typing import Expression


class LeadErrorCumulative(TravelEffect):
    """Travel deviation proportional to position."""

    name = "lead_error_cumulative"
    words = "cumulative lead error"
    parameters = (Parameter("slope", "m/m", -0.01, 0.01, size=1e-5),)
    signature = Signature(("table_position",), "table position", ("thermal_growth",))
    curve_over = "table_position"

    def travel(
        self, angle: Expression, position: Expression, time: Expression, p: Mapping[str, Expression]
    ) -> Expression:
        """Travel deviation [m]."""
        return p["slope"] * position
