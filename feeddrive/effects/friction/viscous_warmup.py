"""Viscous drag that falls while the lubricant warms during the recording.

    Fv = Fv0 (1 - s (1 - exp(-t / tau)))

| symbol | key | meaning | unit |
|---|---|---|---|
| s | share | of the declared viscous drag of the port that is lost in the end | 1 |
| tau | time_constant | of the warming; t counts from the start of the recording | s |

Dissipative: the factor stays above 0 for s <= 1.
"""

from __future__ import annotations

from collections.abc import Mapping

import casadi as ca

from feeddrive.effects.base import FrictionEffect, Motion, Parameter, Port, Signature, number
from feeddrive.typing import Expression


class ViscousWarmup(FrictionEffect):
    """Factor on the viscous drag that falls with time."""

    name = "viscous_warmup"
    words = "viscous drag falling as the lubricant warms"
    headline = ("share", "time_constant")
    ports = (Port.TABLE, Port.SCREW)
    parameters = (
        Parameter("share", "1", -2.0, 1.0, size=0.1),
        Parameter("time_constant", "s", 0.1, 1e6, size=100.0),
    )
    signature = Signature(("motor_torque",), "velocity and time", ("friction_deviation",))
    curve_scale = "time_constant"

    def turning_points(self) -> dict[str, tuple[float, ...]]:
        """Cold, and when the exponential has gone."""
        return {"time": (0.0, 40.0 * number(self.values["time_constant"]))}

    def viscous_factor(self, motion: Motion, p: Mapping[str, Expression]) -> Expression:
        """Factor on the declared viscous drag."""
        return 1 - p["share"] * (1 - ca.exp(-motion.time / p["time_constant"]))
