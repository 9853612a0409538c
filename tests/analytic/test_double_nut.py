"""Load sharing and torque of a preloaded double nut: equilibrium, limits, power in every quadrant."""

from __future__ import annotations

import math

import casadi as ca
import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from feeddrive.errors import InputError
from feeddrive.parts.screw.double_nut import (
    OPENING,
    friction_torque_backward,
    friction_torque_forward,
    rigid_sharing,
)
from feeddrive.parts.screw.screw_efficiency import back_driving_loss, driving_loss, jamming_friction, preload_torque
from feeddrive.parts.screw.screw_friction import ScrewFriction, ScrewGeometry
from feeddrive.parts.screw.slip_angle import groove_at

FORCES = st.floats(-5e4, 5e4)
PRELOADS = st.floats(0.0, 2e4)
SCREW = ScrewFriction(ScrewGeometry(0.01, 0.041, math.pi / 4), 0.034)


@given(FORCES, PRELOADS)
def test_shared_loads_balance_the_force(force: float, preload: float) -> None:
    nut_a, nut_b = rigid_sharing(force, preload)
    assert nut_a >= 0.0 and nut_b >= 0.0
    # 1e-8 N from holding the root just short of the opening, 1e-12 from rounding.
    assert nut_a - nut_b == pytest.approx(force, rel=1e-11, abs=1e-8)


@given(st.floats(-0.999, 0.999), st.floats(1.0, 2e4))
def test_rigid_preload_keeps_the_deflection(share: float, preload: float) -> None:
    nut_a, nut_b = rigid_sharing(share * OPENING * preload, preload)
    # Near the opening the small load is known to 1e-12 of the preload, its power 2/3 to 1e-8.
    assert nut_a ** (2 / 3) + nut_b ** (2 / 3) == pytest.approx(2 * preload ** (2 / 3), rel=1e-7)


@given(FORCES, PRELOADS)
def test_sharing_is_the_same_in_both_directions(force: float, preload: float) -> None:
    there, back = rigid_sharing(force, preload), rigid_sharing(-force, preload)
    assert there == pytest.approx(back[::-1], rel=1e-12, abs=1e-12)


@given(FORCES)
def test_without_preload_one_nut_carries_all(force: float) -> None:
    assert rigid_sharing(force, 0.0) == (max(force, 0.0), max(-force, 0.0))


def test_opens_at_two_root_two_times_the_preload() -> None:
    assert pytest.approx(2.828, abs=5e-4) == OPENING
    assert rigid_sharing(OPENING * 3e3, 3e3)[1] < 1e-12
    assert rigid_sharing(0.99 * OPENING * 3e3, 3e3)[1] > 1e-3
    assert rigid_sharing(1e4, 3e3)[0] == pytest.approx(1e4, rel=1e-11)


@given(FORCES, PRELOADS, st.floats(0.0, 0.5))
def test_never_creates_power_in_any_quadrant(force: float, preload: float, f: float) -> None:
    """Shaft power in is at least the axial power out, for both signs of force and speed."""
    groove = groove_at(0.077, math.pi / 4)
    assume(f < jamming_friction(groove))
    losses = driving_loss(groove, f), back_driving_loss(groove, f)
    nut_a, nut_b = rigid_sharing(force, preload)
    assert friction_torque_forward(nut_a, nut_b, 1.6e-3, *losses) >= 0.0
    assert friction_torque_backward(nut_a, nut_b, 1.6e-3, *losses) >= 0.0


@given(st.floats(10, 3e4), st.sampled_from([1.0, -1.0]), st.sampled_from([1.0, -1.0]))
def test_single_nut_has_its_efficiencies(force: float, direction: float, speed: float) -> None:
    radius = 0.01 / (2 * math.pi)
    torque = SCREW.torque(direction * force, speed)
    driving = direction * speed > 0
    ideal = direction * force * radius
    expected = ideal / SCREW.driving_efficiency if driving else ideal * SCREW.back_driving_efficiency
    assert torque == pytest.approx(expected, rel=1e-12)


@given(st.floats(0, 2e4), st.sampled_from([1.0, -1.0]))
def test_without_load_it_is_the_preload_torque(preload: float, speed: float) -> None:
    expected = preload_torque(SCREW.geometry.groove, 0.034, preload, 0.01)
    assert SCREW.torque(0.0, speed, preload) == pytest.approx(speed * expected, rel=1e-12)


@given(FORCES, PRELOADS)
def test_torque_is_odd_in_force_and_speed_together(force: float, preload: float) -> None:
    assert SCREW.torque(force, 1.0, preload) == pytest.approx(
        -SCREW.torque(-force, -1.0, preload), rel=1e-12, abs=1e-12
    )


def test_no_torque_at_rest_or_with_negative_preload() -> None:
    for force, speed, preload in ((1e3, 0.0, 0.0), (1e3, 1.0, -1.0), (math.nan, 1.0, 0.0)):
        with pytest.raises(InputError, match="no torque follows"):
            SCREW.torque(force, speed, preload)


@pytest.mark.parametrize("force", [-2e4, -8.4e3, -1.0, 0.0, 10.0, 4e3, 8.4e3, 8.5e3])
def test_expression_and_its_slope(force: float) -> None:
    """The slope that Newton uses is the one of the values, across the opening too."""
    F = ca.SX.sym("F")
    nut_a, nut_b = rigid_sharing(F, 3e3)
    law = ca.Function("law", [F], [nut_a, nut_b, ca.jacobian(nut_a, F)])
    found_a, found_b, slope = (float(value) for value in law(force))
    assert (found_a, found_b) == pytest.approx(rigid_sharing(force, 3e3), rel=1e-12, abs=1e-12)
    step = 1e-3
    difference = (rigid_sharing(force + step, 3e3)[0] - rigid_sharing(force - step, 3e3)[0]) / (2 * step)
    # Rounding of 1e4 N over 2 mN: 1e-9; curvature times step: 1e-7.
    assert slope == pytest.approx(float(difference), abs=1e-6)


@pytest.mark.parametrize("force", [0.0, 5.0, -5.0])
def test_slope_is_finite_without_preload(force: float) -> None:
    F, preload = ca.SX.sym("F"), ca.SX.sym("F0")
    slopes = ca.jacobian(ca.vertcat(*rigid_sharing(F, preload)), ca.vertcat(F, preload))
    assert np.all(np.isfinite(ca.Function("slopes", [F, preload], [slopes])(force, 0.0).full()))
