"""The chain with a distributed screw: stiffness and inertia follow from where the nut stands.

    F = k_N e + c_N e',  e = r pn + u - x
    m x''   = F + F_c
    m_u u'' = -F - k_ax u - c_ax u',  k_ax = k_1 + k_2
    J_n pn'' = -r F - k_t (pn - p1) - k_o (pn - pe) - c(...)
    J_e pe'' = k_o (pn - pe) + c(...)
    J_1 p1'' = k_t (pn - p1) - k_d (p1 - thm / i) + c(...)
    J_m thm'' = T + k_d (p1 - thm / i) / i + c(...),   and J_h couples: M(thm, p1) = J_h / i

with the nut at z = z_0 + x from the bearing at the motor's end, the coupling at z = -d, the far bearing at z = S and
the end of the screw at z = L:

    k_1 = EA k_b1 / (EA + k_b1 z),  k_2 = EA k_b2 / (EA + k_b2 (S - z)),  k_t = GJ / (d + z),  k_o = 25/12 GJ / (L - z)
    J_1 = J_c + j (d + z) / 2,  J_n = j (d + z) / 2 + j (L - z) / 6,  J_e = 5/6 j (L - z)
    m_u = mu (d s_1^2 + z (1 + s_1 + s_1^2) / 3 + (S - z) (1 + s_2 + s_2^2) / 3 + (L - S) s_2^2),  s_i = k_i / k_bi

| symbol | key | meaning | unit |
|---|---|---|---|
| thm, p1, pn, pe | (coordinates) | motor, drive_end, screw (at the nut), free_end | rad |
| u, x | (coordinates) | axial: screw at the nut; table | m |
| i | ratio | motor turns per screw turn | 1 |
| k_d, c_d | drive_stiffness, drive_damping | shaft, gear and coupling in series, at the screw | N m/rad, N m s/rad |
| J_m | motor_inertia | rotor and sum of J (1 - a)^2 / i^2 over hubs and wheels J, see below | kg m^2 |
| J_h, J_c | shared_inertia, drive_end_inertia | sum of J a (1 - a), of J a^2 | kg m^2 |
| EA, GJ | axial_rigidity, torsional_rigidity | of the screw | N, N m^2 |
| mu, j | mass_per_length, inertia_per_length | of the screw | kg/m, kg m |
| k_b1, k_b2 | bearing_stiffness, far_bearing_stiffness | axial, of the supports; 0 where one slides | N/m |
| d, S, L | drive_length, bearing_distance, screw_length | see above | m |
| z_0 | first_nut_position | nut where the table is at 0 | m |
| k_N, c_N | nut_stiffness, nut_damping | of the nut | N/m, N s/m |
| tau | damping_time | C = tau K for screw and supports: damping ratio pi f tau at frequency f | s |

Hubs and wheels between the springs of k_d ride at (1 - a) thm / i + a p1; a is the share of the compliance between
motor and screw that lies on the motor's side of them, 1 for what is fixed to the screw.

The overhang carries no static load. Its stiffness 25/12 GJ/(L-z) and the split 1/6, 5/6 of its inertia make the
dynamic stiffness of this one branch that of the continuous shaft, -w^2 J tan(y)/y with y = w (L-z)/c, to the order y^4
(its first own frequency is 0.7 % high, not 10 % low as with halves).

`elements` = 2 adds two coordinates: the middle of the main span, with 1/sqrt(3) of the span's inertia, which makes the
dynamic stiffness of the span right to y^4 where its ends move together, and the axial motion at the far bearing.

Accuracy, first two frequencies, against 60 finite elements on the drive of paper 004 over 0.1 to 1.1 m of 1.2 m: 1.3 %
with the motor held, 0.8 % with it free (2.1 % with fixed-fixed supports at the far end); 0.15 % with two elements
(tests/convergence/test_chain_against_elements.py).

M at a position is meant to be frozen over a cell of positions, or to follow, without terms M' x' q': where all angles
turn together these would say that the moving nut hands inertia on between shaft ends that turn at the same speed.
Inertia moves between them by j/2 per metre (1e-3 kg m for 40 mm); a cell 10 mm beside the nut shifts the first
frequency by 0.02 % and the second by 0.11 %, and in proportion.

Source: paper 004 (series of axial and torsional chain, eqs. (6)-(8)); Rayleigh for m_u; the distribution of the
overhang and of the split span follow from the Pade approximants given.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

from feeddrive.errors import InputError
from feeddrive.plant.chain.linear_chain import (
    LEAD,
    MOTOR_INERTIA,
    RATIO,
    TABLE_MASS,
    Chain,
    Matrix,
    Row,
    Spring,
    Values,
    chain_values,
)
from feeddrive.typing import Expression
from feeddrive.units.quantity import format_quantity

MIDDLE_SHARE = 1 / math.sqrt(3)
"""Share of a span's inertia that is put in its middle (mu^2 / k_c = 1/24 with mu = share / 2, k_c = 2)."""

_WITH_ONE = ("motor", "drive_end", "screw", "free_end", "axial", "table")
_WITH_TWO = ("motor", "drive_end", "mid_span", "screw", "free_end", "axial", "far_axial", "table")


@dataclass(frozen=True)
class DistributedScrew(Chain):
    """Motor, screw with distributed inertia and stiffness, supports, nut and table; depends on the nut's position.

    Attributes:
        elements: of the main span, 1 (six coordinates) or 2 (eight).
    """

    structure = "distributed_screw"
    varies = True
    required = (
        LEAD,
        MOTOR_INERTIA,
        RATIO,
        *chain_values("""
drive_stiffness | transmission.drive_stiffness | N m/rad | > 0 usual 1 to 1e8 | torsional stiffness from the motor \
to the screw's end
drive_damping | transmission.drive_damping | N m s/rad | >= 0 | damping beside the drive stiffness
shared_inertia | transmission.shared_inertia | kg m^2 | >= 0 | inertia of hubs and wheels between motor and screw, \
sum of J a (1 - a)
drive_end_inertia | transmission.drive_end_inertia | kg m^2 | >= 0 | inertia of hubs and wheels at the screw's end, \
sum of J a^2
drive_length | ball_screw.stub | m | >= 0 | from the near bearing back to the coupling, under torque alone
bearing_distance | ball_screw.bearing_distance | m | > 0 | between near and far bearing
screw_length | ball_screw.length | m | > 0 usual 0.02 to 20 | of the elastic screw
axial_rigidity | ball_screw.axial_rigidity | N | > 0 usual 1e5 to 1e11 | E A of the screw
torsional_rigidity | ball_screw.torsional_rigidity | N m^2 | > 0 usual 1e-2 to 1e8 | G I_p of the screw
mass_per_length | ball_screw.mass_per_length | kg/m | > 0 | mass of the screw per length
inertia_per_length | ball_screw.inertia_per_length | kg m | > 0 | inertia of the screw per length
damping_time | damping.time | s | >= 0 | damping over stiffness of every spring, C = time K
bearing_stiffness | support.near_stiffness | N/m | >= 0 usual 1e6 to 1e11 | axial stiffness of the bearing at the \
motor's end
far_bearing_stiffness | support.far_stiffness | N/m | >= 0 usual 1e6 to 1e11 | axial stiffness of the far bearing
nut_stiffness | nut.combined_stiffness | N/m | > 0 usual 1e6 to 1e11 | stiffness of nut and bracket together
nut_damping | nut.damping | N s/m | >= 0 | damping beside the nut stiffness
"""),
        TABLE_MASS,
        *chain_values("""
first_nut_position | table.first_nut_position | m | >= 0 | nut from the near bearing where the table is at 0
"""),
    )

    elements: int = 1

    @property
    def coordinates(self) -> tuple[str, ...]:
        return _WITH_ONE if self.elements == 1 else _WITH_TWO

    @property
    def key(self) -> tuple[object, ...]:
        return (self.structure, self.elements)

    def springs(self, p: Values, position: Expression = 0.0) -> tuple[Spring, ...]:
        return (*self._torsional(p, position), *self._axial(p, position), self.nut(p))

    def nut(self, p: Values) -> Spring:
        row = self._row(screw=p["lead"] / (2 * math.pi), axial=1.0, table=-1.0)
        return Spring("nut", row, p["nut_stiffness"], p["nut_damping"])

    def mass(self, p: Values, position: Expression = 0.0) -> Matrix:
        masses = {"motor": p["motor_inertia"], "table": p["table_mass"]}
        masses |= self._inertias(p, position) | self._axial_masses(p, position)
        names = self.coordinates
        matrix: Matrix = [[masses[a] if a == b else 0.0 for b in names] for a in names]
        motor, drive_end = names.index("motor"), names.index("drive_end")
        matrix[motor][drive_end] = matrix[drive_end][motor] = p["shared_inertia"] / p["ratio"]
        return matrix

    def motor(self, p: Values) -> Row:
        return self._row(motor=1.0)

    def screw(self, p: Values) -> Row:
        return self._row(screw=1.0)

    def rigid_motion(self, p: Values) -> Row:
        r = p["lead"] / (2 * math.pi)
        turning = {name: 1 / r for name in ("drive_end", "mid_span", "screw", "free_end")}
        motion = {"motor": p["ratio"] / r, "table": 1.0} | turning
        return [motion.get(name, 0.0) for name in self.coordinates]

    @property
    def nut_at_zero(self) -> float:
        return self.values["first_nut_position"]

    def nut_moved(self, way: float) -> Mapping[str, float]:
        return {**self.values, "first_nut_position": self.nut_at_zero + way}

    def nut_softened(self, share: float, stiffness: float) -> Mapping[str, float]:
        return {**self.values, "nut_stiffness": share * self.values["nut_stiffness"]}

    def refuse_off_screw(self, position: float, where: str) -> None:
        first, last = self.positions_on_screw()
        if not first < position < last:
            ends = " to ".join(format_quantity(end, "m") for end in (first, last))
            what = f"with the table at {format_quantity(position, 'm')} the nut is not on the screw"
            raise InputError(what, where, f"choose a position from {ends}")

    def positions_on_screw(self) -> tuple[float, float]:
        first = self.nut_at_zero
        return -first, min(self.values["bearing_distance"], self.values["screw_length"]) - first

    def nut_place(self, p: Values, position: Expression) -> Expression:
        """z of the nut from the bearing at the motor's end with the table at `position` [m]."""
        return p["first_nut_position"] + position

    def _row(self, **entries: Expression) -> Row:
        return [entries.get(name, 0.0) for name in self.coordinates]

    def _spans(self, p: Values, position: Expression) -> tuple[Expression, Expression, Expression]:
        """Length of the torsional main span, of the overhang, and of the axial span to the far bearing [m]."""
        z = self.nut_place(p, position)
        return p["drive_length"] + z, p["screw_length"] - z, p["bearing_distance"] - z

    def _torsional(self, p: Values, position: Expression) -> list[Spring]:
        main, over, _ = self._spans(p, position)
        drive = self._row(motor=1 / p["ratio"], drive_end=-1.0)
        k_t, k_o = p["torsional_rigidity"] / main, 25 / 12 * p["torsional_rigidity"] / over
        tau = p["damping_time"]
        springs = [Spring("drive", drive, p["drive_stiffness"], p["drive_damping"])]
        if self.elements == 1:
            springs.append(Spring("screw_torsion", self._row(drive_end=1.0, screw=-1.0), k_t, tau * k_t))
        else:
            for row in (self._row(drive_end=1.0, mid_span=-1.0), self._row(mid_span=1.0, screw=-1.0)):
                springs.append(Spring("screw_torsion", row, 2 * k_t, tau * 2 * k_t))
        springs.append(Spring("overhang_torsion", self._row(screw=1.0, free_end=-1.0), k_o, tau * k_o))
        return springs

    def _axial(self, p: Values, position: Expression) -> list[Spring]:
        z, tau, rigidity = self.nut_place(p, position), p["damping_time"], p["axial_rigidity"]
        _, _, far = self._spans(p, position)
        k_1 = _in_series(rigidity, p["bearing_stiffness"], z)
        at_nut = self._row(axial=1.0)
        if self.elements == 1:
            k_ax = k_1 + _in_series(rigidity, p["far_bearing_stiffness"], far)
            return [Spring("axial", at_nut, k_ax, tau * k_ax)]
        k_far, k_b2 = rigidity / far, p["far_bearing_stiffness"]
        return [
            Spring("axial", at_nut, k_1, tau * k_1),
            Spring("far_axial", self._row(axial=1.0, far_axial=-1.0), k_far, tau * k_far),
            Spring("far_bearing", self._row(far_axial=1.0), k_b2, tau * k_b2),
        ]

    def _inertias(self, p: Values, position: Expression) -> dict[str, Expression]:
        """J of the screw's angles [kg m^2]."""
        main, over, _ = self._spans(p, position)
        span, overhang = p["inertia_per_length"] * main, p["inertia_per_length"] * over
        middle = MIDDLE_SHARE if self.elements == 2 else 0.0
        end = 0.5 * (1 - middle) * span
        inertias = {
            "drive_end": p["drive_end_inertia"] + end,
            "screw": end + overhang / 6,
            "free_end": overhang * (5 / 6),
        }
        return inertias if self.elements == 1 else inertias | {"mid_span": middle * span}

    def _axial_masses(self, p: Values, position: Expression) -> dict[str, Expression]:
        """m_u [kg], and the mass at the far bearing where that moves by itself."""
        z, rigidity, per_length = self.nut_place(p, position), p["axial_rigidity"], p["mass_per_length"]
        _, _, far = self._spans(p, position)
        beyond = p["screw_length"] - p["bearing_distance"]
        s_1 = rigidity / (rigidity + p["bearing_stiffness"] * z)
        near = p["drive_length"] * s_1**2 + z * (1 + s_1 + s_1**2) / 3
        if self.elements == 2:
            return {"axial": per_length * (near + far / 2), "far_axial": per_length * (far / 2 + beyond)}
        s_2 = rigidity / (rigidity + p["far_bearing_stiffness"] * far)
        return {"axial": per_length * (near + far * (1 + s_2 + s_2**2) / 3 + beyond * s_2**2)}


def _in_series(rigidity: Expression, bearing: Expression, length: Expression) -> Expression:
    """Stiffness of a bearing and a length of screw in series [N/m]; 0 where the bearing slides."""
    return rigidity * bearing / (rigidity + bearing * length)
