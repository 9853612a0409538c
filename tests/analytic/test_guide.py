"""Ball guide: equilibrium, symmetry, limits, monotony, energy, stiffness as derivative, refusals."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from feeddrive.errors import InputError, ValidityWarning
from feeddrive.parts.guide.guide_carriage import carriage_friction, mean_slip_radius, table_friction
from feeddrive.parts.guide.guide_coefficients import SET_A, GuideCoefficients
from feeddrive.parts.guide.guide_equilibrium import (
    forces,
    guide_equilibrium,
    preload_force,
    unloading_force,
)
from feeddrive.parts.guide.guide_film import Oil, film_thickness
from feeddrive.parts.guide.guide_geometry import HSR_20R, HSR_30R, BallGuide

GUIDES = st.builds(
    BallGuide,
    ball_diameter=st.floats(2e-3, 10e-3),
    rail_conformity=st.floats(0.51, 0.56),
    carriage_conformity=st.floats(0.51, 0.56),
    contact_angle=st.floats(math.radians(35), math.radians(55)),
    preload_oversize=st.floats(0.0, 6e-6),
    balls_per_row=st.integers(8, 30),
)
LOADS = st.floats(-1000.0, 1000.0)
"""The smallest of GUIDES carries them below the pressure of a dent."""
SPEEDS = np.geomspace(1e-3, 2.0, 9)


@given(GUIDES, LOADS, LOADS)
def test_rows_carry_the_load(guide: BallGuide, vertical: float, lateral: float) -> None:
    found = guide_equilibrium(guide, vertical, lateral)
    held = forces(guide, found.displacement)
    scale = guide.balls_per_row * float(found.ball_load.max())
    # The displacement is found to 1e-14 of its scale, Q goes with its power 3/2.
    assert held == pytest.approx([vertical, lateral], abs=1e-9 * scale + 1e-9)
    assert np.all(found.ball_load >= 0.0)


@settings(max_examples=30)
@given(GUIDES, LOADS, LOADS)
def test_mirrored_loads_mirror_the_rows(guide: BallGuide, vertical: float, lateral: float) -> None:
    here = guide_equilibrium(guide, vertical, lateral)
    scale = max(float(here.ball_load.max()), 1e-6)
    for signs, order in (((-1, 1), [3, 2, 1, 0]), ((1, -1), [1, 0, 3, 2]), ((-1, -1), [2, 3, 0, 1])):
        there = guide_equilibrium(guide, signs[0] * vertical, signs[1] * lateral)
        # As exact as each equilibrium.
        assert there.ball_load == pytest.approx(here.ball_load[order], abs=1e-8 * scale)


@settings(max_examples=30)
@given(st.floats(0.0, 2e4), st.floats(1.0, 4e3))
def test_more_load_presses_harder_on_one_side_and_less_on_the_other(vertical: float, more: float) -> None:
    less, heavier = (guide_equilibrium(HSR_20R, load) for load in (vertical, vertical + more))
    assert heavier.displacement[0] > less.displacement[0]
    assert np.all(heavier.ball_load[2:] > less.ball_load[2:])
    assert np.all(heavier.ball_load[:2] <= less.ball_load[:2])


@settings(max_examples=40)
@given(GUIDES, LOADS, LOADS)
def test_stiffness_is_the_slope_of_the_load(guide: BallGuide, vertical: float, lateral: float) -> None:
    found = guide_equilibrium(guide, vertical, lateral)
    step = 1e-10
    numeric = np.column_stack(
        [(forces(guide, found.displacement + d) - forces(guide, found.displacement - d)) / (2 * step)
         for d in (np.array([step, 0.0]), np.array([0.0, step]))]
    )  # fmt: skip
    # Where a row just touches, its slope over the step stands for one of 0; elsewhere the step is small beside 3 µm.
    touching = 4 * guide.balls_per_row * 1.5 * math.sqrt(step) / guide.hertz_constant**1.5
    assert numeric == pytest.approx(found.stiffness, rel=1e-6, abs=touching)
    assert found.stiffness[0, 1] == pytest.approx(found.stiffness[1, 0], abs=1e-12 * found.stiffness[0, 0] + 1e-12)
    assert np.all(np.linalg.eigvalsh(found.stiffness) >= 0.0)


@settings(max_examples=30)
@given(LOADS.filter(lambda load: abs(load) > 1.0))
def test_work_of_the_load_is_stored(vertical: float) -> None:
    """Between no load and load the work of F_x is positive and at most load times way: stiffness does not fall to 0."""
    way = guide_equilibrium(HSR_30R, vertical).displacement[0]
    path = np.linspace(0.0, way, 41)
    work = np.trapezoid([forces(HSR_30R, np.array([x, 0.0]))[0] for x in path], path)
    assert 0.0 < work < vertical * way


@pytest.mark.parametrize("guide", [HSR_20R, HSR_30R], ids=["20", "30"])
def test_unloading_force_is_where_contact_is_lost(guide: BallGuide) -> None:
    force = unloading_force(guide)
    assert guide_equilibrium(guide, force * 1.000001).ball_load[0] == 0.0
    # Below, the approach left goes with the load left: 1e-3 of 3.5 µm, to the 3/2.
    assert 0.0 < guide_equilibrium(guide, force * 0.999).ball_load[0] < 1e-4 * guide_equilibrium(guide, 0).ball_load[0]


def test_without_preload_nothing_is_unloaded() -> None:
    guide = replace(HSR_20R, preload_oversize=0.0)
    assert preload_force(guide) == 0.0
    assert unloading_force(guide) == pytest.approx(0.0, abs=1e-6)  # rounding of A0 - A0
    free = carriage_friction(guide, SET_A, SPEEDS)
    assert np.all(free.total == 0.0)
    assert np.all(np.array(free.shares()) == 0.0)


def test_no_load_and_little_load_are_near() -> None:
    """F -> 0 is continuous, and even in the load."""
    here, near, opposite = (carriage_friction(HSR_20R, SET_A, SPEEDS, load).total for load in (0.0, 1e-3, -1e-3))
    assert near == pytest.approx(here, rel=1e-9)  # it goes with the square of the load: (1e-3 N / 700 N)^2
    assert near == pytest.approx(opposite, rel=1e-12)


@given(st.floats(0.0, 2e4), st.floats(0.0, 3e3), st.floats(1e-4, 3.0))
def test_friction_takes_power_and_rises_with_speed(vertical: float, lateral: float, speed: float) -> None:
    found = carriage_friction(HSR_20R, SET_A, np.array([-speed, 0.0, speed, 1.01 * speed]), vertical, lateral)
    assert np.all(found.total > 0.0)
    assert found.total[0] == found.total[2]
    assert found.viscous[1] == 0.0
    assert found.viscous[3] > found.viscous[2] > 0.0
    assert np.ptp(found.coulomb) == 0.0


@settings(max_examples=30)
@given(st.floats(1e3, 2e4), st.floats(100.0, 4e3))
def test_friction_rises_with_load(vertical: float, more: float) -> None:
    less, heavier = (carriage_friction(HSR_20R, SET_A, SPEEDS, load) for load in (vertical, vertical + more))
    assert np.all(heavier.rolling > less.rolling)
    assert np.all(heavier.viscous > less.viscous)
    assert np.all(heavier.slip > less.slip)


def test_scaling_of_the_parts() -> None:
    """Without preload one pair carries all: F_r ~ Q, F_s ~ Q^(5/3), F_v ~ Q^0.74."""
    guide = replace(HSR_30R, preload_oversize=0.0)
    one, two = (carriage_friction(guide, SET_A, SPEEDS, load) for load in (10.0, 11.0))
    balls = [guide_equilibrium(guide, load).ball_load[2] for load in (10.0, 11.0)]
    rise = math.log(balls[1] / balls[0])
    # a^4/d^4 terms of the slip radius; W^-0.07 of the film.
    assert np.log(two.rolling / one.rolling) / rise == pytest.approx(1.0, rel=1e-10)
    assert np.log(two.slip / one.slip) / rise == pytest.approx(5 / 3, rel=1e-3)
    assert np.log(two.viscous / one.viscous) / rise == pytest.approx(2 / 3 + 0.0699, abs=1e-3)


def test_slip_radius_of_a_small_ellipse() -> None:
    """<R_d> = [1 - (4/5) / (2 * 0.5098)] a^2 / d_b, 0.2154 of it at conformity 0.52."""
    diameter, a = 4e-3, 1e-6
    r = 2 * 0.52 / (2 * 0.52 + 1)
    assert mean_slip_radius(diameter, 0.52, a) == pytest.approx((1 - 0.4 / r) * a**2 / diameter, rel=1e-6)  # a^4 terms
    assert (1 - 0.4 / r) == pytest.approx(0.2154, abs=5e-5)


@given(st.floats(1e-5, 0.9e-3))
def test_slip_radius_against_the_integral_over_the_ellipse(a: float) -> None:
    """(13) corrected, times Hertz's pressure, over the whole ellipse by a plain sum."""
    diameter, f = 4e-3, 0.52
    r, half = 2 * f * diameter / (2 * f + 1), 0.5 * diameter
    u = (np.arange(4000) + 0.5) / 4000 * 2 * a - a
    lack = half - (np.sqrt(r**2 - u**2) - math.sqrt(r**2 - a**2) + math.sqrt(half**2 - a**2))
    chord = np.pi / 2 * (1 - u**2 / a**2)  # of the half ellipse over w, times b
    mean = np.sum(chord * lack) / np.sum(chord)
    assert mean_slip_radius(diameter, f, a) == pytest.approx(mean, rel=1e-6)  # midpoint rule, 1/4000^2 and rounding


def test_carriages_and_seals_add() -> None:
    one = carriage_friction(HSR_30R, SET_A, SPEEDS, 500.0)
    table = table_friction(HSR_30R, SET_A, 4, SPEEDS, 500.0, seal_drag=6.0)
    assert table.total == pytest.approx(4 * (one.total + 6.0), rel=1e-14)
    assert np.array(table.shares()) == pytest.approx(np.array(one.shares()), rel=1e-14)
    assert sum(table.shares()) == pytest.approx(np.ones_like(SPEEDS), rel=1e-14)


def test_unequal_grooves_share_the_approach() -> None:
    """The harder contact is the narrower groove; swapping rail and carriage changes nothing."""
    here = replace(HSR_20R, rail_conformity=0.51, carriage_conformity=0.54)
    there = replace(HSR_20R, rail_conformity=0.54, carriage_conformity=0.51)
    a, b = (carriage_friction(guide, SET_A, SPEEDS, 2e3) for guide in (here, there))
    assert a.total == pytest.approx(b.total, rel=1e-12)


def test_film_thickens_with_speed_and_thins_with_load() -> None:
    contact = HSR_20R.contacts[0]
    speeds, load = np.array([0.1, 0.2]), np.array([40.0])
    slow, fast = film_thickness(contact, HSR_20R.ball_diameter, SET_A.oil, speeds, load)
    assert fast / slow == pytest.approx(2**0.675, rel=1e-3)  # between its exponents 0.67 and 0.68
    heavy = film_thickness(contact, HSR_20R.ball_diameter, SET_A.oil, speeds[:1], 10 * load)[0]
    assert heavy / slow == pytest.approx(10**-0.07, rel=2e-2)  # between -0.073 and -0.067


@pytest.mark.parametrize(
    ("field", "value", "told"),
    [
        ("rail_conformity", 0.49, "rail_conformity"),
        ("carriage_conformity", 0.5, "carriage_conformity"),
        ("contact_angle", 0.0, "contact_angle"),
        ("contact_angle", 45.0, "contact_angle"),  # degrees in place of radians
        ("contact_angle", math.pi / 2, "contact_angle"),
        ("ball_diameter", 3.969, "ball_diameter"),  # millimetres in place of metres
        ("ball_diameter", -4e-3, "ball_diameter"),
        ("preload_oversize", 3.5, "preload_oversize"),
        ("preload_oversize", -1e-6, "preload_oversize"),
        ("preload_oversize", 0.9e-3, "pushes the balls out"),
        ("balls_per_row", 0, "balls_per_row"),
        ("balls_per_row", 11.5, "whole number"),
        ("ball_diameter", math.nan, "ball_diameter"),
    ],
)
@pytest.mark.filterwarnings("ignore::feeddrive.errors.ValidityWarning")  # it may be unusual besides
def test_impossible_geometry_is_refused(field: str, value: float, told: str) -> None:
    with pytest.raises(InputError, match=told):
        replace(HSR_20R, **{field: value})


@pytest.mark.parametrize(
    ("field", "value", "usual"),
    [
        ("rail_conformity", 0.7, "0.505 to 0.6 is usual"),
        ("ball_diameter", 3e-5, "usual; check its unit"),
        ("contact_angle", math.radians(10), "usual"),
        ("balls_per_row", 300, "3 to 100 is usual"),
    ],
)
def test_unusual_geometry_is_told(field: str, value: float, usual: str) -> None:
    guide = HSR_20R if field != "ball_diameter" else replace(HSR_20R, preload_oversize=0.0)
    with pytest.warns(ValidityWarning, match=usual):
        replace(guide, **{field: value})


def test_loads_beyond_the_guide_are_told() -> None:
    with pytest.warns(ValidityWarning, match="dents"):
        guide_equilibrium(HSR_20R, 35e3)
    with pytest.raises(InputError, match="out of their grooves"):
        guide_equilibrium(HSR_20R, 1e6)
    with pytest.raises(InputError, match="not finite"):
        guide_equilibrium(HSR_20R, math.nan)


def test_bad_running_conditions_are_refused() -> None:
    with pytest.raises(InputError, match="speed is not finite"):
        carriage_friction(HSR_20R, SET_A, math.nan)
    with pytest.raises(InputError, match="seal_drag"):
        carriage_friction(HSR_20R, SET_A, 1.0, seal_drag=-1.0)
    with pytest.raises(InputError, match="carriages"):
        table_friction(HSR_20R, SET_A, 0, 1.0)
    with pytest.raises(InputError, match="viscosity"):
        Oil(0.0, 2e-8)
    with pytest.raises(InputError, match="rolling"):
        GuideCoefficients(-1e-4, 0.01, SET_A.oil)
    with pytest.warns(ValidityWarning, match="viscosity"):
        Oil(130.0, 2.2e-8)  # mPa s in place of Pa s
