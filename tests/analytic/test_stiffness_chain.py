"""Frequency of a drive's parts with the motor held, by the chain: finite elements, Rayleigh's bound, brake."""

from __future__ import annotations

from dataclasses import replace

import pytest

from feeddrive.errors import InputError, ValidityWarning
from feeddrive.parts.bearings.supports import ScrewSupports, Support
from feeddrive.parts.coupling import Transmission
from feeddrive.parts.motor import HoldingBrake, Motor
from feeddrive.parts.screw.screw_drive import BallScrewDrive
from feeddrive.plant.analysis.modes import held_frequency
from tests.analytic.rayleigh import rayleigh_frequency
from tests.analytic.screw_fem import ScrewDrive, frequencies
from tests.analytic.stiffness_cases import AT_NUT, paper_drive

GEAR = Transmission(ratio=2.5, torsional_stiffness=15_000.0, motor_wheel_inertia=1e-3, screw_wheel_inertia=8e-3)


@pytest.mark.parametrize("both_ends", [False, True])
@pytest.mark.parametrize("position", [0.1, 0.3, 0.564, 0.9, 1.1])
def test_frequency_is_that_of_finite_elements(position: float, both_ends: bool) -> None:
    """The chain's own accuracy of 0.15 %, tested over the stroke elsewhere; more where both ends are fixed."""
    exact = frequencies(ScrewDrive(far_bearing=780e6 if both_ends else 0.0), position, count=1)[0]
    found = held_frequency(paper_drive(both_ends=both_ends), position)
    assert found == pytest.approx(exact, rel=3e-3 if both_ends else 1.5e-3)


def test_rayleigh_is_above_the_chain_with_a_gear() -> None:
    """The same parts in two models: a guessed shape can only be faster. Heavy wheels on a soft belt: 12 %, said."""
    geared = replace(paper_drive(), transmission=GEAR)
    exact = held_frequency(geared, AT_NUT)
    with pytest.warns(ValidityWarning, match=r"add 39\.2 kg to 134 kg"):
        assert exact <= rayleigh_frequency(geared, AT_NUT) <= 1.13 * exact


def test_brake_is_in_the_chain_too() -> None:
    ideal = held_frequency(paper_drive(), AT_NUT)
    # Its compliance is 1/9e6 beside the torsional chain's 1/12e3, of which 17 % reach the table: 1.1e-4 in frequency,
    # and about as much again since every hub swings more.
    assert held_frequency(_braked(9e6), AT_NUT) == pytest.approx(ideal, rel=3e-4)
    # Soft: the rotor swings too. Rayleigh's bound lies above by somewhat more than the 0.9 % of the rigid brake.
    soft = held_frequency(_braked(4e4), AT_NUT)
    assert soft < 0.98 * ideal
    assert soft <= rayleigh_frequency(_braked(4e4), AT_NUT) <= 1.05 * soft


def _braked(stiffness: float) -> BallScrewDrive:
    drive = paper_drive()
    return replace(drive, motor=replace(drive.motor, brake=HoldingBrake(30.0, stiffness)))


@pytest.mark.parametrize("position", [0.2, 1.0])
def test_one_bearing_at_a_time_is_a_single_end(position: float) -> None:
    """Held at the farther end: with the stub's torsion unchanged only the axial path differs."""
    both = paper_drive(both_ends=True).supports
    one_at_a_time = ScrewSupports(Support.SUPPORTED_SUPPORTED, both.near, both.far)
    found = held_frequency(replace(paper_drive(), supports=one_at_a_time), position)
    if position > 0.6:
        assert found == pytest.approx(held_frequency(paper_drive(), position), rel=1e-12)
    assert found <= held_frequency(paper_drive(), position) * (1 + 1e-12)
    assert found < held_frequency(paper_drive(both_ends=True), position)


def test_what_has_no_held_frequency_is_refused() -> None:
    with pytest.raises(InputError, match="between motor and screw"):
        held_frequency(replace(paper_drive(), coupling=None, motor=Motor(6e-3, 50.0)), AT_NUT)
    with pytest.raises(InputError, match="nut is not on the screw"):
        held_frequency(paper_drive(), 1.2)
