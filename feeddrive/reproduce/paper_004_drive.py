"""The drive of paper 004: its Table 1, and what had to be assumed to compute with it."""

from __future__ import annotations

from feeddrive.parts.ball_screw import ScrewShaft
from feeddrive.parts.bearing import SupportBearing
from feeddrive.parts.coupling import Coupling
from feeddrive.parts.material import STEEL, ShaftMaterial
from feeddrive.parts.motor import Motor
from feeddrive.parts.nut import Nut
from feeddrive.parts.screw_drive import BallScrewDrive
from feeddrive.parts.supports import ScrewSupports, Support

FORCE_LENGTH = 0.564
"""Effective length for force: nut from the fixed bearing [m] (Table 1)."""

TORQUE_LENGTH = 0.670
"""Effective length for torque: nut from the coupling [m] (Table 1)."""

MODULI = "E = 210 GPa, G = 83.0 GPa and a solid shaft of 40 mm, none of them printed"
"""The assumption behind every stiffness of the screw."""

CUT_OFF = "its printed digits are cut off, not rounded"
"""Why a computed value may lie up to a whole unit of the last digit above a printed one."""

_MATERIAL = ShaftMaterial(young=210e9, shear=83.0e9, density=STEEL.density, expansion=STEEL.expansion)
_COUPLING = 27_000.0
_SHAFT = 69_930.0


def paper_drive(screw_length: float = 0.9) -> BallScrewDrive:
    """The drive; the motor end is taken as the fixed one.

    Assumed, beside `MODULI`: the split of coupling (27 000 N m/rad) and motor shaft (69 930 N m/rad), of which the
    printed k_TS gives only the sum of compliances; the rotor's inertia and torque, which a held motor does not show;
    no inertia of the coupling; the length of the screw.

    Args:
        screw_length: fixed bearing to the far end [m]; it matters to its mass alone.
    """
    screw = ScrewShaft(
        lead=0.020, diameter=0.040, length=screw_length, stub=TORQUE_LENGTH - FORCE_LENGTH, material=_MATERIAL
    )
    return BallScrewDrive(
        screw=screw,
        nut=Nut(1499e6),
        supports=ScrewSupports(Support.FIXED_SUPPORTED, SupportBearing(780e6)),
        table_mass=134.0,
        motor=Motor(rotor_inertia=6e-3, torque_limit=50.0, shaft_stiffness=_SHAFT),
        coupling=Coupling(_COUPLING),
    )
