"""The chains that know no position: one mass, and three inertias.

Rigid, q = [x]:

    (J / r^2 + m) x'' = T / r + F_c

Three inertias, q = [theta, phi, x]:

    J_m theta'' = T - (k_TS (theta / i - phi) + c_TS (theta' / i - phi')) / i
    J_s phi''   = k_TS (theta / i - phi) + c_TS (theta' / i - phi') - r F
    m x''       = F + F_c,     F = k_XS e + c_XS e',  e = r phi - x

| symbol | meaning | unit |
|---|---|---|
| theta, phi, x | motor angle, screw angle at the nut, table position | rad, rad, m |
| J_m, J_s, m | inertia at the motor, of the screw, table mass | kg m^2, kg m^2, kg |
| i | motor turns per screw turn; 1 where it is not given | 1 |
| k_TS, c_TS | torsional stiffness and damping, motor to screw, at the screw | N m/rad, N m s/rad |
| k_XS, c_XS | axial stiffness and damping, screw to table | N/m, N s/m |
| r | lead / 2 pi | m/rad |

Source: paper 004, eqs. (6)-(8): the axial and the torsional spring chain act in series on the table.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

from feeddrive.plant.chain.linear_chain import (
    LEAD,
    MOTOR_INERTIA,
    RATIO,
    SCREW_INERTIA,
    TABLE_MASS,
    Chain,
    Matrix,
    Row,
    Spring,
    Values,
    chain_values,
)
from feeddrive.typing import Expression


@dataclass(frozen=True)
class Rigid(Chain):
    """One mass: motor, screw and table move together."""

    structure = "rigid"
    required = (
        LEAD,
        replace(MOTOR_INERTIA, may_be_zero=True),
        replace(SCREW_INERTIA, may_be_zero=True),
        TABLE_MASS,
    )

    @property
    def coordinates(self) -> tuple[str, ...]:
        return ("table",)

    def springs(self, p: Values, position: Expression = 0.0) -> tuple[Spring, ...]:
        return ()

    def mass(self, p: Values, position: Expression = 0.0) -> Matrix:
        r = p["lead"] / (2 * math.pi)
        return [[p["table_mass"] + (p["motor_inertia"] + p["screw_inertia"]) / r**2]]

    def motor(self, p: Values) -> Row:
        return [2 * math.pi / p["lead"]]

    def screw(self, p: Values) -> Row:
        return self.motor(p)

    def rigid_motion(self, p: Values) -> Row:
        return [1.0]


@dataclass(frozen=True)
class ThreeInertias(Chain):
    """Motor, screw and table, joined by the torsional and the axial stiffness."""

    structure = "three_inertias"
    required = (
        LEAD,
        MOTOR_INERTIA,
        SCREW_INERTIA,
        *chain_values("""
torsional_stiffness | transmission.torsional_stiffness | N m/rad | > 0 usual 1 to 1e8 | torsional stiffness from \
motor to nut, at the screw
torsional_damping | transmission.torsional_damping | N m s/rad | >= 0 | damping beside the torsional stiffness
axial_stiffness | transmission.axial_stiffness | N/m | > 0 usual 1e5 to 1e11 | axial stiffness of bearing, screw and \
nut in series
axial_damping | transmission.axial_damping | N s/m | >= 0 | damping beside the axial stiffness
"""),
        TABLE_MASS,
    )

    optional = (RATIO,)

    def nut_softened(self, share: float, stiffness: float) -> Mapping[str, float]:
        softer = 1 / (1 / self.values["axial_stiffness"] + (1 / share - 1) / stiffness)
        return {**self.values, "axial_stiffness": softer}

    @property
    def coordinates(self) -> tuple[str, ...]:
        return ("motor", "screw", "table")

    def springs(self, p: Values, position: Expression = 0.0) -> tuple[Spring, ...]:
        torsion = Spring(
            "torsion", [1.0 / p.get("ratio", 1.0), -1.0, 0.0], p["torsional_stiffness"], p["torsional_damping"]
        )
        return (torsion, self.nut(p))

    def nut(self, p: Values) -> Spring:
        r = p["lead"] / (2 * math.pi)
        return Spring("axial", [0.0, r, -1.0], p["axial_stiffness"], p["axial_damping"])

    def mass(self, p: Values, position: Expression = 0.0) -> Matrix:
        return [[p["motor_inertia"], 0.0, 0.0], [0.0, p["screw_inertia"], 0.0], [0.0, 0.0, p["table_mass"]]]

    def motor(self, p: Values) -> Row:
        return [1.0, 0.0, 0.0]

    def screw(self, p: Values) -> Row:
        return [0.0, 1.0, 0.0]

    def rigid_motion(self, p: Values) -> Row:
        r = p["lead"] / (2 * math.pi)
        return [p.get("ratio", 1.0) / r, 1 / r, 1.0]
