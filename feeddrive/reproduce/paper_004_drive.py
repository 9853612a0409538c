"""The drive of paper 004: its Table 1, and what had to be assumed to compute with it."""

from __future__ import annotations

from feeddrive.parts.bearings.supports import ScrewSupports, Support, SupportBearing
from feeddrive.parts.combined_stiffness import (
    CombinedStiffness,
    Contribution,
    Deformation,
    axial_from_torsional,
)
from feeddrive.parts.coupling import Coupling
from feeddrive.parts.motor import Motor
from feeddrive.parts.screw.ball_screw import STEEL, ScrewShaft, ShaftMaterial
from feeddrive.parts.screw.nut import Nut
from feeddrive.parts.screw.screw_drive import BallScrewDrive

FORCE_LENGTH = 0.564
"""Effective length for force: nut from the fixed bearing [m] (Table 1)."""

TORQUE_LENGTH = 0.670
"""Effective length for torque: nut from the coupling [m] (Table 1)."""

MODULI = "E = 210 GPa, G = 83.0 GPa and a solid shaft of 40 mm, none of them printed"
"""The assumption behind every stiffness of the screw."""

LEAD = 0.020
"""[m] (Table 1)."""

TABLE_MASS = 134.0
"""[kg] (Table 1)."""

NUT, BEARING = 1499e6, 780e6
"""Axial stiffness of nut and support bearing [N/m] (Table 1)."""

SCREW, AXIAL_CHAIN, TORSIONAL_CHAIN = 468e6, 244.7e6, 11982.4
"""Printed results: k_BS, k_XS [N/m] and k_TS [N m/rad] (section 3)."""

CUT_OFF = "its printed digits are cut off, not rounded"
"""Why a computed value may lie up to a whole unit of the last digit above a printed one."""

_MATERIAL = ShaftMaterial(young=210e9, shear=83.0e9, density=STEEL.density, expansion=STEEL.expansion)
_COUPLING = 27_000.0
_SHAFT = 69_930.0


def printed_parts() -> CombinedStiffness:
    """The drive as (6) and (7) have it, from the printed stiffness of its parts alone."""
    axial = (("nut", NUT), ("screw", SCREW), ("bearing", BEARING))
    parts = [Contribution(name, Deformation.AXIAL, 1.0 / stiffness) for name, stiffness in axial]
    return CombinedStiffness(LEAD, (*parts, _torsional_chain()))


def printed_chains() -> CombinedStiffness:
    """The drive as (8) has it, from the printed stiffness of its two chains alone."""
    return CombinedStiffness(
        LEAD, (Contribution("axial chain", Deformation.AXIAL, 1.0 / AXIAL_CHAIN), _torsional_chain())
    )


def _torsional_chain() -> Contribution:
    return Contribution("torsional chain", Deformation.TORSIONAL, 1.0 / axial_from_torsional(TORSIONAL_CHAIN, LEAD))


def paper_drive(screw_length: float = 0.9) -> BallScrewDrive:
    """The drive; the motor end is taken as the fixed one.

    Assumed, beside `MODULI`: the split of coupling (27 000 N m/rad) and motor shaft (69 930 N m/rad), of which the
    printed k_TS gives only the sum of compliances; the rotor's inertia and torque, which a held motor does not show;
    no inertia of the coupling; the length of the screw.

    Args:
        screw_length: fixed bearing to the far end [m]; it matters to its mass alone.
    """
    screw = ScrewShaft(
        lead=LEAD, diameter=0.040, length=screw_length, stub=TORQUE_LENGTH - FORCE_LENGTH, material=_MATERIAL
    )
    return BallScrewDrive(
        screw=screw,
        nut=Nut(NUT),
        supports=ScrewSupports(Support.FIXED_SUPPORTED, SupportBearing(BEARING)),
        table_mass=TABLE_MASS,
        motor=Motor(rotor_inertia=6e-3, torque_limit=50.0, shaft_stiffness=_SHAFT),
        coupling=Coupling(_COUPLING),
    )
