"""A further resonance on the table: a mass that swings on it.

    m (x'' + d'') = -k d - c d',     M x'' = F + k d + c d',     k = m w^2,  c = 2 zeta m w,  w = 2 pi f

| symbol | key | meaning | unit |
|---|---|---|---|
| m | mass | of what swings, beyond the table's own mass M, which stays | kg |
| f | frequency | of that mass with the table held | Hz |
| zeta | damping | its damping ratio with the table held | 1 |
| d | (coordinate) | deflection of that mass against the table | m |
| x, F | (chain) | table, where the scale reads it; force of the transmission | m, N |

Far below f it is a payload of the same mass, which is its limit as f grows: what swings beyond the band is found as a
payload. Chain kind; it adds the coordinate d before the table's. Conservative spring, dissipative damper. The table
must be one that the transmission can move, so a rigid structure cannot hold it.
Source: Newton's law of both masses.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

from feeddrive.effects.base import ChainEffect, Effect, Parameter, Port, Signature, number
from feeddrive.typing import Expression


class StructuralMode(ChainEffect):
    """A mass on a spring on the table."""

    name = "structural_mode"
    words = "structural resonance on the table"
    headline = ("mass", "frequency")
    ports = (Port.TABLE,)
    parameters = (
        Parameter("mass", "kg", 1e-6, 1e6, size=10.0),
        Parameter("frequency", "Hz", 0.1, 1e5, size=10.0),
        Parameter("damping", "1", 0.0, 2.0, size=0.01),
    )
    signature = Signature(("motor_torque", "table_position"), "table acceleration, by frequency", ("payload",))
    additive = True
    adds_coordinate = True

    def chain(self, chain: dict[str, Expression], p: Mapping[str, Expression]) -> dict[str, Expression]:
        """The chain's values with those of the mode, under its label; see `feeddrive.plant.chain.table_mode`."""
        return {**chain, **{f"{self.label}.{key}": p[key] for key in ("mass", "frequency", "damping")}}


NO_PEAK = math.sqrt(0.5)
"""Damping ratio from which |1 / (1 - r^2 + 2 i zeta r)|, r the frequency over f, falls from r = 0 on."""


def resonates_within(mode: Effect, edge: float) -> bool:
    """Whether a mode resonates below a frequency [Hz]; braked so that it has no peak it is a payload that lags."""
    return number(mode.values["frequency"]) < edge and number(mode.values["damping"]) < NO_PEAK
