"""Stiffness other than declared: of the combined axial spring, or of one part of a drive.

    k = a k_0,     1/k_XS = 1/k_N + 1/k_BS + 1/k_BG

| symbol | key | meaning | unit |
|---|---|---|---|
| a | factor | on the declared stiffness k_0 of the part | 1 |
| | part | "all" (k_XS, where it is left out), "nut", "screw", "bearing", "far_bearing", "drive" | |
| k_N, k_BS, k_BG | (chain) | nut, screw, bearings; known apart, each takes the factor for "all" | N/m |

"drive" is all that gives way between motor and screw: motor shaft, belt or gear, coupling, in series. "screw" is its
axial rigidity. Parts are known apart in a chain with a distributed screw. A recording tells them apart by how their
share of the compliance varies along the stroke: that of nut, near bearing and drive does not where the far end slides,
so that these can stand for one another wherever table position and torque are all that is measured.
Source of k_XS: paper 004, eq. (6).
"""

from __future__ import annotations

from collections.abc import Mapping

from feeddrive.effects.base import ChainEffect, Parameter, Port, Signature
from feeddrive.typing import Expression

PARTS = {
    "nut": "nut_stiffness",
    "screw": "axial_rigidity",
    "bearing": "bearing_stiffness",
    "far_bearing": "far_bearing_stiffness",
    "drive": "drive_stiffness",
}
"""Part to its value in a chain that knows the parts apart."""

ALONG = ("nut", "screw", "bearing", "far_bearing")
"""Parts of which the axial stiffness is in series."""

WHOLE = "all"
"""The combined axial spring."""


class StiffnessDeviation(ChainEffect):
    """Factor on the stiffness of a part, or on the axial stiffness."""

    name = "stiffness_deviation"
    words = "axial stiffness other than declared"
    ports = (Port.TRANSMISSION,)
    parameters = (Parameter("factor", "1", 0.05, 20.0, size=0.05),)
    signature = Signature(("table_position", "motor_torque"), "transmitted force", ("stiffness_vs_position",))
    place_key = "part"
    places = (WHOLE, *PARTS)
    default_place = WHOLE
    repeatable = True
    additive = True

    def chain(self, chain: dict[str, Expression], p: Mapping[str, Expression]) -> dict[str, Expression]:
        """The chain with the other stiffness."""
        if self.place != WHOLE:
            key = PARTS[self.place]
            return {**chain, key: chain[key] * p["factor"]}
        keys = [PARTS[part] for part in ALONG] if "nut_stiffness" in chain else ["axial_stiffness"]
        return {**chain, **{key: chain[key] * p["factor"] for key in keys}}


def parts_of(chain: Mapping[str, float]) -> tuple[str, ...]:
    """Parts whose stiffness a search may ask for: those that the chain knows apart, the screw itself left out.

    The screw's rigidity follows from its diameter, which nobody has to guess.
    """
    if "nut_stiffness" not in chain:
        return (WHOLE,)
    return tuple(part for part, key in PARTS.items() if part != "screw" and chain[key] > 0)
