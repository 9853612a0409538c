"""Friction of bearings and viscosity of oils: limits, proportions, the printed numbers of the laws."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from feeddrive.parts.bearings.bearing_friction import RESTING_PRODUCT, palmgren_torque
from feeddrive.parts.lubricant import Lubricant

RPM = math.pi / 30


def test_viscous_torque_in_the_units_of_the_handbook() -> None:
    # 1e-7 * 3.3 * (32 * 500)^(2/3) * 22^3 N mm.
    expected = 1e-7 * 3.3 * 16_000.0 ** (2 / 3) * 22.0**3 * 1e-3
    assert palmgren_torque(3.3, 32e-6, 500 * RPM, 0.022) == pytest.approx(expected, rel=1e-12)


def test_slow_bearings_keep_their_palmgren_torque() -> None:
    slow = [palmgren_torque(2.0, 100e-6, speed * RPM, 0.03) for speed in (0.0, 5.0, 19.9)]
    assert slow == pytest.approx([160e-7 * 2.0 * 27_000.0 * 1e-3] * 3, rel=1e-12)
    above = palmgren_torque(2.0, 100e-6, 1.0001 * RESTING_PRODUCT / 100 * RPM, 0.03)
    # 2000^(2/3) = 158.74: the source's two branches meet within 0.8 %.
    assert above == pytest.approx(slow[0], rel=0.008)


@given(st.floats(100.0, 5e3), st.floats(1e-5, 5e-4))
def test_viscous_torque_grows_with_speed_and_viscosity(speed: float, viscosity: float) -> None:
    here = palmgren_torque(2.0, viscosity, speed * RPM, 0.03)
    faster = palmgren_torque(2.0, viscosity, 2 * speed * RPM, 0.03)
    # The source's branches meet within 0.8 %.
    assert faster >= here * (1 - 0.008)
    assert palmgren_torque(2.0, 2 * viscosity, speed * RPM, 0.03) == pytest.approx(faster, rel=1e-12)


@given(st.floats(8e-6, 9e-4), st.floats(0.05, 0.2), st.floats(-10.0, 120.0))
def test_viscosity_meets_its_points_and_falls(at_40: float, share: float, temperature: float) -> None:
    oil = Lubricant(at_40, max(share * at_40, 2.5e-6))
    assert oil.viscosity(40.0) == pytest.approx(oil.viscosity_40, rel=1e-9)
    assert oil.viscosity(100.0) == pytest.approx(oil.viscosity_100, rel=1e-9)
    assert oil.viscosity(temperature + 1.0) < oil.viscosity(temperature)
