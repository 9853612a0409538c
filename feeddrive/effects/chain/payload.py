"""Moving mass other than declared.

    M = M0 + m

| symbol | key | meaning | unit |
|---|---|---|---|
| m | mass | mass on the table beyond the declared one | kg |
"""

from __future__ import annotations

from collections.abc import Mapping

from feeddrive.effects.base import ChainEffect, Parameter, Port, Signature
from feeddrive.typing import Expression


class Payload(ChainEffect):
    """Mass added to the table."""

    name = "payload"
    words = "moving mass other than declared"
    ports = (Port.TABLE,)
    parameters = (Parameter("mass", "kg", size=10.0),)
    signature = Signature(
        ("motor_torque", "table_position"), "table acceleration", ("inertia_deviation", "structural_mode")
    )
    additive = True

    def chain(self, chain: dict[str, Expression], p: Mapping[str, Expression]) -> dict[str, Expression]:
        """The chain with the mass on the table."""
        return {**chain, "table_mass": chain["table_mass"] + p["mass"]}
