"""Slipping balls: limits, order and identities of the efficiencies, the exact inverse, the best contact angle."""

from __future__ import annotations

import math

import casadi as ca
import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from feeddrive.errors import InputError, ValidityWarning
from feeddrive.parts.screw.contact_angle_optimum import (
    best_contact_angle,
    friction_of_highest_efficiency,
    highest_efficiency,
    largest_lead_angle,
)
from feeddrive.parts.screw.screw_efficiency import (
    back_driving_efficiency,
    back_driving_loss,
    driving_efficiency,
    driving_loss,
    friction_from_torque,
    jamming_friction,
    preload_torque,
    relative_preload_torque,
    relative_torque,
)
from feeddrive.parts.screw.screw_friction import ScrewFriction, ScrewGeometry
from feeddrive.parts.screw.slip_angle import (
    groove_at,
    groove_of_screw,
    slip_angle,
    slip_angles_nut_drives,
    slip_angles_screw_drives,
    thread_angle,
)
from feeddrive.parts.screw.slip_forces import axial_force, screw_moment

LEAD_ANGLES = st.floats(math.radians(0.5), math.radians(44))
CONTACT_ANGLES = st.floats(math.radians(5), math.radians(89))
FRICTIONS = st.floats(1e-6, 0.3)

FINITE_DIGITS = 1e-12
"""Relative tolerance of two algebraic forms of one number: a few thousand roundings of 1e-16."""


@given(LEAD_ANGLES, CONTACT_ANGLES)
def test_no_friction_no_loss(alpha: float, beta: float) -> None:
    groove = groove_at(alpha, beta)
    assert driving_efficiency(groove, 0.0) == back_driving_efficiency(groove, 0.0) == 1.0
    assert relative_preload_torque(groove, 0.0) == 0.0


@given(LEAD_ANGLES, CONTACT_ANGLES, FRICTIONS)
def test_more_friction_less_efficiency(alpha: float, beta: float, f: float) -> None:
    groove = groove_at(alpha, beta)
    for efficiency in (driving_efficiency, back_driving_efficiency):
        assert efficiency(groove, 1.01 * f) < efficiency(groove, f) < 1.0


@given(LEAD_ANGLES, CONTACT_ANGLES, FRICTIONS)
def test_efficiency_is_that_of_a_square_thread(alpha: float, beta: float, f: float) -> None:
    groove = groove_at(alpha, beta)
    assume(f < 0.9 * jamming_friction(groove))
    delta, phi = float(thread_angle(groove)), math.atan(f)
    # Near jamming eta_a is the small difference of numbers near 1: absolute.
    assert driving_efficiency(groove, f) == pytest.approx(math.tan(delta) / math.tan(delta + phi), abs=FINITE_DIGITS)
    assert back_driving_efficiency(groove, f) == pytest.approx(
        math.tan(delta - phi) / math.tan(delta), abs=FINITE_DIGITS / math.tan(delta)
    )
    assert groove.a_n == pytest.approx(math.sin(delta) * math.cos(delta), rel=FINITE_DIGITS)
    assert groove.b_n == pytest.approx(math.sin(delta) ** 2, rel=FINITE_DIGITS)


@given(LEAD_ANGLES, CONTACT_ANGLES, FRICTIONS)
def test_efficiencies_are_as_printed(alpha: float, beta: float, f: float) -> None:
    """Eqs. (5) and (6) letter by letter."""
    groove = groove_at(alpha, beta)
    R, c = math.sqrt(math.cos(beta) ** 2 + math.tan(alpha) ** 2), math.cos(alpha) ** 2
    printed_a = 1 - f / (c * math.sin(beta) * (R + f * math.sin(beta)))
    printed_b = 1 - f / (c * (math.sin(beta) * R + f * (math.cos(beta) ** 2 + math.tan(alpha) ** 2)))
    # The printed forms are 1 less a share that grows to hundreds at flat contact angles.
    assert driving_efficiency(groove, f) == pytest.approx(printed_a, abs=FINITE_DIGITS * (1 + abs(1 - printed_a)))
    assert back_driving_efficiency(groove, f) == pytest.approx(printed_b, abs=FINITE_DIGITS * (1 + abs(1 - printed_b)))


@given(LEAD_ANGLES, CONTACT_ANGLES, FRICTIONS, st.floats(0.01, 0.4))
def test_efficiencies_follow_from_the_forces_on_a_ball(alpha: float, beta: float, f: float, r_a: float) -> None:
    """Moment and force, eqs. (3) and (4) as corrected: the ball size cancels."""
    groove = groove_at(alpha, beta)
    psi_a, psi_b = slip_angles_screw_drives(groove)
    moment = screw_moment(100.0, 0.02, alpha, beta, psi_b, r_a, f)
    work = axial_force(100.0, alpha, beta, psi_a, f) * 0.02 * math.tan(alpha)
    assert work / moment == pytest.approx(driving_efficiency(groove, f), abs=1e-10)
    psi_a, psi_b = slip_angles_nut_drives(groove)
    moment = screw_moment(100.0, 0.02, alpha, beta, psi_b, r_a, f)
    work = axial_force(100.0, alpha, beta, psi_a, f) * 0.02 * math.tan(alpha)
    assert moment / work == pytest.approx(back_driving_efficiency(groove, f), rel=1e-9, abs=1e-9)


@given(LEAD_ANGLES, CONTACT_ANGLES, FRICTIONS)
def test_lost_power_is_friction_force_times_sliding_speed(alpha: float, beta: float, f: float) -> None:
    groove, load, radius = groove_at(alpha, beta), 100.0, 0.02
    psi_a, psi_b = slip_angles_screw_drives(groove)
    speed = radius * math.tan(alpha)  # of the nut, at 1 rad/s
    lost = screw_moment(load, radius, alpha, beta, psi_b, 0.1, f) - axial_force(load, alpha, beta, psi_a, f) * speed
    assert lost == pytest.approx(
        f * load * speed * math.sqrt(1 + groove.tangent**2) / groove.slope, rel=1e-8, abs=1e-12
    )


@given(LEAD_ANGLES, CONTACT_ANGLES, FRICTIONS)
def test_back_driving_loses_less_than_driving(alpha: float, beta: float, f: float) -> None:
    """Of the force F r: the normal load is smaller while the load helps. So eta_b >= 2 - 1/eta_a."""
    groove = groove_at(alpha, beta)
    assume(f < jamming_friction(groove))
    assert back_driving_loss(groove, f) < driving_loss(groove, f)


@given(st.floats(0.5, 44), st.floats(0.001, 0.3))
def test_back_driving_efficiency_is_the_lower_one_below_the_best_angles(alpha: float, f: float) -> None:
    """eta_b < eta_a where delta is below 45 deg (flat thread), and the other way round."""
    for beta in (20.0, 45.0, 70.0, 85.0):
        groove = groove_at(math.radians(alpha), math.radians(beta))
        assume(f < 0.9 * jamming_friction(groove))
        delta = float(thread_angle(groove))
        assume(abs(delta - math.pi / 4) > 1e-6)
        lower = back_driving_efficiency(groove, f) < driving_efficiency(groove, f)
        assert lower == (delta < math.pi / 4)


@given(LEAD_ANGLES, CONTACT_ANGLES)
def test_jams_and_locks_where_it_says(alpha: float, beta: float) -> None:
    groove = groove_at(alpha, beta)
    assert driving_efficiency(groove, jamming_friction(groove)) == pytest.approx(0.0, abs=FINITE_DIGITS)
    locking = groove.b_n / groove.a_n
    assert back_driving_efficiency(groove, locking) == pytest.approx(0.0, abs=FINITE_DIGITS)
    assert back_driving_efficiency(groove, 1.1 * locking) < 0.0


def test_without_lead_the_efficiency_stays() -> None:
    """(1 - f)/(1 + f) at 45 deg contact angle."""
    assert driving_efficiency(groove_at(1e-9, math.pi / 4), 0.034) == pytest.approx((1 - 0.034) / 1.034, rel=1e-12)


@given(LEAD_ANGLES, CONTACT_ANGLES, st.floats(1e-12, 0.99))
def test_friction_is_recovered_from_its_torque(alpha: float, beta: float, share: float) -> None:
    """Over the whole range, from nothing to jamming."""
    groove = groove_at(alpha, beta)
    f = share * jamming_friction(groove)
    # Near jamming the torque is the reciprocal of a small difference: 1/(1 - share) roundings.
    assert friction_from_torque(relative_preload_torque(groove, f), groove) == pytest.approx(f, rel=1e-13 / (1 - share))


def test_stable_inverse_equals_the_printed_one() -> None:
    groove, t = groove_at(math.radians(4.44), math.pi / 4), 0.136
    a, b = groove.a_n, groove.b_n
    printed = a * (math.sqrt(1 + t**2 * b**2) - 1) / (t * b**2)
    # The printed form loses (t b)^-2 / 2 of 1e-16.
    assert friction_from_torque(t, groove) == pytest.approx(printed, rel=1e-13)
    assert friction_from_torque(0.0, groove) == 0.0


@given(st.floats(0.5, 43), st.floats(0.001, 0.1))
def test_no_contact_angle_beats_the_best(alpha_degrees: float, f: float) -> None:
    alpha = math.radians(alpha_degrees)
    angles = np.radians(np.linspace(1.0, 90.0, 1781))
    best = float(best_contact_angle(alpha, f))
    grooves = groove_at(alpha, angles)
    assert driving_efficiency(grooves, f).max() <= driving_efficiency(groove_at(alpha, best), f) + 1e-15
    if alpha < largest_lead_angle(f):
        assert driving_efficiency(groove_at(alpha, best), f) == pytest.approx(highest_efficiency(f), rel=FINITE_DIGITS)
        assert friction_of_highest_efficiency(highest_efficiency(f)) == pytest.approx(f, rel=1e-10)
    else:
        assert best == pytest.approx(math.pi / 2)


def test_arrays_numbers_and_expressions_agree() -> None:
    """One definition for all three."""
    lead, diameter, beta, f = ca.SX.sym("L"), ca.SX.sym("d"), ca.SX.sym("beta"), ca.SX.sym("f")
    groove = groove_of_screw(lead, diameter, beta)
    laws = [driving_efficiency(groove, f), back_driving_efficiency(groove, f), preload_torque(groove, f, 3e3, lead)]
    laws += [friction_from_torque(relative_torque(laws[2], 3e3, lead), groove)]
    found = ca.Function("laws", [lead, diameter, beta, f], laws)(0.01, 0.041, 0.8, 0.034)
    number = groove_of_screw(0.01, 0.041, 0.8)
    array = groove_of_screw(np.full(2, 0.01), 0.041, np.full(2, 0.8))
    for law, symbolic in zip((driving_efficiency, back_driving_efficiency), found[:2], strict=True):
        assert float(symbolic) == pytest.approx(law(number, 0.034), rel=1e-14)
        assert law(array, np.array([0.0, 0.034])) == pytest.approx([1.0, float(symbolic)], rel=1e-14)
    assert float(found[2]) == pytest.approx(preload_torque(number, 0.034, 3e3, 0.01), rel=1e-14)
    assert float(found[3]) == pytest.approx(0.034, rel=1e-14)


def test_slip_angle_is_the_lead_angle_seen_from_the_contact() -> None:
    groove = groove_at(0.1, 1.0)
    psi = float(slip_angle(groove))
    assert math.tan(psi) == pytest.approx(math.tan(0.1) / math.cos(1.0), rel=1e-14)
    assert slip_angles_screw_drives(groove) == (psi + math.pi, psi)
    assert slip_angles_nut_drives(groove) == (psi, psi - math.pi)


GOOD = {"lead": 0.01, "pitch_diameter": 0.041, "contact_angle": math.pi / 4}


@pytest.mark.parametrize(
    ("key", "value", "range_text"),
    [
        ("contact_angle", 0.0, "between 0° and 90°"),
        ("contact_angle", 1.6, "between 0° and 90°"),
        ("contact_angle", math.nan, "between 0° and 90°"),
        ("lead", 0.0, "between 0 mm and 1000 mm"),
        ("lead", -0.01, "between 0 mm and 1000 mm"),
        ("pitch_diameter", math.inf, "between 0 mm and 1000 mm"),
    ],
)
def test_impossible_geometry_is_refused_with_the_range(key: str, value: float, range_text: str) -> None:
    with pytest.raises(InputError, match=f"{key}.*{range_text}"):
        ScrewGeometry(**{**GOOD, key: value})


@pytest.mark.parametrize(("key", "value"), [("lead", 10.0 / 1e5), ("pitch_diameter", 0.41), ("contact_angle", 0.4)])
def test_unusual_geometry_is_said(key: str, value: float) -> None:
    with pytest.warns(ValidityWarning, match=f"{key}.*is usual"):
        ScrewGeometry(**{**GOOD, key: value})


@pytest.mark.parametrize("f", [-0.01, math.nan, 1.5])
def test_impossible_friction_is_refused(f: float) -> None:
    with pytest.raises(InputError, match=r"friction_coefficient.*between 0 and 1"):
        ScrewFriction(ScrewGeometry(**GOOD), f)


def test_friction_that_jams_is_refused() -> None:
    with (
        pytest.warns(ValidityWarning, match="unusual"),
        pytest.raises(InputError, match=r"jams this screw.*below 0\.994"),
    ):
        ScrewFriction(ScrewGeometry(**GOOD), 0.996)


def test_friction_from_impossible_torque_is_refused() -> None:
    geometry = ScrewGeometry(**GOOD)
    for preload, torque in ((0.0, 0.1), (-3.0, 0.1), (1e3, -0.1), (math.nan, 0.1), (1e3, math.nan)):
        with pytest.raises(InputError, match="is not possible"):
            geometry.friction_from(preload, torque)
