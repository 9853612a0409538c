"""Friction of bearings and viscosity of oils: limits, proportions, the printed numbers of the laws."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from feeddrive.errors import InputError, ValidityWarning
from feeddrive.parts.bearings.bearing_friction import (
    ANGULAR_CONTACT,
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
from feeddrive.parts.lubricant import Lubricant

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


@pytest.mark.parametrize("kind", (DEEP_GROOVE, ANGULAR_CONTACT, THRUST), ids=lambda kind: kind.name)
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
    assert oil.viscosity(temperature + 1.0) < oil.viscosity(temperature)
