"""The screw's own mass in the first mode: bounds, limits, finite elements."""

from __future__ import annotations

from dataclasses import astuple, replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from feeddrive.parts.combined_stiffness import combined_stiffness
from feeddrive.parts.coupling import Transmission
from feeddrive.parts.motor import HoldingBrake
from feeddrive.parts.screw.screw_drive import BallScrewDrive
from tests.analytic.rayleigh import added_mass, rayleigh_frequency
from tests.analytic.screw_fem import ScrewDrive, frequencies
from tests.analytic.stiffness_cases import AT_NUT, drives, paper_drive


def _elements(drive: BallScrewDrive) -> ScrewDrive:
    """The same drive as finite elements (coupled, solid or root diameter alike, not supported-supported)."""
    screw, far = drive.screw, drive.supports.far
    assert drive.coupling is not None and drive.motor.shaft_stiffness is not None
    return ScrewDrive(
        diameter=screw.diameter, lead=screw.lead, length=screw.length, stub=screw.stub,
        young=screw.material.young, shear=screw.material.shear, density=screw.material.density,
        nut=drive.nut.axial_stiffness, bearing=drive.supports.near.axial_stiffness,
        far_bearing=far.axial_stiffness if far is not None else 0.0,
        coupling=drive.coupling.torsional_stiffness, motor_shaft=drive.motor.shaft_stiffness,
        coupling_inertia=drive.coupling.inertia, rotor_inertia=drive.motor.rotor_inertia, table=drive.table_mass,
    )  # fmt: skip


@pytest.mark.parametrize("both_ends", [False, True])
@pytest.mark.parametrize("position", [0.1, 0.3, 0.564, 0.9, 1.1])
def test_bound_from_above_and_close(position: float, both_ends: bool) -> None:
    """Rayleigh's frequency is never below the true one. Its error is largest where the screw turns most beside the
    table, with both ends fixed and the nut near the motor: it was 5.2 % there, 0.9 % for the paper's own case."""
    drive = paper_drive(both_ends=both_ends)
    exact = frequencies(_elements(drive), position, count=1)[0]
    bound = rayleigh_frequency(drive, position)
    assert exact <= bound <= (1.055 if both_ends else 1.035) * exact


def test_heavy_table_makes_it_exact() -> None:
    """The error of Rayleigh's quotient falls with the square of the mass ratio."""
    heavy = replace(paper_drive(), table_mass=13_400.0)
    exact = frequencies(_elements(heavy), AT_NUT, count=1)[0]
    # 0.9 % at 134 kg; a hundred times the mass leaves a ten-thousandth of it.
    assert rayleigh_frequency(heavy, AT_NUT) == pytest.approx(exact, rel=2e-6)


@settings(max_examples=40)
@given(drives(), st.floats(0.05, 0.95))
def test_masses_are_positive_and_bounded(drive: BallScrewDrive, share: float) -> None:
    """No point of the screw moves more than the table, axially or by its twist, when the table is pushed."""
    added = added_mass(drive, share * drive.screw.length)
    assert min(astuple(added)) >= 0.0
    coupling = drive.coupling.inertia if drive.coupling is not None else 0.0
    most = drive.screw.mass + (drive.screw.inertia + coupling) / drive.screw.travel_per_radian**2
    assert added.total <= most * (1 + 1e-12)


def test_rod_on_a_rigid_bearing_is_a_third_of_its_mass() -> None:
    """Textbook: a rod fixed at one end, pulled at the other, moves with a third of its mass."""
    drive = paper_drive(length=AT_NUT)
    stiff = replace(
        drive,
        screw=replace(drive.screw, lead=1e-3, stub=0.0),
        nut=replace(drive.nut, axial_stiffness=4.9e9),
        supports=replace(drive.supports, near=replace(drive.supports.near, axial_stiffness=9.9e9)),
    )
    share = combined_stiffness(stiff, AT_NUT).total * AT_NUT / stiff.screw.axial_rigidity
    # The screw takes `share` of the deflection, the bearing about a twentieth: second order in what is left.
    third = stiff.screw.mass / 3.0
    assert added_mass(stiff, AT_NUT).axial_span == pytest.approx(third * share**2, rel=0.17)
    assert added_mass(stiff, AT_NUT).axial_span > third * share**2


def test_soft_brake_lets_the_rotor_take_part() -> None:
    drive = paper_drive()
    soft = replace(drive, motor=replace(drive.motor, brake=HoldingBrake(30.0, 40_000.0)))
    k, r = combined_stiffness(soft, AT_NUT).total, soft.screw.travel_per_radian
    swing = k * r / 40_000.0
    assert added_mass(soft, AT_NUT).hubs > soft.motor.rotor_inertia * swing**2
    assert rayleigh_frequency(soft, AT_NUT) < rayleigh_frequency(drive, AT_NUT)


def test_wheels_swing_with_the_springs_before_them() -> None:
    """By hand: twist at the screw under the torque k r of a unit push; its wheel by the ratio squared."""
    belt = Transmission(ratio=2.0, torsional_stiffness=20_000.0, motor_wheel_inertia=1e-3, screw_wheel_inertia=8e-3)
    drive = replace(paper_drive(), coupling=None, transmission=belt)
    torque = combined_stiffness(drive, AT_NUT).total * drive.screw.travel_per_radian
    motor_wheel = torque / (69_930.0 * 4.0)
    screw_wheel = motor_wheel + torque / 20_000.0
    expected = 1e-3 * 4.0 * motor_wheel**2 + 8e-3 * screw_wheel**2
    assert added_mass(drive, AT_NUT).hubs == pytest.approx(expected, rel=1e-10)  # rounding
