"""Preload of the double nut over temperature, against balls that are followed one by one."""

from __future__ import annotations

import math

import numpy as np
import pytest

from feeddrive.errors import InputError
from feeddrive.thermal.thermal_coupling import Spacer, preload_change

PRELOAD, STIFFNESS, DISTANCE, PITCH, EXPANSION = 2200.0, 280e6, 0.070, 0.0335, 11.7e-6


def _change(angle: float, spacer: Spacer = Spacer.OVERSIZE) -> float:
    return preload_change(1.0, PRELOAD, STIFFNESS, DISTANCE, PITCH, math.radians(angle), spacer)


def _contact_normals(angle: float, spacer: Spacer) -> list[tuple[np.ndarray, np.ndarray]]:
    """Places of the two rows (radius, along the axis), and the normals by which the nut presses on their balls."""
    outward = spacer.value  # an oversize spacer presses the nuts, and they the balls, apart
    rows = []
    for side in (-1.0, 1.0):
        place = np.array([PITCH / 2, side * DISTANCE / 2])
        rows.append((place, np.array([-math.cos(angle), outward * side * math.sin(angle)])))
    return rows


def _balls_change(degrees: float, spacer: Spacer, rise: float) -> float:
    """Axial force of a row that a nut hotter by `rise` gains [N], in equilibrium along the axis.

    The nut is one body that grows as a similar one about a point of its axis and slides until its two rows balance.
    Each row obeys Hertz's law Q = K d^(3/2) along its normal, which does not turn.
    """
    angle = math.radians(degrees)
    along = 1.5 * PRELOAD / STIFFNESS * math.sin(angle)  # approach of groove and ball under the preload
    hertz = PRELOAD / math.sin(angle) / along**1.5

    def forces(slide: float) -> list[float]:
        result = []
        for place, normal in _contact_normals(angle, spacer):
            moved = EXPANSION * rise * place + np.array([0.0, slide])
            result.append(hertz * max(along + float(moved @ normal), 0.0) ** 1.5 * float(normal[1]))
        return result

    low, high = -1e-5, 1e-5
    unbalanced = [sum(forces(end)) for end in (low, high)]
    for _ in range(200):  # bisection on the slide
        middle = 0.5 * (low + high)
        if (sum(forces(middle)) > 0) == (unbalanced[1] > 0):
            high = middle
        else:
            low = middle
    return float(abs(forces(0.5 * (low + high))[0]) - PRELOAD)


@pytest.mark.parametrize("spacer", list(Spacer))
@pytest.mark.parametrize("angle", [20.0, 30.0, 45.0, 60.0, 70.0])
def test_change_is_that_of_balls_in_their_grooves(angle: float, spacer: Spacer) -> None:
    rise = 1e-3
    # Central difference: what Hertz's law bends cancels, the next term is (0.3 nm / 10 um)^2.
    slope = (_balls_change(angle, spacer, rise) - _balls_change(angle, spacer, -rise)) / (2 * rise)
    assert _change(angle, spacer) == pytest.approx(slope, rel=1e-6, abs=1e-5)


@pytest.mark.parametrize(("angle", "told"), [(30.0, 21.4), (45.0, 60.8), (60.0, 83.6), (70.0, 95.1)])
def test_change_over_the_contact_angle(angle: float, told: float) -> None:
    # Recomputed elsewhere with a contact angle that turns with the load, which gives back 2 % of the radial part
    # (95, 55, 32 and 20 N/K); one unit of the last digit is added.
    radial = STIFFNESS * EXPANSION * PITCH / 2 / math.tan(math.radians(angle))
    assert _change(angle) == pytest.approx(told, abs=0.02 * radial + 0.1)


def test_flat_and_steep_contacts() -> None:
    # Contacts along the axis feel the axial part alone; the flatter they are, the more radial growth takes away.
    axial = STIFFNESS * EXPANSION * DISTANCE / 2
    assert _change(89.999) == pytest.approx(axial, rel=1e-4)
    assert _change(10.0) < _change(20.0) < _change(45.0) < axial


def test_angle_beyond_the_axis_is_refused() -> None:
    with pytest.raises(InputError, match="write it below 90 deg"):
        _change(90.0)
