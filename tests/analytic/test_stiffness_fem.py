"""The finite-element drive against what is known without it: closed forms, limits, refinement, and earlier figures."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from tests.analytic.screw_fem import ScrewDrive, frequencies, static_stiffness

PAPER = ScrewDrive()
AT_NUT = 0.564


def _series(drive: ScrewDrive, position: float) -> float:
    """Closed form of the fixed-supported drive [N/m]."""
    area, polar = math.pi * drive.diameter**2 / 4.0, math.pi * drive.diameter**4 / 32.0
    ratio = (drive.lead / (2.0 * math.pi)) ** 2
    torsion = (position + drive.stub) / (drive.shear * polar) + 1.0 / drive.coupling + 1.0 / drive.motor_shaft
    return 1.0 / (position / (drive.young * area) + 1.0 / drive.nut + 1.0 / drive.bearing + torsion * ratio)


@pytest.mark.parametrize("position", [0.1, 0.564, 1.1])
def test_static_stiffness_is_the_series_of_all_springs(position: float) -> None:
    """Linear elements are exact under end loads, so only rounding is left."""
    assert static_stiffness(PAPER, position) == pytest.approx(_series(PAPER, position), rel=1e-9)


def test_without_masses_the_table_alone_swings() -> None:
    massless = replace(PAPER, axial_mass=False, rotary_mass=False, coupling_inertia=0.0)
    expected = math.sqrt(static_stiffness(massless, AT_NUT) / massless.table) / (2.0 * math.pi)
    assert frequencies(massless, AT_NUT, count=1)[0] == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize(
    ("length", "coupling_inertia", "braked", "free"),
    [
        (0.9, 0.0, (190.1, 473.0, 1741.0), (213.5, 524.0, 1745.0)),
        (1.2, 0.0, (187.6, 402.0, 1377.0), (212.0, 455.0, 1382.0)),
        (1.2, 3e-3, (185.6, 351.0, 923.0), (209.0, 424.0, 947.0)),
        (1.5, 3e-3, (182.8, 320.0, 807.0), (207.6, 389.0, 833.0)),
    ],
)
def test_frequencies_of_an_independent_calculation(
    length: float, coupling_inertia: float, braked: tuple[float, ...], free: tuple[float, ...]
) -> None:
    """Half a unit of the last digit noted there: 0.1 Hz for the first, 1 Hz for the others."""
    drive = replace(PAPER, length=length, coupling_inertia=coupling_inertia)
    margin = np.array([0.05, 0.5, 0.5])
    assert np.all(np.abs(frequencies(drive, AT_NUT) - braked) <= margin)
    assert np.all(np.abs(frequencies(drive, AT_NUT, braked=False) - free) <= margin)


def test_sixty_elements_are_enough() -> None:
    """Linear elements converge with the square of the step: a third of it leaves a ninth of the error."""
    coarse, fine = frequencies(PAPER, AT_NUT), frequencies(replace(PAPER, elements=180), AT_NUT)
    # Third mode: about pi^2/24 (h/half wave)^2 with some 20 elements to a half wave, 1e-3; the others far less.
    assert np.all(coarse >= fine)
    assert coarse == pytest.approx(fine, rel=1e-3)
