"""The smooth direction switch that direction-dependent effects share."""

from __future__ import annotations

import casadi as ca

from feeddrive.typing import Expression

DIRECTION_VELOCITY = 5e-4
"""Velocity over which the direction switches [m/s]; half a millimetre a second is below any feed rate in use."""


def forward(velocity: Expression) -> Expression:
    """Share of forward motion, (1 + sign v)/2, smooth over `DIRECTION_VELOCITY`; velocity in m/s."""
    return 0.5 * (1 + ca.tanh(velocity / DIRECTION_VELOCITY))
