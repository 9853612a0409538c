"""Hertz contact: closed form of the circle, defining equation, symmetry, scaling, energy, refusals."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad
from scipy.special import ellipe, ellipk

from feeddrive.errors import InputError, ValidityWarning
from feeddrive.parts.contact import (
    BEARING_STEEL,
    Curvatures,
    Material,
    ball_in_groove,
    ellipse_numbers,
    point_contact,
)

RATIOS = st.floats(1.0, 1e5)
CURVATURE = st.floats(1.0, 1e4)
LOAD = st.floats(1e-3, 1e5)


def test_ball_on_plane_is_the_circle_of_hertz() -> None:
    radius, load = 5e-3, 100.0
    contact = point_contact(Curvatures((1 / radius, 1 / radius), (0.0, 0.0)), BEARING_STEEL, BEARING_STEEL)
    modulus = 1.0 / contact.compliance
    a, b = contact.semi_axes(load)
    # Closed forms of the circle; only rounding is left.
    assert a == b == pytest.approx((0.75 * load * radius / modulus) ** (1 / 3), rel=1e-13)
    assert contact.approach(load) == pytest.approx(a**2 / radius, rel=1e-13)
    assert contact.maximum_pressure(load) == pytest.approx(1.5 * load / (math.pi * a**2), rel=1e-13)


@given(st.floats(1.001, 1e5))
def test_ellipticity_solves_the_equation_of_the_textbooks(ratio: float) -> None:
    """F = [(k^2 + 1) E - 2 K] / [(k^2 - 1) E], written with other integrals than the program uses."""
    k = ellipse_numbers((1.0, ratio)).ellipticity
    m = 1.0 - 1.0 / k**2
    first, second = ellipk(m), ellipe(m)
    right = ((k**2 + 1.0) * second - 2.0 * first) / ((k**2 - 1.0) * second)
    # The differences cancel digits as 1/(k - 1)^2 near the circle: 1e-16 / (7e-4)^2.
    assert right == pytest.approx((ratio - 1.0) / (ratio + 1.0), abs=1e-9)


@given(st.floats(1.0, 35.0))
def test_close_to_the_fit_of_hamrock_and_brewe(ratio: float) -> None:
    """k = 1.0339 (B/A)^0.636, which its authors made for k from 1 to 10; at a circle it is 3.4 % off."""
    assert ellipse_numbers((1.0, ratio)).ellipticity == pytest.approx(1.0339 * ratio**0.636, rel=0.035)


@given(RATIOS, CURVATURE)
def test_planes_may_be_swapped_and_size_does_not_matter(ratio: float, curvature: float) -> None:
    there, back = ellipse_numbers((curvature, curvature * ratio)), ellipse_numbers((ratio, 1.0))
    # The ratio is rounded once more; the ellipticity of a circle goes as the root of nothing, linearly.
    assert there.ellipticity == pytest.approx(back.ellipticity, rel=1e-12)
    assert there.approach == pytest.approx(back.approach, rel=1e-12)


@given(st.floats(1.0, 9e4), st.floats(1.01, 1.1))
def test_more_difference_makes_a_longer_ellipse(ratio: float, more: float) -> None:
    less, longer = ellipse_numbers((1.0, ratio)), ellipse_numbers((1.0, ratio * more))
    assert longer.ellipticity > less.ellipticity
    assert longer.semi_major > less.semi_major
    assert longer.semi_minor < less.semi_minor
    assert longer.approach < less.approach


@pytest.mark.parametrize("nearness", [1e-3, 1e-6, 1e-9])
def test_nearly_a_circle(nearness: float) -> None:
    """F -> 0: k = 1 + 4 F/3, a* = 1 + 2 F/3, b* = 1 - 2 F/3, delta* = 1 - F^2/9 at most."""
    difference = nearness / (2.0 + nearness)
    found = ellipse_numbers((1.0, 1.0 + nearness))
    # The next terms of the series are of the size of F^2.
    assert found.ellipticity - 1.0 == pytest.approx(4.0 / 3.0 * difference, rel=2 * difference + 1e-6)
    assert found.semi_major - 1.0 == pytest.approx(2.0 / 3.0 * difference, rel=2 * difference + 1e-6)
    assert found.semi_minor - 1.0 == pytest.approx(-2.0 / 3.0 * difference, rel=2 * difference + 1e-6)
    assert 0.0 <= 1.0 - found.approach + 4e-16 <= difference**2 + 1e-15


@given(LOAD, st.floats(0.501, 0.6), st.floats(1e-3, 0.1))
def test_pressure_carries_the_load_and_the_approach_inverts(load: float, conformity: float, diameter: float) -> None:
    contact = ball_in_groove(diameter, conformity)
    a, b = contact.semi_axes(load)
    # Half an ellipsoid: two thirds of the largest pressure on average. Rounding of powers.
    assert 2.0 / 3.0 * contact.maximum_pressure(load) * math.pi * a * b == pytest.approx(load, rel=1e-12)
    assert contact.load(contact.approach(load)) == pytest.approx(load, rel=1e-12)


@given(LOAD)
def test_work_is_stored(load: float) -> None:
    """The work of the load over the approach is 2/5 Q delta: positive, and all of it elastic."""
    contact = ball_in_groove(4e-3, 0.52)
    approach = contact.approach(load)
    work = quad(contact.load, 0.0, approach)[0]
    assert work == pytest.approx(0.4 * load * approach, rel=1e-8)  # accuracy asked of quad


def test_arrays_are_taken() -> None:
    contact = ball_in_groove(4e-3, 0.52)
    loads = np.array([0.0, 1.0, 8.0])
    assert contact.approach(loads) == pytest.approx(contact.approach(1.0) * np.array([0.0, 1.0, 4.0]))
    assert contact.semi_axes(loads)[0] == pytest.approx(contact.semi_axes(1.0)[0] * np.array([0.0, 1.0, 2.0]))


@pytest.mark.parametrize(
    "curvatures",
    [
        pytest.param(Curvatures((200.0, 0.0), (0.0, 0.0)), id="cylinder on plane"),
        pytest.param(Curvatures((200.0, 200.0), (-250.0, 0.0)), id="hollow beyond the ball"),
        pytest.param(Curvatures((0.0, 0.0), (0.0, 0.0)), id="planes"),
        pytest.param(Curvatures((200.0, 1e-8), (0.0, 0.0)), id="as good as a line"),
        pytest.param(Curvatures((math.nan, 1.0), (0.0, 0.0)), id="not a number"),
        pytest.param(Curvatures((math.inf, 1.0), (0.0, 0.0)), id="infinite"),
    ],
)
def test_no_contact_at_a_point_is_refused(curvatures: Curvatures) -> None:
    with pytest.raises(InputError, match="curvatures"):
        point_contact(curvatures, BEARING_STEEL, BEARING_STEEL)


@pytest.mark.parametrize("conformity", [0.49, 0.5, 0.0, -0.52, math.nan])
def test_groove_narrower_than_the_ball_is_refused(conformity: float) -> None:
    with pytest.raises(InputError, match=r"conformity above 0\.5"):
        ball_in_groove(4e-3, conformity)


def test_materials_are_checked() -> None:
    with pytest.raises(InputError, match="elastic_modulus"):
        Material(-1.0, 0.3)
    with pytest.raises(InputError, match="poisson_ratio"):
        Material(2e11, 0.5)
    with pytest.warns(ValidityWarning, match="50 GPa|50000"):
        Material(205.8e3, 0.3)  # N/mm² written as Pa
