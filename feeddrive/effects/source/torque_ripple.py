"""Torque ripple of the motor, locked to its angle.

    T = A sin(n theta + phase)

| symbol | key | meaning | unit |
|---|---|---|---|
| A | amplitude | amplitude; resists + motion where the sine is positive | N m |
| n | order | periods per motor revolution | 1 |
| phase | phase | at recorded, unwrapped motor angle 0 | rad |

Conservative: its energy is -A cos(n theta + phase) / n.
Source: Jahns and Soong, IEEE Trans. Ind. Electron. 43 (1996) 321.
"""

from __future__ import annotations

from collections.abc import Mapping

import casadi as ca
import numpy as np

from feeddrive.effects.base import Motion, Parameter, Port, Signature, SourceEffect
from feeddrive.typing import Expression


class TorqueRipple(SourceEffect):
    """Sinusoidal torque over the motor angle."""

    name = "torque_ripple"
    words = "torque ripple of the motor"
    headline = ("amplitude", "order")
    ports = (Port.MOTOR,)
    parameters = (
        Parameter("amplitude", "N m", 0.0, size=0.05),
        Parameter("order", "1", 1e-3, 1e4, size=1.0),
        Parameter("phase", "rad", size=1.0),
    )
    signature = Signature(("motor_torque",), "motor_angle", ("lead_error_periodic",))
    repeatable = True
    additive = True

    def force(self, motion: Motion, p: Mapping[str, Expression]) -> Expression:
        """Resisting torque [N m]."""
        angle = p["order"] * motion.position + p["phase"]
        # of numbers by numpy, ten times as fast as by CasADi's own matrices
        return p["amplitude"] * (np.sin(angle) if isinstance(angle, np.ndarray) else ca.sin(angle))
