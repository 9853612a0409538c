"""Friction of bearings and viscosity of oils: limits, proportions, the printed numbers of the laws."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from feeddrive.errors import InputError, ValidityWarning
from feeddrive.parts.bearings.bearing_friction import (
    ANGULAR_CONTACT,
    BALL_BEARING_TYPES,
    DEEP_GROOVE,
    RESTING_PRODUCT,
    THRUST,
    BallBearing,
    Lubrication,
    friction_torque,
    load_torque,
    static_load,
    viscous_torque,
)
from feeddrive.parts.lubricant import ISO_GRADES, MINERAL_OILS, Lubricant, mineral_oil

RPM = math.pi / 30
BEARING = BallBearing(ANGULAR_CONTACT, 0.022, 3850.0)


def test_viscous_torque_in_the_units_of_the_handbook() -> None:
    # 1e-7 * 3.3 * (32 * 500)^(2/3) * 22^3 N mm.
    expected = 1e-7 * 3.3 * 16_000.0 ** (2 / 3) * 22.0**3 * 1e-3
    assert viscous_torque(3.3, 32e-6, 500 * RPM, 0.022) == pytest.approx(expected, rel=1e-12)
    assert viscous_torque(3.3, 32e-6, -500 * RPM, 0.022) == pytest.approx(expected, rel=1e-12)


def test_slow_bearings_keep_their_viscous_torque() -> None:
    slow = [viscous_torque(2.0, 100e-6, speed * RPM, 0.03) for speed in (0.0, 5.0, 19.9)]
    assert slow == pytest.approx([160e-7 * 2.0 * 27_000.0 * 1e-3] * 3, rel=1e-12)
    above = viscous_torque(2.0, 100e-6, 1.0001 * RESTING_PRODUCT / 100 * RPM, 0.03)
    # 2000^(2/3) = 158.74: the source's two branches meet within 0.8 %.
    assert above == pytest.approx(slow[0], rel=0.008)


@given(st.floats(100.0, 5e3), st.floats(1e-5, 5e-4))
def test_viscous_torque_grows_with_speed_and_viscosity(speed: float, viscosity: float) -> None:
    here = viscous_torque(2.0, viscosity, speed * RPM, 0.03)
    faster = viscous_torque(2.0, viscosity, 2 * speed * RPM, 0.03)
    # The source's branches meet within 0.8 %.
    assert faster >= here * (1 - 0.008)
    assert viscous_torque(2.0, 2 * viscosity, speed * RPM, 0.03) == pytest.approx(faster, rel=1e-12)


@given(st.floats(1.0, 300.0))
def test_load_torque_grows_as_the_power_1_33(force: float) -> None:
    ratio = load_torque(BEARING, 2 * force) / load_torque(BEARING, force)
    assert ratio == pytest.approx(2.0**1.33, rel=1e-9)


def test_load_torque_in_the_units_of_the_handbook() -> None:
    # 0.001 (0.46 * 300 / 3850)^0.33 * 0.9 * 300 cot(15 deg) * 22 mm.
    expected = 0.001 * (0.46 * 300 / 3850) ** 0.33 * 270 / math.tan(math.radians(15)) * 0.022
    assert load_torque(BEARING, 300.0) == pytest.approx(expected, rel=1e-12)
    deep = BallBearing(DEEP_GROOVE, 0.04, 1e4)
    assert load_torque(deep, 0.0, 1e3) == pytest.approx(0.0005 * 0.1**0.55 * 1e3 * 0.04, rel=1e-12)
    thrust = BallBearing(THRUST, 0.04, 1e4, math.radians(60))
    assert load_torque(thrust, 1e3) == pytest.approx(0.0008 * 0.1**0.33 * 1e3 * 0.04, rel=1e-12)


@pytest.mark.parametrize("kind", BALL_BEARING_TYPES, ids=lambda kind: kind.name)
def test_unloaded_bearings_have_viscous_torque_alone(kind: object) -> None:
    bearing = BallBearing(kind, 0.03, 1e4)  # type: ignore[arg-type]
    for lubrication in Lubrication:
        torque = friction_torque(bearing, lubrication, 32e-6, 1000 * RPM, 0.0)
        factor = bearing.kind.viscous_factors[lubrication]
        assert torque == viscous_torque(factor, 32e-6, 1000 * RPM, 0.03)


def test_static_load_is_never_below_the_radial_one() -> None:
    for kind in (DEEP_GROOVE, ANGULAR_CONTACT):
        assert static_load(BallBearing(kind, 0.03, 1e4), 10.0, 1e3) == 1e3
    steep = BallBearing(ANGULAR_CONTACT, 0.03, 1e4, math.radians(60))
    assert static_load(steep, 500.0, 0.0) == 500.0
    assert static_load(steep, 500.0, 100.0) == pytest.approx(500 + 230 * math.sqrt(3), rel=1e-12)


def test_overload_is_told_and_nonsense_refused() -> None:
    with pytest.warns(ValidityWarning, match="static rating"):
        load_torque(BEARING, 2e4)
    with pytest.raises(InputError, match="axial"):
        load_torque(BEARING, -1.0)
    with pytest.raises(InputError, match="viscosity"):
        viscous_torque(2.0, 32.0, 1.0, 0.03)  # mm^2/s for m^2/s
    with pytest.raises(InputError, match="mean_diameter"):
        BallBearing(ANGULAR_CONTACT, 22.0, 1e4)


@given(st.floats(8e-6, 9e-4), st.floats(0.05, 0.2), st.floats(-10.0, 120.0))
def test_viscosity_meets_its_points_and_falls(at_40: float, share: float, temperature: float) -> None:
    oil = Lubricant(at_40, max(share * at_40, 2.5e-6))
    assert oil.viscosity(40.0) == pytest.approx(oil.viscosity_40, rel=1e-9)
    assert oil.viscosity(100.0) == pytest.approx(oil.viscosity_100, rel=1e-9)
    assert oil.viscosity_slope(temperature) < 0.0


@given(st.sampled_from(sorted(MINERAL_OILS)), st.floats(-15.0, 80.0))
def test_slope_is_the_derivative(grade: int, temperature: float) -> None:
    oil = mineral_oil(grade)
    step = 1e-3
    difference = (oil.viscosity(temperature + step) - oil.viscosity(temperature - step)) / (2 * step)
    # Central difference: error of third derivative times step^2 / 6 below 1e-8, rounding 1e-10.
    assert oil.viscosity_slope(temperature) == pytest.approx(difference, rel=1e-6)


# From 40 and 100 degC to the viscosity index, ASTM D2270: range of y = nu_100, then a, b, c of L and d, e, f of H,
# L = a y^2 + b y + c the viscosity at 40 degC of index 0, H = d y^2 + e y + f that of index 100 [mm^2/s].
D2270 = """
2.0  3.8  1.14673  1.7576    -0.109  0.84155  1.5521  -0.077
3.8  4.4  3.38095 -15.4952   33.196  0.78571  1.7929  -0.183
4.4  5.0  2.5000  -7.2143    13.812  0.82143  1.5679   0.119
5.0  6.4  0.10100  16.6350  -45.469  0.04985  9.1613 -18.557
6.4  7.0  3.35714 -23.5643   78.466  0.22619  7.7369 -16.656
7.7  9.0  0.41858  16.1558  -56.040  0.05794 10.5156 -28.240
9.0 12.0  0.88779   7.5527  -16.600  0.26665  6.7015 -10.810
12.0 15.0 0.76720  10.7972  -38.180  0.20073  8.4658 -22.490
18.0 22.0 0.97256   5.2500   -0.980  0.24504  7.4160 -16.730
"""


@pytest.mark.parametrize("grade", MINERAL_OILS)
def test_typical_oils_have_a_viscosity_index_near_100(grade: int) -> None:
    warm = MINERAL_OILS[grade]
    rows = [[float(word) for word in line.split()] for line in D2270.strip().splitlines()]
    _, _, *factors = next(row for row in rows if row[0] <= warm < row[1])
    low, high = (float(np.polyval(part, warm)) for part in (factors[:3], factors[3:]))
    # Linear from 0 to 100; above 100 the standard bends, by less than one unit at 101.
    assert 95.0 < 100.0 * (low - grade) / (low - high) < 101.0


def test_density_and_dynamic_viscosity() -> None:
    oil = mineral_oil(32)
    assert oil.density(15.0) == 870.0
    assert oil.density(40.0) == pytest.approx(870.0 * (1 - 6.7e-4 * 25), rel=1e-12)
    assert oil.dynamic_viscosity(40.0) == pytest.approx(32e-6 * oil.density(40.0), rel=1e-9)


def test_outside_of_the_law_is_told() -> None:
    with pytest.warns(ValidityWarning, match="Walther"):
        mineral_oil(32).viscosity(160.0)
    with pytest.raises(InputError, match="absolute zero"):
        mineral_oil(32).viscosity(-300.0)
    with pytest.raises(InputError, match="no such ISO grade"):
        mineral_oil(56)  # as paper 000 prints
    with pytest.raises(InputError, match="no typical oil"):
        mineral_oil(1000)
    with pytest.raises(InputError, match="not thinner"):
        Lubricant(32e-6, 40e-6)
    assert set(MINERAL_OILS) <= {round(grade) for grade in ISO_GRADES}
