"""The linear chain: inertias, springs and dampers between motor and table.

    M q'' + C q' + K q = B u + forces of effects

    K = sum_i k_i w_i' w_i,   C = sum_i c_i w_i' w_i,   s_i = w_i q

Every spring i says by its row w_i how its stretch s_i follows from the coordinates. So K and C are symmetric and never
negative, and what goes beyond the linear chain (free play, a stiffness that varies with the table's position) acts
along the same rows. The first coordinate is the motor angle and the last the table position, but for the rigid chain,
which has the table position alone.

| symbol | meaning | unit |
|---|---|---|
| q | coordinates | rad or m |
| M, C, K | mass, damping, stiffness matrix | kg, N s/m, N/m, and with angles |
| w_i, s_i | row and stretch of spring i | stretch in m, or rad |
| k_i, c_i | its stiffness and damping | N/m, N s/m, or N m/rad, N m s/rad |

A structure whose values depend on where the nut stands (`varies`) answers for a table position; the others ignore it.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import ClassVar

import casadi as ca

from feeddrive.schema.key import bounds, table_rows
from feeddrive.typing import Expression

Row = list[Expression]
Matrix = list[Row]
Values = Mapping[str, Expression]
Hubs = tuple[tuple[float, float], ...]


_PREFIXES = {"motor": "motor_", "ball_screw": "screw_", "table": "table_"}


def symbolic(matrix: Matrix) -> Expression:
    """The matrix as a CasADi expression."""
    return ca.vertcat(*[ca.horzcat(*row) for row in matrix])


def is_travel(coordinate: str) -> bool:
    """Whether a coordinate of a chain is a position [m]; the others are angles [rad]."""
    return coordinate == "table" or "axial" in coordinate


@dataclass(frozen=True)
class ChainValue:
    """A value of the chain.

    Attributes:
        key: among the values of the chain.
        section: of the plant file.
        unit: SI unit.
        may_be_zero: whether it may be.
        written: key in that section, where it is not the key without the section's name before it.
        usual: range in which it is usual [unit], outside of which a slip of the unit is likely; None for that of its
            unit.
        meaning: in a few words, for the reference of plant files and for errors.
    """

    key: str
    section: str
    unit: str
    may_be_zero: bool = False
    written: str = ""
    usual: tuple[float, float] | None = None
    meaning: str = ""

    @property
    def section_key(self) -> str:
        """Key in the section of the plant file: `motor_inertia` is `inertia` in [motor]."""
        return self.written or self.key.removeprefix(_PREFIXES.get(self.section, ""))


def chain_values(table: str) -> tuple[ChainValue, ...]:
    """Values declared in a table, one a line: key | section.key in the plant file | SI unit | range | meaning.

    The range is > 0, or >= 0 where the value may be zero, and what is usual (`feeddrive.schema.key`).
    """
    return tuple(_chain_value(*cells) for cells in table_rows(table))


def _chain_value(key: str, place: str, unit: str, ends: str, meaning: str) -> ChainValue:
    found, (section, written) = bounds(ends), place.split(".")
    assert found is not None, ends
    plain = ChainValue(key, section, unit, not found.open_ends, usual=found.usual, meaning=meaning)
    return plain if plain.section_key == written else replace(plain, written=written)


LEAD, MOTOR_INERTIA, SCREW_INERTIA, RATIO, TABLE_MASS = chain_values("""
lead | ball_screw.lead | m | > 0 usual 5e-4 to 0.2 | table travel per turn of the screw
motor_inertia | motor.inertia | kg m^2 | > 0 usual 1e-8 to 10 | inertia at the motor: rotor and coupling
screw_inertia | ball_screw.inertia | kg m^2 | > 0 usual 1e-8 to 10 | inertia that turns with the screw
ratio | transmission.ratio | 1 | > 0 | turns of the motor per turn of the screw; 1 where it is direct
table_mass | table.mass | kg | > 0 usual 0.2 to 1e5 | mass that moves with the table
""")
"""Values that several structures of a chain share."""


@dataclass(frozen=True)
class Spring:
    """A spring with a damper beside it.

    Attributes:
        name: of the part.
        row: w with stretch s = w q [m or rad]; the same at every table position.
        stiffness: [N/m, or N m/rad].
        damping: [N s/m, or N m s/rad].
    """

    name: str
    row: Row
    stiffness: Expression
    damping: Expression


@dataclass(frozen=True)
class Chain:
    """A linear chain and its values in SI units.

    Every chain answers the same questions: its coordinates, its springs, M, C, K at a table position, and how the
    shaft angles and the table position follow from the coordinates. Values are numbers or CasADi expressions, and so
    is the table position [m].
    """

    structure: ClassVar[str]
    required: ClassVar[tuple[ChainValue, ...]]
    optional: ClassVar[tuple[ChainValue, ...]] = ()
    varies: ClassVar[bool] = False

    values: Mapping[str, float]

    @property
    def coordinates(self) -> tuple[str, ...]:
        """Names of q."""
        raise NotImplementedError

    @property
    def known_values(self) -> tuple[ChainValue, ...]:
        """The required values, and those of the optional ones that are given."""
        return (*self.required, *(value for value in self.optional if value.key in self.values))

    @property
    def key(self) -> tuple[object, ...]:
        """What makes two chains the same equations: equal keys differ in values alone."""
        return (self.structure,)

    @property
    def radius(self) -> float:
        """r = lead / 2 pi: table travel per screw angle [m/rad]."""
        return self.values["lead"] / (2 * math.pi)

    @property
    def motor_radius(self) -> float:
        """Table travel per motor angle [m/rad]; `radius` over the ratio of a gear."""
        row = self.motor(self.values)
        return 1.0 / math.fsum(float(a) * float(b) for a, b in zip(row, self.rigid_motion(self.values), strict=True))

    @property
    def elastic(self) -> bool:
        """Whether the screw can move against the motor and the table against the screw."""
        return len(self.coordinates) > 1

    @property
    def without_modes(self) -> Chain:
        """The chain without further masses on its table."""
        return self

    @property
    def nut_at_zero(self) -> float:
        """Place of the nut from the near bearing with the table at 0 [m]; 0 where nothing depends on it."""
        return 0.0

    def nut_moved(self, way: float) -> Mapping[str, float]:
        """Values with the nut a way further along the screw [m]."""
        return self.values

    def nut_softened(self, share: float, stiffness: float) -> Mapping[str, float]:
        """Values with the nut's stiffness times a share [1]; `stiffness` [N/m] counts where it is known in series."""
        return self.values

    def positions_on_screw(self) -> tuple[float, float]:
        """Table positions [m] between which the nut is on the screw; any, where the chain does not know its ends."""
        return -math.inf, math.inf

    def refuse_off_screw(self, position: float, where: str) -> None:
        """Refuse a table position [m] at which the nut would not be on the screw; any other chain takes all.

        Raises:
            InputError: the nut would not be on the screw.
        """

    def springs(self, p: Values, position: Expression = 0.0) -> tuple[Spring, ...]:
        """The springs for the chain values p with the table at `position`; none in a rigid chain."""
        raise NotImplementedError

    def nut(self, p: Values) -> Spring:
        """The spring of the transmission, on whose stretch e and force F travel errors and free play act.

        Its row holds e = r phi - x, less what the screw gives way; F = k e + c e' pushes the table along +. It is the
        last of the springs.

        Raises:
            NotImplementedError: a rigid chain, whose transmitted force is not defined.
        """
        raise NotImplementedError

    def mass(self, p: Values, position: Expression = 0.0) -> Matrix:
        """M for the chain values p with the table at `position` [m]."""
        raise NotImplementedError

    def moving_mass(self, p: Values) -> Expression:
        """All that moves with the table [kg]."""
        return p["table_mass"]

    def damping(self, p: Values, position: Expression = 0.0) -> Matrix:
        """C for the chain values p with the table at `position` [m]."""
        springs = self.springs(p, position)
        return _along_rows(len(self.coordinates), [(spring.row, spring.damping) for spring in springs])

    def stiffness(self, p: Values, position: Expression = 0.0) -> Matrix:
        """K for the chain values p with the table at `position` [m]."""
        springs = self.springs(p, position)
        return _along_rows(len(self.coordinates), [(spring.row, spring.stiffness) for spring in springs])

    def motor(self, p: Values) -> Row:
        """Row L with theta = L q."""
        raise NotImplementedError

    def screw(self, p: Values) -> Row:
        """Row L with phi = L q, the screw angle at the nut."""
        raise NotImplementedError

    def table(self, p: Values) -> Row:
        """Row L with x = L q."""
        return [0.0] * (len(self.coordinates) - 1) + [1.0]

    def rigid_motion(self, p: Values) -> Row:
        """Column G with q = G x where nothing is stretched."""
        raise NotImplementedError


def _along_rows(size: int, springs: list[tuple[Row, Expression]]) -> Matrix:
    """sum of value row' row."""
    matrix: Matrix = [[0.0] * size for _ in range(size)]
    for row, value in springs:
        touched = [(i, entry) for i, entry in enumerate(row) if not (isinstance(entry, int | float) and entry == 0)]
        for i, left in touched:
            for j, right in touched:
                matrix[i][j] += left * right * value
    return matrix
