"""The direction switch that direction-dependent effects share."""

from __future__ import annotations

import casadi as ca

from feeddrive.typing import Expression


def forward(velocity: Expression) -> Expression:
    """Share of forward motion, (1 + sign v)/2 with 0 at rest; velocity in m/s.

    It multiplies what vanishes at rest (the shape of the friction law, or the velocity), so the force stays continuous.
    """
    return ca.if_else(velocity > 0, 1, 0)
