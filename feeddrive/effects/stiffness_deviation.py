"""Combined axial stiffness other than declared.

    k_XS = a k_XS0

| symbol | key | meaning | unit |
|---|---|---|---|
| a | factor | on the declared axial stiffness k_XS0 of bearing, screw and nut in series | 1 |

Source of k_XS: paper 004, eq. (6).
"""

from __future__ import annotations

from collections.abc import Mapping

from feeddrive.effects.base import ChainEffect, Parameter, Port, Signature
from feeddrive.typing import Expression


class StiffnessDeviation(ChainEffect):
    """Factor on the axial stiffness."""

    name = "stiffness_deviation"
    ports = (Port.TRANSMISSION,)
    parameters = (Parameter("factor", "1", 0.05, 20.0, size=0.05),)
    signature = Signature(("table_position", "motor_torque"), "transmitted force", ("stiffness_vs_position",))

    def chain(self, chain: dict[str, Expression], p: Mapping[str, Expression]) -> dict[str, Expression]:
        """The chain with the other stiffness."""
        return {**chain, "axial_stiffness": chain["axial_stiffness"] * p["factor"]}
