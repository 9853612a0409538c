"""Combined stiffness: the conversion, springs in series, shares, position, transmission, brake."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from feeddrive.errors import InputError
from feeddrive.parts.bearings.supports import Support
from feeddrive.parts.combined_stiffness import (
    CombinedStiffness,
    Deformation,
    axial_from_torsional,
    combined_stiffness,
    stiffness_along,
    torsional_from_axial,
)
from feeddrive.parts.coupling import Coupling, Transmission
from feeddrive.parts.motor import HoldingBrake, Motor
from feeddrive.parts.screw.screw_drive import BallScrewDrive
from tests.analytic.screw_fem import ScrewDrive, static_stiffness
from tests.analytic.stiffness_cases import AT_NUT, drives, paper_drive

ROUNDING = 1e-10
"""Relative; sums of a dozen terms in double precision."""
shares = st.floats(0.0, 1.0)


@given(st.floats(1e5, 1e11), st.floats(1e-4, 0.5))
def test_conversion_and_back(stiffness: float, lead: float) -> None:
    back = axial_from_torsional(torsional_from_axial(stiffness, lead), lead)
    assert back == pytest.approx(stiffness, rel=ROUNDING)


@given(drives(), shares)
def test_never_stiffer_than_the_weakest_part(drive: BallScrewDrive, share: float) -> None:
    found = combined_stiffness(drive, share * drive.screw.length)
    weakest = min(1.0 / one.compliance for one in found.contributions)
    assert found.total <= weakest * (1 + ROUNDING)
    assert found.total >= weakest / len(found.contributions) * (1 - ROUNDING)
    assert found.total <= min(found.axial, axial_from_torsional(found.torsional, found.lead)) * (1 + ROUNDING)


@given(drives(), shares)
def test_shares_add_up(drive: BallScrewDrive, share: float) -> None:
    found = combined_stiffness(drive, share * drive.screw.length)
    assert sum(found.share(chain) for chain in Deformation) == pytest.approx(1.0, rel=ROUNDING)
    within = found.shares_within(Deformation.AXIAL)
    assert sum(within.values()) == pytest.approx(1.0, rel=ROUNDING)
    assert min(within.values()) >= 0.0


@given(drives(), shares, shares)
def test_away_from_the_motor_is_softer_where_one_end_holds(drive: BallScrewDrive, one: float, other: float) -> None:
    assume(drive.supports.kind in (Support.FIXED_FREE, Support.FIXED_SUPPORTED))
    nearer, farther = sorted((one, other))
    stiffness = stiffness_along(drive, drive.screw.length * np.array([nearer, farther]))
    assert stiffness[0] >= stiffness[1] * (1 - ROUNDING)


@given(drives(), shares, st.floats(1.01, 1.25))
def test_a_stiffer_part_never_makes_the_drive_softer(drive: BallScrewDrive, share: float, factor: float) -> None:
    position = share * drive.screw.length
    stiffer = replace(drive, nut=replace(drive.nut, axial_stiffness=drive.nut.axial_stiffness * factor))
    gain = 1.0 / combined_stiffness(drive, position).total - 1.0 / combined_stiffness(stiffer, position).total
    expected = (1.0 - 1.0 / factor) / drive.nut.axial_stiffness
    # A difference of compliances up to some 1e4 times itself loses that many digits.
    assert gain == pytest.approx(expected, rel=1e-8)


@pytest.mark.parametrize("both_ends", [False, True])
@pytest.mark.parametrize("position", [0.1, 0.564, 1.1])
def test_finite_elements_have_the_same_stiffness(position: float, both_ends: bool) -> None:
    """Linear elements are exact under end loads; only rounding is left."""
    fem = ScrewDrive(far_bearing=780e6 if both_ends else 0.0)
    stiffness = combined_stiffness(paper_drive(both_ends=both_ends), position).total
    assert stiffness == pytest.approx(static_stiffness(fem, position), rel=1e-9)


def test_a_drive_that_cannot_twist_is_the_axial_chain() -> None:
    """A lead so fine that twist moves nothing: the torsional share falls with the square of the lead."""
    drive = paper_drive()
    fine = replace(drive, screw=replace(drive.screw, lead=1e-3))
    found, coarse = combined_stiffness(fine, AT_NUT), combined_stiffness(drive, AT_NUT)
    ratio = found.share(Deformation.TORSIONAL) / found.share(Deformation.AXIAL)
    expected = coarse.share(Deformation.TORSIONAL) / coarse.share(Deformation.AXIAL) / 400.0
    assert ratio == pytest.approx(expected, rel=ROUNDING)
    assert found.total == pytest.approx(found.axial, rel=1e-3)  # what is left of the twist: 0.17 / 0.83 / 400


def test_rigid_torsion_is_infinite() -> None:
    assert math.isinf(CombinedStiffness(0.02, ()).torsional)


def test_reduction_makes_the_motor_side_stiffer_by_its_square() -> None:
    belt = Transmission(ratio=2.0, torsional_stiffness=20_000.0)
    direct = BallScrewDrive(**{**vars(paper_drive()), "coupling": None})
    geared = replace(direct, transmission=belt)
    twist = {one.part: one.compliance for one in combined_stiffness(geared, AT_NUT).contributions}
    straight = {one.part: one.compliance for one in combined_stiffness(direct, AT_NUT).contributions}
    r = geared.screw.travel_per_radian
    assert twist["motor shaft"] == pytest.approx(straight["motor shaft"] / 4.0, rel=ROUNDING)
    assert twist["transmission"] == pytest.approx(r**2 / 20_000.0, rel=ROUNDING)


def test_brake_is_one_more_spring() -> None:
    drive = paper_drive()
    soft = replace(drive, motor=replace(drive.motor, brake=HoldingBrake(30.0, 40_000.0)))
    gained = 1.0 / combined_stiffness(soft, AT_NUT).torsional - 1.0 / combined_stiffness(drive, AT_NUT).torsional
    assert gained == pytest.approx(1.0 / 40_000.0, rel=1e-9)


def test_no_coupling_and_rigid_shaft_leave_the_screw() -> None:
    bare = replace(paper_drive(), coupling=None, motor=Motor(6e-3, 50.0))
    found = combined_stiffness(bare, AT_NUT)
    assert list(found.shares_within(Deformation.TORSIONAL)) == ["screw"]
    assert found.torsional == pytest.approx(bare.screw.torsional_stiffness(0.670), rel=ROUNDING)


def test_hubs_share_the_inertia() -> None:
    coupling = Coupling(1e4, 4e-3, screw_side_share=0.75)
    assert (coupling.screw_hub_inertia, coupling.motor_hub_inertia) == (3e-3, 1e-3)


def test_nut_off_the_screw_is_refused() -> None:
    with pytest.raises(InputError, match="not on the screw"):
        combined_stiffness(paper_drive(), 1.3)
