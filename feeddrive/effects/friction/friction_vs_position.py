"""Coulomb level that depends on where the table is.

    level = Fc + peak exp(-((x - centre) / half_width)^2) + table(x)

| symbol | key | meaning | unit |
|---|---|---|---|
| peak | peak | level above the stroke's median, at the centre | N |
| centre | centre | where it is highest (or lowest) | m |
| half_width | half_width | distance at which it has fallen to 1/e | m |
| table | position, delta_force | any further curve, linear between the positions, constant outside | m, N |

Either the bump or the table may be left out. Dissipative while the level stays positive.
Source: rail straightness and preload change along the stroke; no law, a shape.
"""

from __future__ import annotations

from collections.abc import Mapping

import casadi as ca
import numpy as np

from feeddrive.effects.base import FrictionEffect, Motion, Parameter, Port, Signature, listed, number
from feeddrive.typing import Expression


class FrictionVsPosition(FrictionEffect):
    """Coulomb level over the stroke, as a bump, a table, or both."""

    name = "friction_vs_position"
    words = "friction that changes along the stroke"
    headline = ("peak", "centre")
    ports = (Port.TABLE,)
    parameters = (
        Parameter("peak", "N", size=10.0, default=0.0),
        Parameter("centre", "m", size=0.1, default=0.0),
        Parameter("half_width", "m", 1e-6, 10.0, size=0.05, default=1.0),
        Parameter("position", "m", size=0.1, default=0.0, table=True),
        Parameter("delta_force", "N", size=10.0, default=0.0, table=True),
    )
    signature = Signature(("motor_torque", "table_position"), "table_position", ("friction_deviation",))
    curve_scale = "half_width"

    def turning_points(self) -> dict[str, tuple[float, ...]]:
        """The points of the table, the top of the bump, and where it has gone."""
        centre, reach = number(self.values["centre"]), 6.0 * number(self.values["half_width"])
        return {"position": (*listed(self.values["position"]), centre - reach, centre, centre + reach)}

    def level(self, motion: Motion, p: Mapping[str, Expression]) -> Expression:
        """Level that it adds [N]."""
        bump, table = self.level_terms(motion, p)
        return bump + table

    def level_terms(self, motion: Motion, p: Mapping[str, Expression]) -> tuple[Expression, Expression]:
        """Bump and table [N]."""
        x = motion.position
        bump = p["peak"] * ca.exp(-(((x - p["centre"]) / p["half_width"]) ** 2))
        return bump, interpolate(x, p["position"], p["delta_force"])


def interpolate(x: Expression, nodes: Expression, levels: Expression, period: Expression = 0.0) -> Expression:
    """Linear interpolation between nodes, constant outside; nodes ascending, shapes (k,) and (k,).

    With a period the curve comes again after it, and closes. An array is interpolated by NumPy: as an expression every
    stretch between two nodes is one over the whole array.
    """
    if isinstance(x, np.ndarray):
        return np.interp(x, np.ravel(nodes), np.ravel(levels), period=period or None)
    if not hasattr(nodes, "numel") or nodes.numel() == 1:
        return levels
    if not (isinstance(period, float) and period == 0.0):
        x = x - period * ca.floor((x - nodes[0]) / period)
        nodes, levels = ca.vertcat(nodes, nodes[0] + period), ca.vertcat(levels, levels[0])
    result = levels[0]
    for i in range(nodes.numel() - 1):
        slope = (levels[i + 1] - levels[i]) / (nodes[i + 1] - nodes[i])
        result = result + slope * (ca.fmin(ca.fmax(x, nodes[i]), nodes[i + 1]) - nodes[i])
    return result
