"""A chain with a further mass on the table: one coordinate more, the mass's deflection d against the table.

    s = d,     kinetic energy m (x' + d')^2 / 2:   M_xx + m,  M_xd = M_dx = M_dd = m,     k = m w^2,  c = 2 zeta m w

| symbol | key | meaning | unit |
|---|---|---|---|
| m | LABEL.mass | of what swings; the table's own mass stays | kg |
| w / 2 pi | LABEL.frequency | of the mass with the table held | Hz |
| zeta | LABEL.damping | its damping ratio with the table held | 1 |

LABEL is that of the effect `structural_mode` whose values these are. The deflection and not the place of the mass is
the coordinate: nanometres beside metres lose no digits, and it is zero wherever nothing is stretched. It stands before
the table, which stays the last.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from feeddrive.plant.chain.linear_chain import Chain, Matrix, Row, Spring, Values
from feeddrive.typing import Expression


@dataclass(frozen=True)
class TableMode(Chain):
    """A chain that carries a mass on a spring on its table.

    Attributes:
        carrier: chain without it; its values are those of this one.
        label: of the mode, and the name of its coordinate.
    """

    carrier: Chain
    label: str

    @property
    def structure(self) -> str:  # type: ignore[override]
        return self.carrier.structure

    @property
    def required(self) -> tuple[object, ...]:  # type: ignore[override]
        return self.carrier.required

    @property
    def optional(self) -> tuple[object, ...]:  # type: ignore[override]
        return self.carrier.optional

    @property
    def varies(self) -> bool:  # type: ignore[override]
        return self.carrier.varies

    @property
    def without_modes(self) -> Chain:
        return replace(self.carrier, values=self.values).without_modes

    @property
    def coordinates(self) -> tuple[str, ...]:
        return (*self.carrier.coordinates[:-1], self.label, self.carrier.coordinates[-1])

    @property
    def key(self) -> tuple[object, ...]:
        return (*self.carrier.key, self.label)

    @property
    def nut_at_zero(self) -> float:
        return self.without_modes.nut_at_zero

    def nut_moved(self, way: float) -> Mapping[str, float]:
        return self.without_modes.nut_moved(way)

    def nut_softened(self, share: float, stiffness: float) -> Mapping[str, float]:
        return self.without_modes.nut_softened(share, stiffness)

    def refuse_off_screw(self, position: float, where: str) -> None:
        self.without_modes.refuse_off_screw(position, where)

    def springs(self, p: Values, position: Expression = 0.0) -> tuple[Spring, ...]:
        *others, _ = self.carrier.springs(p, position)
        mass, rate = p[f"{self.label}.mass"], 2 * math.pi * p[f"{self.label}.frequency"]
        row = self._widened([0.0] * len(self.carrier.coordinates), 1.0)
        own = Spring(self.label, row, mass * rate**2, 2 * p[f"{self.label}.damping"] * mass * rate)
        return (*(self._lengthened(spring) for spring in others), own, self.nut(p))

    def nut(self, p: Values) -> Spring:
        return self._lengthened(self.carrier.nut(p))

    def mass(self, p: Values, position: Expression = 0.0) -> Matrix:
        matrix = [self._widened(row) for row in self.carrier.mass(p, position)]
        matrix.insert(len(matrix) - 1, self._widened([0.0] * len(matrix)))
        own = p[f"{self.label}.mass"]
        for i, j in ((-2, -2), (-2, -1), (-1, -2), (-1, -1)):
            matrix[i][j] += own
        return matrix

    def moving_mass(self, p: Values) -> Expression:
        return self.carrier.moving_mass(p) + p[f"{self.label}.mass"]

    def motor(self, p: Values) -> Row:
        return self._widened(self.carrier.motor(p))

    def screw(self, p: Values) -> Row:
        return self._widened(self.carrier.screw(p))

    def rigid_motion(self, p: Values) -> Row:
        return self._widened(self.carrier.rigid_motion(p))

    def _lengthened(self, spring: Spring) -> Spring:
        return replace(spring, row=self._widened(spring.row))

    @staticmethod
    def _widened(row: Row, entry: Expression = 0.0) -> Row:
        """The row with the entry of the mode's coordinate."""
        return [*row[:-1], entry, row[-1]]


def with_modes(chain: Chain, labels: Sequence[str]) -> Chain:
    """The chain with exactly these modes on its table, in this order."""
    result = chain.without_modes
    for label in labels:
        result = TableMode(result.values, result, label)
    return result
