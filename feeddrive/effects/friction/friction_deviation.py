"""Declared friction at a port that is other in level, not in form.

    F = a F_coulomb + b F_viscous

| symbol | key | meaning | unit |
|---|---|---|---|
| a | coulomb_factor | factor on every declared Coulomb level of the port | 1 |
| b | viscous_factor | factor on every declared speed-dependent part of the port | 1 |

Dissipative: both factors are positive.
"""

from __future__ import annotations

from collections.abc import Mapping

from feeddrive.effects.base import FrictionEffect, Motion, Parameter, Port, Signature
from feeddrive.typing import Expression


class FrictionDeviation(FrictionEffect):
    """Factors on the declared friction of a port."""

    name = "friction_deviation"
    words = "friction level other than declared"
    headline = ("coulomb_factor", "viscous_factor")
    ports = (Port.TABLE, Port.SCREW)
    parameters = (
        Parameter("coulomb_factor", "1", 0.0, 100.0, size=1.0, default=1.0),
        Parameter("viscous_factor", "1", 0.0, 100.0, size=1.0, default=1.0),
    )
    signature = Signature(
        ("motor_torque", "table_position"), "velocity", ("coulomb_asymmetry", "viscous_warmup", "stribeck")
    )
    repeatable = True
    additive = True

    def level_factor(self, motion: Motion, p: Mapping[str, Expression]) -> Expression:
        """Factor on the Coulomb level."""
        return p["coulomb_factor"]

    def viscous_factor(self, motion: Motion, p: Mapping[str, Expression]) -> Expression:
        """Factor on the speed-dependent part."""
        return p["viscous_factor"]
