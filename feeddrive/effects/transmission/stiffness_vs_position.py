"""Axial stiffness that falls along the stroke.

    k(x) = k (1 - a (x - x_l) / (x_h - x_l))

| symbol | key | meaning | unit |
|---|---|---|---|
| a | share_over_stroke | share of the stiffness lost over the stroke; negative where it rises | 1 |
| x_l | low | table position where the declared stiffness holds; the low end of the declared stroke if left out | m |
| x_h | high | table position where it is lower by a; the high end of the declared stroke if left out | m |
| k | (chain) | declared stiffness of the nut's spring: the combined axial one of three inertias | N/m |

The line goes on beyond both ends; below a twentieth of the declared stiffness it stays there. Conservative: with the
spring's energy U(e, k(x)) the table feels -dU/dx as well (0.3 N at 10 kN on the bench axis). The damper stays. In a
chain with a distributed screw, whose axial stiffness follows from the nut's place already, it acts on the nut's own
spring alone.
Source: a screw held at one end, 1/k = 1/k_0 + x / (E A) (paper 004, eq. (6)), as a straight line over the stroke.
"""

from __future__ import annotations

from collections.abc import Mapping

import casadi as ca

from feeddrive.effects.base import Parameter, Signature, TransmissionEffect, Value
from feeddrive.errors import InputError
from feeddrive.typing import Expression
from feeddrive.units.quantity import format_quantity

LEAST_FACTOR = 0.05
"""Share of the declared stiffness that is left at least: a spring that pushes is none."""


class StiffnessVsPosition(TransmissionEffect):
    """Straight line of the stiffness over the stroke."""

    name = "stiffness_vs_position"
    parameters = (
        Parameter("share_over_stroke", "1", -5.0, 0.95, size=0.1),
        Parameter("low", "m", size=0.1),
        Parameter("high", "m", size=0.5),
    )
    stroke_keys = ("low", "high")
    signature = Signature(
        ("table_position", "motor_torque"), "transmitted force times table position", ("stiffness_deviation",)
    )

    @classmethod
    def complete(cls, values: Mapping[str, Value]) -> dict[str, Value]:
        """Values checked as for every effect, and the ends in ascending order.

        Raises:
            InputError: as `Effect.complete`, or ends that do not ascend.
        """
        result = super().complete(values)
        low, high = float(result["low"]), float(result["high"])  # type: ignore[arg-type]
        if not high > low:
            ends = f"{format_quantity(low, 'm')} to {format_quantity(high, 'm')}"
            raise InputError(f"a stroke from {ends}", cls.name, "write low below high")
        return result

    def stiffness_factor(self, position: Expression, p: Mapping[str, Expression]) -> Expression:
        """k(x) over the declared stiffness."""
        along = (position - p["low"]) / (p["high"] - p["low"])
        return ca.fmax(1 - p["share_over_stroke"] * along, LEAST_FACTOR)
