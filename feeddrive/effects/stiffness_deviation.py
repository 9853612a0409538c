"""Combined axial stiffness other than declared.

    k_XS = a k_XS0,     1/k_XS = 1/k_N + 1/k_BS + 1/k_BG

| symbol | key | meaning | unit |
|---|---|---|---|
| a | factor | on the declared axial stiffness k_XS0 of bearing, screw and nut in series | 1 |
| k_N, k_BS, k_BG | (chain) | nut, screw, bearings; a chain that knows them apart takes the factor on each | N/m |

Source of k_XS: paper 004, eq. (6).
"""

from __future__ import annotations

from collections.abc import Mapping

from feeddrive.effects.base import ChainEffect, Parameter, Port, Signature
from feeddrive.typing import Expression

PARTS = ("nut_stiffness", "axial_rigidity", "bearing_stiffness", "far_bearing_stiffness")
"""What the axial stiffness of a distributed screw is in series of."""


class StiffnessDeviation(ChainEffect):
    """Factor on the axial stiffness."""

    name = "stiffness_deviation"
    ports = (Port.TRANSMISSION,)
    parameters = (Parameter("factor", "1", 0.05, 20.0, size=0.05),)
    signature = Signature(("table_position", "motor_torque"), "transmitted force", ("stiffness_vs_position",))

    def chain(self, chain: dict[str, Expression], p: Mapping[str, Expression]) -> dict[str, Expression]:
        """The chain with the other stiffness."""
        keys = PARTS if "nut_stiffness" in chain else ("axial_stiffness",)
        return {**chain, **{key: chain[key] * p["factor"] for key in keys}}
