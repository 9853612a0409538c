"""The drive of paper 004, and random drives, for the tests of stiffness."""

from __future__ import annotations

from hypothesis import strategies as st

from feeddrive.parts.bearings.supports import ScrewSupports, Support, SupportBearing
from feeddrive.parts.coupling import Coupling
from feeddrive.parts.motor import Motor
from feeddrive.parts.screw.ball_screw import ScrewShaft, ShaftMaterial
from feeddrive.parts.screw.nut import Nut
from feeddrive.parts.screw.screw_drive import BallScrewDrive

PAPER_STEEL = ShaftMaterial(young=210e9, shear=83.0e9, density=7850.0, expansion=11.7e-6)
"""The moduli that its printed stiffnesses mean; density of steel."""
AT_NUT = 0.564
"""Nut from the fixed bearing in paper 004 [m]."""


def paper_drive(length: float = 1.2, coupling_inertia: float = 3e-3, *, both_ends: bool = False) -> BallScrewDrive:
    """Paper 004's drive; length, coupling's inertia and its split from the motor shaft are assumed."""
    bearing = SupportBearing(780e6)
    supports = ScrewSupports(Support.FIXED_FIXED, bearing, bearing)
    return BallScrewDrive(
        screw=ScrewShaft(lead=0.020, diameter=0.040, length=length, stub=0.106, material=PAPER_STEEL),
        nut=Nut(1499e6),
        supports=supports if both_ends else ScrewSupports(Support.FIXED_SUPPORTED, bearing),
        table_mass=134.0,
        motor=Motor(rotor_inertia=6e-3, torque_limit=50.0, shaft_stiffness=69_930.0),
        coupling=Coupling(27_000.0, coupling_inertia),
    )


bearings = st.floats(2e7, 5e9).map(SupportBearing)


@st.composite
def supports(draw: st.DrawFn) -> ScrewSupports:
    """Any of the four kinds."""
    kind = draw(st.sampled_from(Support))
    return ScrewSupports(kind, draw(bearings), draw(bearings) if kind.far_end_takes_force else None)


@st.composite
def drives(draw: st.DrawFn) -> BallScrewDrive:
    """Drives as catalogues allow them."""
    diameter = draw(st.floats(0.008, 0.1))
    return BallScrewDrive(
        screw=ScrewShaft(
            lead=draw(st.floats(0.002, 0.06)),
            diameter=diameter,
            length=draw(st.floats(0.2, 5.0)),
            stub=draw(st.floats(0.0, 0.3)),
            root_diameter=diameter * draw(st.floats(0.8, 1.0)),
        ),
        nut=Nut(draw(st.floats(2e7, 4e9))),
        supports=draw(supports()),
        table_mass=draw(st.floats(5.0, 5000.0)),
        motor=Motor(draw(st.floats(1e-5, 0.1)), 20.0, draw(st.none() | st.floats(100.0, 1e6))),
        coupling=draw(st.none() | st.builds(Coupling, st.floats(50.0, 1e6), st.floats(0.0, 0.05))),
    )
