"""Transmission that is softer around zero force: the preload of the nut is lost before a flank carries.

    F = y - (1 - a) sat(y, F1 / a),     y = k e,     sat(y, s) = max(-s, min(s, y))

so F = a k e while |F| < F1, and beyond it the slope is k again, F being continuous.

| symbol | key | meaning | unit |
|---|---|---|---|
| a | ratio | stiffness around zero force over the declared one | 1 |
| F1 | force | transmitted force up to which it is soft | N |
| k, e | (chain) | stiffness of the nut's spring, and its stretch beyond any free play | N/m, m |
| y | (law) | force of the declared spring at that stretch | N |

Conservative: its energy is (y^2 / 2 - L) / k, with L the integral of the lost force over y. The damper stays. It
differs from free play in that it always carries: free play is its limit a = 0, which the range leaves out.
Source: a form, two straight lines, for contacts that have lost their preload: few balls carry until a flank is seated.
"""

from __future__ import annotations

from collections.abc import Mapping

import casadi as ca

from feeddrive.effects.base import Parameter, Signature, TransmissionEffect
from feeddrive.typing import Expression


class PreloadLoss(TransmissionEffect):
    """Softer spring around zero force."""

    name = "preload_loss"
    words = "loss of preload"
    headline = ("ratio", "force")
    curve_scale = "force"
    parameters = (
        Parameter("ratio", "1", 0.01, 1.0, size=0.1),
        Parameter("force", "N", 0.0, 1e6, size=50.0),
    )
    signature = Signature(
        ("table_position", "motor_torque"), "transmitted force", ("backlash", "stiffness_deviation", "presliding")
    )

    def lost_force(self, force: Expression, p: Mapping[str, Expression]) -> Expression:
        """What the declared spring's force y [N] loses [N]."""
        return (1 - p["ratio"]) * _within(force, p["force"] / p["ratio"])

    def lost_energy(self, force: Expression, p: Mapping[str, Expression]) -> Expression:
        """L: integral of the lost force over y from 0 [N^2]."""
        soft = _within(force, p["force"] / p["ratio"])
        return (1 - p["ratio"]) * soft * (force - 0.5 * soft)


def _within(force: Expression, limit: Expression) -> Expression:
    return ca.fmax(ca.fmin(force, limit), -limit)
