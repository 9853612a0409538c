"""Contacts, cycles, load distribution, rating and life of a ball screw against closed forms, limits and symmetry."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad

from feeddrive.errors import InputError, ValidityWarning
from feeddrive.parts.life.consumed_life import consumed_life, rigid_nut_forces
from feeddrive.parts.life.life import (
    rated_revolutions,
    rating_of_test,
    running_time,
    survival,
)
from feeddrive.parts.life.life_exponents import BALL_SCREW, LifeExponents
from feeddrive.parts.life.rating import combined_rating, double_nut_share, material_constant_of_test, rating
from feeddrive.parts.life.stress_cycles import (
    effective_screw_groove,
    nut_cycles,
    screw_cycles,
    screw_groove_per_turn,
    stressed_screw_groove,
)
from feeddrive.parts.life.subsurface_shear import (
    axis_stresses,
    greatest_shear_on_axis,
    greatest_shear_under_line,
    line_shear,
)
from feeddrive.parts.screw.load_distribution import NutBody, load_distribution, nut_body
from feeddrive.parts.screw.screw_contact import BallTrack, contact_constant, nut_contact, screw_contact
from feeddrive.recording.recording import Recording

TRACK = BallTrack(3.175e-3, 25.5e-3, 0.55, math.radians(45), 6e-3, 2.5)
BODY = nut_body(TRACK, 0.04)


@pytest.mark.parametrize("conformity", [0.49, 0.5, 0.0, math.nan, 1.2])
def test_impossible_conformity_is_refused(conformity: float) -> None:
    with pytest.raises(InputError, match="conformity"):
        dataclasses.replace(TRACK, conformity=conformity)


def test_usual_slips_of_a_unit_are_told() -> None:
    with pytest.raises(InputError, match="contact_angle"):
        dataclasses.replace(TRACK, contact_angle=45.0)
    with pytest.raises(InputError, match="ball_diameter"):
        dataclasses.replace(TRACK, ball_diameter=0.0159)
    with pytest.warns(ValidityWarning, match="turns"):
        dataclasses.replace(TRACK, turns=40.0)


def test_curvatures_are_the_difference_function_of_the_source() -> None:
    """Eq. (14) of paper 001 is the curvature difference: screw upper signs, nut lower signs."""
    reach, pitch, conformity = TRACK.ball_diameter * math.cos(TRACK.contact_angle), TRACK.pitch_diameter, 0.55
    for contact, sign in ((screw_contact(TRACK), 1.0), (nut_contact(TRACK), -1.0)):
        numerator = sign * reach * (2 * conformity - 1) + pitch
        denominator = -sign * reach * (2 * conformity - 1) + pitch * (4 * conformity - 1)
        assert contact.curvatures.difference == pytest.approx(numerator / denominator, rel=1e-13)


def test_far_screw_and_nut_contacts_are_alike() -> None:
    wide = dataclasses.replace(TRACK, pitch_diameter=0.19, ball_diameter=1e-4 * 6)
    ratio = screw_contact(wide).constant / nut_contact(wide).constant
    # gamma is 0.002: both contacts differ from a straight groove by that much.
    assert ratio == pytest.approx(1.0, abs=2 * wide.curvature_ratio)
    assert contact_constant(wide) == pytest.approx(2 * nut_contact(wide).constant, rel=2 * wide.curvature_ratio)


@given(st.floats(0.02, 1.0), st.floats(0.0, 20.0))
def test_axis_stresses_are_bounded_and_fade(ratio: float, depth: float) -> None:
    across, rolling, into = axis_stresses(ratio, depth)
    assert -1.0 - 1e-12 <= into <= min(across, rolling) + 1e-9
    # At the surface s_across + s_rolling = -(1 + 2 nu) p_max for every ellipse, and only less below.
    assert across + rolling >= -1.6 - 1e-9


def test_axis_stresses_of_a_circle_and_a_line() -> None:
    z = 0.7
    across, rolling, into = axis_stresses(1.0, z)
    radial = -1.3 * (1.0 - z * math.atan(1.0 / z)) + 0.5 / (1.0 + z**2)  # Huber's closed form
    assert (across, rolling, into) == pytest.approx((radial, radial, -1.0 / (1.0 + z**2)), abs=1e-13)
    across, rolling, into = axis_stresses(1e-4, z)
    root = math.sqrt(1.0 + z**2)
    line = (-0.6 * (root - z), -((1 + 2 * z**2) / root - 2 * z), -1.0 / root)
    assert (across, rolling, into) == pytest.approx(line, abs=2e-4)  # first order in b/a


def test_axis_stresses_by_superposition_of_point_loads() -> None:
    """Boussinesq's point loads over the ellipse, in polar form: for (x, y) = r (a cos, b sin)."""
    ratio, depth, poisson = 0.25, 0.7, 0.3
    a, b, z = 1.0 / ratio, 1.0, depth

    def stress(radius: float, angle: float) -> float:
        x, y = radius * a * math.cos(angle), radius * b * math.sin(angle)
        r2, pressure = x * x + y * y, math.sqrt(1.0 - radius**2)
        R = math.sqrt(r2 + z * z)
        first = 3 * y * y * z / R**5
        second = (1 - 2 * poisson) * (
            (y * y - x * x) / (max(r2, 1e-30) * R * (R + z)) + z * x * x / (max(r2, 1e-30) * R**3)
        )
        return -(first - second) / (2 * math.pi) * pressure * radius * a * b

    angles = (np.arange(64) + 0.5) * 2 * math.pi / 64
    value = np.mean([2 * math.pi * quad(stress, 0, 1, args=(angle,), epsabs=1e-9)[0] for angle in angles])
    assert axis_stresses(ratio, depth)[1] == pytest.approx(value, abs=1e-7)  # quadrature


@pytest.mark.parametrize("friction", [0.0, 0.1, 0.4])
def test_line_shear_by_superposition_of_line_loads(friction: float) -> None:
    x, z = 0.35, 0.6

    def parts(s: float) -> tuple[float, float, float]:
        d, p = x - s, math.sqrt(1.0 - s * s)
        kernel = -2.0 / math.pi * p * (z + friction * d) / (d * d + z * z) ** 2
        return kernel * d * d, kernel * z * z, kernel * d * z

    along, into, shear = (quad(lambda s, i=i: parts(s)[i], -1, 1, epsabs=1e-11)[0] for i in range(3))
    tau = math.hypot(0.5 * (along - into), shear)
    assert float(line_shear(np.array(x), np.array(z), friction)) == pytest.approx(tau, abs=1e-8)  # quadrature


def test_ellipse_tends_to_the_line() -> None:
    flat, line = greatest_shear_on_axis(1e-4), greatest_shear_under_line(0.0)
    assert flat.relative_stress == pytest.approx(line.relative_stress, abs=2e-4)
    assert flat.relative_depth == pytest.approx(line.relative_depth, abs=1e-3)


def test_shear_rises_to_the_surface_with_traction() -> None:
    peaks = [greatest_shear_under_line(friction) for friction in (0.0, 0.05, 0.1, 0.2, 0.3)]
    assert np.all(np.diff([peak.relative_depth for peak in peaks]) < 0.0)
    assert np.all(np.diff([peak.relative_stress for peak in peaks]) > 0.0)
    surface = greatest_shear_under_line(0.5)
    assert (surface.relative_stress, surface.relative_depth) == pytest.approx((0.5, 0.0), abs=1e-9)


@given(st.floats(1e-3, 2.0))
def test_cycles_against_stroke(stroke: float) -> None:
    assert nut_cycles(TRACK, 2 * stroke) == pytest.approx(2 * nut_cycles(TRACK, stroke), rel=1e-12)
    longest = screw_cycles(TRACK, 10.0)
    assert screw_cycles(TRACK, stroke) <= longest * (1 + 1e-12)
    if stroke >= TRACK.loaded_length:
        assert screw_cycles(TRACK, stroke) == pytest.approx(longest, rel=1e-12)


def test_effective_groove_lies_between_plateau_and_whole() -> None:
    for stroke in (0.003, 0.015, 0.3):
        whole = stressed_screw_groove(TRACK, stroke)
        assert effective_screw_groove(TRACK, stroke, 3.6) < whole
        # With an exponent of 1 the ramps count half.
        half = screw_groove_per_turn(TRACK) / TRACK.lead * max(stroke, TRACK.loaded_length)
        assert effective_screw_groove(TRACK, stroke, 1.0) == pytest.approx(half, rel=1e-12)


@given(st.floats(1.0, 1e6), st.floats(1.5, 14.0))
def test_ball_loads_sum_to_the_load(force: float, turns: float) -> None:
    body = nut_body(dataclasses.replace(TRACK, turns=turns), 0.04)
    loads = load_distribution(body, force)
    assert loads.ball_loads.sum() * body.track.axial_part == pytest.approx(force, rel=1e-9)
    assert np.all(loads.ball_loads >= 0.0)
    assert loads.relative.mean() == pytest.approx(1.0, rel=1e-12)


def test_loads_fall_away_from_the_force() -> None:
    loads = load_distribution(BODY, 13.5e3).relative
    assert np.all(np.diff(loads) < 0.0)


def test_stiff_bodies_share_evenly() -> None:
    with pytest.warns(ValidityWarning, match="elastic_modulus"):
        stiff = NutBody(TRACK, BODY.screw_section, BODY.nut_section, BODY.contact_constant, 206e15)
    assert load_distribution(stiff, 5e3).relative == pytest.approx(np.ones(TRACK.balls), abs=1e-5)


def test_distribution_meets_the_continuum() -> None:
    """At a small load the balls are soft: constant stiffness and a continuum are then exact to one over the count."""
    loads = load_distribution(BODY, 10.0)
    pitch = TRACK.loaded_length / TRACK.balls
    normal = 10.0 / (TRACK.balls * TRACK.axial_part)
    ball = 1.5 * normal ** (1 / 3) * TRACK.axial_part**2 / BODY.contact_constant
    compliance = (1.0 / BODY.screw_section + 1.0 / BODY.nut_section) / BODY.elastic_modulus
    product = math.sqrt(ball / pitch * compliance) * TRACK.loaded_length
    greatest, least = product / math.tanh(product), product / math.sinh(product)
    loads = loads.relative
    assert loads.max() - 1.0 == pytest.approx(greatest - 1.0, rel=0.03)
    assert 1.0 - loads.min() == pytest.approx(1.0 - least, rel=0.03)


def test_nut_without_a_body_is_refused() -> None:
    with pytest.raises(InputError, match="outer_diameter"):
        nut_body(TRACK, 0.028)
    with pytest.raises(InputError, match="force"):
        load_distribution(BODY, 0.0)


@given(st.floats(1e2, 1e6), st.floats(1e2, 1e6))
def test_combined_rating_is_the_product_of_survivals(first: float, second: float) -> None:
    combined = combined_rating((first, second))
    assert 0.0 < combined < min(first, second) * (1 + 1e-12)
    w = BALL_SCREW.product
    total = (combined / first) ** w + (combined / second) ** w
    assert total == pytest.approx(1.0, rel=1e-9)


def test_material_constant_gives_back_the_tested_rating() -> None:
    loads = load_distribution(BODY, 13.5e3)
    constant = material_constant_of_test(TRACK, loads, 0.288, 9636.0)
    found = rating(TRACK, loads, 0.288, constant)
    assert found.pair == pytest.approx(9636.0, rel=1e-12)
    assert 0.0 < found.nut_share < 1.0
    assert combined_rating((found.screw, found.nut)) == pytest.approx(found.pair, rel=1e-12)


def test_nut_rating_does_not_depend_on_the_stroke() -> None:
    loads = load_distribution(BODY, 13.5e3)
    assert rating(TRACK, loads, 0.01, 200.0).nut == pytest.approx(rating(TRACK, loads, 1.0, 200.0).nut, rel=1e-12)


@given(st.floats(1e3, 1e5), st.floats(0.05, 0.5))
def test_life_and_rating_are_inverse(capacity: float, share: float) -> None:
    revolutions = rated_revolutions(capacity, share * capacity)
    assert rating_of_test(share * capacity, revolutions) == pytest.approx(capacity, rel=1e-12)
    assert survival(revolutions, revolutions) == pytest.approx(0.9, rel=1e-12)


def test_life_at_the_edges() -> None:
    assert rated_revolutions(1e4, 0.0) == math.inf
    assert rated_revolutions(1e4, 1e-290) == math.inf
    with pytest.warns(ValidityWarning, match="1.49 of the rating"):
        rated_revolutions(9037.0, 13.5e3)
    with pytest.raises(InputError, match="force"):
        rated_revolutions(1e4, -1.0)
    assert running_time(480.0, 480.0 * math.pi / 30) == pytest.approx(60.0, rel=1e-12)


@given(st.lists(st.tuples(st.floats(-500, 500), st.floats(-2e4, 2e4)), min_size=4, max_size=30), st.integers(1, 2))
def test_consumed_life_adds_up(samples: list[tuple[float, float]], cut: int) -> None:
    angle, force = (np.array(column) for column in zip(*samples, strict=True))
    loads = rigid_nut_forces(force, 3e3)
    whole = consumed_life(angle, loads, 9.6e3)
    first = consumed_life(angle[: cut + 1], loads[:, : cut + 1], 9.6e3)
    second = consumed_life(angle[cut:], loads[:, cut:], 9.6e3)
    assert whole.total == pytest.approx(first.total + second.total, rel=1e-9, abs=1e-300)
    assert np.all(np.diff(whole.used, axis=1) >= 0.0)


def test_consumed_life_of_a_constant_load_is_the_rated_life() -> None:
    """One million revolutions back and forth at F: every nut has used (F/C)^3; both together live (C_d/F)^3."""
    angle = 2 * math.pi * 1e6 * np.array([0.0, 0.25, 0.0, 0.5])
    used = consumed_life(angle, np.full((2, 4), 3e3), 9636.0)
    assert used.revolutions[-1] == pytest.approx(1e6, rel=1e-12)
    assert used.total == pytest.approx([(3e3 / 9636.0) ** 3] * 2, rel=1e-12)
    rated = rated_revolutions(9636.0 * double_nut_share(), 3e3)
    assert used.repetitions * 1e6 == pytest.approx(rated, rel=1e-12)


def test_consumed_life_along_a_recording() -> None:
    """A recorded motion, screw and motor on one shaft: the torque of row i turns the screw from sample i to i + 1."""
    time = np.arange(1000) * 1e-3
    angle = 20.0 * np.sin(2 * math.pi * time)
    recording = Recording("run", time, {"motor_angle": angle, "motor_torque": 3.0 * np.cos(2 * math.pi * time)}, 1e-3)
    force = recording["motor_torque"] * 2 * math.pi / 6e-3
    whole = consumed_life(recording["motor_angle"], rigid_nut_forces(force, 3e3), 9.6e3)
    # A full period: 4 amplitudes, less the last of 1000 steps; the two directions load the two nuts alike.
    assert whole.revolutions[-1] == pytest.approx(80.0 / (2 * math.pi), rel=2e-3)
    assert whole.total[0] == pytest.approx(whole.total[1], rel=0.01)
    first = recording.between(0.0, 0.25)
    early = consumed_life(first["motor_angle"], rigid_nut_forces(force[: len(first)], 3e3), 9.6e3)
    assert early.total == pytest.approx(whole.used[:, len(first) - 1], rel=1e-12)


def test_a_screw_at_rest_uses_no_life() -> None:
    used = consumed_life(np.zeros(3), rigid_nut_forces(np.array([1e3, -1e3, 0.0]), 2e3), 9e3)
    assert used.total == pytest.approx([0.0, 0.0], abs=0.0)
    assert used.repetitions == math.inf


@pytest.mark.parametrize(
    ("angle", "force"),
    [([0.0], [1.0]), ([0.0, 1.0], [1.0]), ([0.0, math.nan], [1.0, 1.0]), ([0.0, 1.0], [1.0, -1.0])],
)
def test_unusable_recordings_are_refused(angle: list[float], force: list[float]) -> None:
    with pytest.raises(InputError):
        consumed_life(np.array(angle), np.array(force), 9e3)


def test_exponents_outside_their_range_are_refused() -> None:
    with pytest.raises(InputError, match="slope"):
        LifeExponents(3.0, 0.0)
