"""The linear chain: inertias, stiffnesses and dampers between motor and table.

M q'' + C q' + K q = B u + forces of effects, with r = lead / 2 pi.

Rigid, q = [x]:

    (J / r^2 + m) x'' = T / r + F_c

Three inertias, q = [theta, phi, x]:

    J_m theta'' = T - k_TS (theta - phi) - c_TS (theta' - phi')
    J_s phi''   = k_TS (theta - phi) + c_TS (theta' - phi') - r F
    m x''       = F + F_c,     F = k_XS e + c_XS e',  e = r phi - x

| symbol | meaning | unit |
|---|---|---|
| theta, phi, x | motor angle, screw angle at the nut, table position | rad, rad, m |
| J_m, J_s, m | inertia at the motor, of the screw, table mass | kg m^2, kg m^2, kg |
| k_TS, c_TS | torsional stiffness and damping, motor to screw | N m/rad, N m s/rad |
| k_XS, c_XS | axial stiffness and damping, screw to table | N/m, N s/m |

Source: paper 004, eqs. (6)-(8): the axial and the torsional spring chain act in series on the table.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import casadi as ca

from feeddrive.typing import Expression

Matrix = list[list[Expression]]


def symbolic(matrix: Matrix) -> Expression:
    """The matrix as a CasADi expression."""
    return ca.vertcat(*[ca.horzcat(*row) for row in matrix])


@dataclass(frozen=True)
class ChainValue:
    """A value of the chain: key, section of the plant file, SI unit and whether it may be zero."""

    key: str
    section: str
    unit: str
    may_be_zero: bool = False


@dataclass(frozen=True)
class Chain:
    """A linear chain and its values in SI units.

    Every chain answers the same questions: its coordinates, M, C, K, and how the shaft angles and the table position
    follow from the coordinates.
    """

    structure: ClassVar[str]
    coordinates: ClassVar[tuple[str, ...]]
    required: ClassVar[tuple[ChainValue, ...]]

    values: Mapping[str, float]

    @property
    def radius(self) -> float:
        """r = lead / 2 pi [m/rad]."""
        return self.values["lead"] / (2 * math.pi)

    @property
    def elastic(self) -> bool:
        """Whether the screw can move against the motor and the table against the screw."""
        return len(self.coordinates) > 1

    def mass(self, p: Mapping[str, Expression]) -> Matrix:
        """M for the chain values p."""
        raise NotImplementedError

    def damping(self, p: Mapping[str, Expression]) -> Matrix:
        """C for the chain values p."""
        raise NotImplementedError

    def stiffness(self, p: Mapping[str, Expression]) -> Matrix:
        """K for the chain values p."""
        raise NotImplementedError

    def motor(self, p: Mapping[str, Expression]) -> list[Expression]:
        """Row L with theta = L q."""
        raise NotImplementedError

    def screw(self, p: Mapping[str, Expression]) -> list[Expression]:
        """Row L with phi = L q."""
        raise NotImplementedError

    def table(self, p: Mapping[str, Expression]) -> list[Expression]:
        """Row L with x = L q."""
        raise NotImplementedError


@dataclass(frozen=True)
class Rigid(Chain):
    """One mass: motor, screw and table move together."""

    structure = "rigid"
    coordinates = ("table",)
    required = (
        ChainValue("lead", "ball_screw", "m"),
        ChainValue("motor_inertia", "motor", "kg m^2", may_be_zero=True),
        ChainValue("screw_inertia", "ball_screw", "kg m^2", may_be_zero=True),
        ChainValue("table_mass", "table", "kg"),
    )

    def mass(self, p: Mapping[str, Expression]) -> Matrix:
        r = p["lead"] / (2 * math.pi)
        return [[p["table_mass"] + (p["motor_inertia"] + p["screw_inertia"]) / r**2]]

    def damping(self, p: Mapping[str, Expression]) -> Matrix:
        return [[0.0]]

    def stiffness(self, p: Mapping[str, Expression]) -> Matrix:
        return [[0.0]]

    def motor(self, p: Mapping[str, Expression]) -> list[Expression]:
        return [2 * math.pi / p["lead"]]

    def screw(self, p: Mapping[str, Expression]) -> list[Expression]:
        return self.motor(p)

    def table(self, p: Mapping[str, Expression]) -> list[Expression]:
        return [1.0]


@dataclass(frozen=True)
class ThreeInertias(Chain):
    """Motor, screw and table, joined by the torsional and the axial stiffness."""

    structure = "three_inertias"
    coordinates = ("motor", "screw", "table")
    required = (
        ChainValue("lead", "ball_screw", "m"),
        ChainValue("motor_inertia", "motor", "kg m^2"),
        ChainValue("screw_inertia", "ball_screw", "kg m^2"),
        ChainValue("torsional_stiffness", "transmission", "N m/rad"),
        ChainValue("torsional_damping", "transmission", "N m s/rad", may_be_zero=True),
        ChainValue("axial_stiffness", "transmission", "N/m"),
        ChainValue("axial_damping", "transmission", "N s/m", may_be_zero=True),
        ChainValue("table_mass", "table", "kg"),
    )

    def mass(self, p: Mapping[str, Expression]) -> Matrix:
        return [[p["motor_inertia"], 0.0, 0.0], [0.0, p["screw_inertia"], 0.0], [0.0, 0.0, p["table_mass"]]]

    def damping(self, p: Mapping[str, Expression]) -> Matrix:
        return _series(p["torsional_damping"], p["axial_damping"], p["lead"] / (2 * math.pi))

    def stiffness(self, p: Mapping[str, Expression]) -> Matrix:
        return _series(p["torsional_stiffness"], p["axial_stiffness"], p["lead"] / (2 * math.pi))

    def motor(self, p: Mapping[str, Expression]) -> list[Expression]:
        return [1.0, 0.0, 0.0]

    def screw(self, p: Mapping[str, Expression]) -> list[Expression]:
        return [0.0, 1.0, 0.0]

    def table(self, p: Mapping[str, Expression]) -> list[Expression]:
        return [0.0, 0.0, 1.0]


CHAINS: dict[str, type[Chain]] = {chain.structure: chain for chain in (Rigid, ThreeInertias)}
"""Structure name of plant files to chain."""


def _series(torsional: Expression, axial: Expression, r: Expression) -> Matrix:
    """The matrix of a torsional spring theta-phi and an axial spring r phi - x."""
    return [
        [torsional, -torsional, 0.0],
        [-torsional, torsional + r**2 * axial, -r * axial],
        [0.0, -r * axial, axial],
    ]
