"""Axial stiffness that falls along the stroke.

    k(x) = k / (1 + b u + 4 m u (1 - u)),    u = (x - x_l) / (x_h - x_l),    b = a / (1 - a)

| symbol | key | meaning | unit |
|---|---|---|---|
| a | share_over_stroke | share of the stiffness lost from x_l to x_h; negative where it rises | 1 |
| m | middle_compliance | compliance halfway above the straight line of the compliance, over that at x_l | 1 |
| x_l | low | table position where the declared stiffness holds; the low end of the declared stroke if left out | m |
| x_h | high | table position where it is lower by a; the high end of the declared stroke if left out | m |
| k | (chain) | declared stiffness of the nut's spring: the combined axial one of three inertias | N/m |

A screw held at one end is longer by x and gives way by x / (E A) more, 1/k(x) = 1/k_0 + x / (E A): a straight line in
the compliance, so that m = 0, and b from k(x_h) = (1 - a) k. Where both ends are held, both lengths are in parallel and
the sum of their compliances is the same everywhere: (c_1 + x / (E A)) (c_2 - x / (E A)) / (c_1 + c_2) is a parabola, of
which m is the rise and b the straight part. A nut or a torsion in series, whose compliance is a constant or a straight
line, leaves it one. The law is exact for both; `feeddrive lump` writes it.

Both go on beyond x_l and x_h, of which either may be the higher one; between a twentieth and twenty times the declared
stiffness it ends. Conservative: with the spring's energy U(e, k(x)) the table feels -dU/dx as well (0.3 N at 10 kN on
the bench axis). The damper stays. It multiplies with another one. In a chain with a distributed screw, whose axial
stiffness follows from the nut's place already, it acts on the nut's own spring alone. A diagnosis fits
a, and m where that is likelier.
Source: paper 004, eq. (6); two springs in parallel for both ends held.
"""

from __future__ import annotations

from collections.abc import Mapping

import casadi as ca

from feeddrive.effects.base import Parameter, Signature, TransmissionEffect, Value
from feeddrive.errors import InputError
from feeddrive.typing import Expression
from feeddrive.units.quantity import format_quantity

LEAST_FACTOR = 0.05
"""Share of the declared stiffness that is left at least, and its inverse the most: a spring that pushes is none."""


class StiffnessVsPosition(TransmissionEffect):
    """Straight line, or parabola, of the compliance over the stroke."""

    name = "stiffness_vs_position"
    words = "axial stiffness falling along the stroke"
    additive = True
    parameters = (
        Parameter("share_over_stroke", "1", -5.0, 0.95, size=0.1),
        Parameter("middle_compliance", "1", -1.0, 5.0, size=0.1, default=0.0),
        Parameter("low", "m", size=0.1),
        Parameter("high", "m", size=0.5),
    )
    stroke_keys = ("low", "high")
    signature = Signature(
        ("table_position", "motor_torque"), "transmitted force times table position", ("stiffness_deviation",)
    )
    curve_over = "table_position"

    @classmethod
    def complete(cls, values: Mapping[str, Value]) -> dict[str, Value]:
        """Values checked as for every effect, and the ends apart.

        Raises:
            InputError: as `Effect.complete`, or two ends at one place.
        """
        result = super().complete(values)
        if result["low"] == result["high"]:
            place = format_quantity(float(result["low"]), "m")  # type: ignore[arg-type]
            raise InputError(f"a stroke from {place} to {place}", cls.name, "write low and high apart")
        return result

    def stiffness_factor(self, position: Expression, p: Mapping[str, Expression]) -> Expression:
        """k(x) over the declared stiffness."""
        along = (position - p["low"]) / (p["high"] - p["low"])
        straight = p["share_over_stroke"] / (1 - p["share_over_stroke"]) * along
        compliance = 1 + straight + 4 * p["middle_compliance"] * along * (1 - along)
        return 1 / ca.fmin(ca.fmax(compliance, LEAST_FACTOR), 1 / LEAST_FACTOR)
