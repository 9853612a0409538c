"""Travel error of the screw that repeats with its angle.

    delta = A sin(n phi + phase)

| symbol | key | meaning | unit |
|---|---|---|---|
| A | amplitude | amplitude; positive moves the nut forward | m |
| n | order | periods per screw revolution | 1 |
| phase | phase | at recorded, unwrapped screw angle 0 | rad |

Conservative: it changes the geometry, and its reaction on the screw is F d(delta)/d(phi).
Source: ISO 3408-3 (travel deviation v_2pi).
"""

from __future__ import annotations

from collections.abc import Mapping

import casadi as ca

from feeddrive.effects.base import Parameter, Signature, TravelEffect
from feeddrive.typing import Expression


class LeadErrorPeriodic(TravelEffect):
    """Periodic travel deviation."""

    name = "lead_error_periodic"
    words = "periodic lead error"
    headline = ("amplitude", "order")
    parameters = (
        Parameter("amplitude", "m", 0.0, 1e-3, size=1e-6),
        Parameter("order", "1", 1e-3, 1e4, size=1.0),
        Parameter("phase", "rad", size=1.0),
    )
    signature = Signature(("table_position",), "screw angle", ("torque_ripple",))
    repeatable = True
    additive = True

    def travel(
        self, angle: Expression, position: Expression, time: Expression, p: Mapping[str, Expression]
    ) -> Expression:
        """Travel deviation [m]."""
        return p["amplitude"] * ca.sin(p["order"] * angle + p["phase"])
