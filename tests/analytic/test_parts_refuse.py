"""Values that no part can have: every function of the parts library refuses them in one line, or answers in numbers."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest

from feeddrive.errors import InputError, ValidityWarning
from feeddrive.parts.combined_stiffness import natural_frequency
from feeddrive.parts.contact import ball_in_groove
from feeddrive.parts.guide.guide_carriage import carriage_friction, table_friction
from feeddrive.parts.guide.guide_coefficients import SET_A
from feeddrive.parts.guide.guide_equilibrium import guide_equilibrium
from feeddrive.parts.guide.guide_geometry import HSR_20R
from feeddrive.parts.life.life import (
    distance,
    rated_revolutions,
    rating_of_test,
    running_time,
    survival,
)
from feeddrive.parts.life.life_exponents import diameter_exponent, load_exponent
from feeddrive.parts.life.rating import combined_rating, material_constant_of_test, rating
from feeddrive.parts.life.stress_cycles import effective_screw_groove
from feeddrive.parts.life.subsurface_shear import axis_stresses, greatest_shear_on_axis
from feeddrive.parts.life.weibull import WeibullLaw, complete_slope_interval
from feeddrive.parts.lubricant import Lubricant
from feeddrive.parts.screw.load_distribution import load_distribution, nut_body
from feeddrive.parts.screw.screw_contact import BallTrack
from feeddrive.parts.screw.screw_friction import ScrewFriction, ScrewGeometry
from feeddrive.parts.screw.wedge import self_locking_lead

TRACK = BallTrack(3.175e-3, 25.5e-3, 0.55, math.pi / 4, 6e-3, 2.5)
BODY = nut_body(TRACK, 0.04)
LOADS = load_distribution(BODY, 13500.0)
CONTACT = ball_in_groove(3.969e-3, 0.52)
SCREW = ScrewFriction(ScrewGeometry(0.010, 0.041, math.pi / 4), 0.034)
LAW = WeibullLaw(1.0, 2.0)
OIL = Lubricant(32e-6, 5.3e-6)

# Name, function of one value; the value is refused where it is not a number, infinite or below 0.
REFUSING: dict[str, Callable[[float], object]] = {
    "ball diameter": lambda v: ball_in_groove(v, 0.52),
    "contact load": CONTACT.approach,
    "contact approach": CONTACT.load,
    "contact ellipse": CONTACT.semi_axes,
    "contact pressure": CONTACT.maximum_pressure,
    "carriages": lambda v: table_friction(HSR_20R, SET_A, v, 0.1),  # type: ignore[arg-type]
    "seal drag": lambda v: carriage_friction(HSR_20R, SET_A, 0.1, seal_drag=v),
    "ball load": TRACK.mean_ball_load,
    "nut load": lambda v: load_distribution(BODY, v),
    "material constant": lambda v: rating(TRACK, LOADS, 0.288, v),
    "tested rating": lambda v: material_constant_of_test(TRACK, LOADS, 0.288, v),
    "one rating of two": lambda v: combined_rating((v, 8.0)),
    "tested force": lambda v: rating_of_test(v, 3e5),
    "tested life": lambda v: rating_of_test(1e3, v),
    "revolutions": lambda v: survival(v, 1e6),
    "rating": lambda v: rated_revolutions(v, 1e3),
    "speed": lambda v: running_time(1e6, v),
    "lead": lambda v: distance(1e6, v),
    "stress exponent": lambda v: load_exponent(v, 3.6),
    "slope": lambda v: load_exponent(31.4, v),
    "depth exponent": lambda v: diameter_exponent(31.4, v),
    "slope of a groove": lambda v: effective_screw_groove(TRACK, 0.1, v),
    "locking friction": lambda v: self_locking_lead(v, 0.04),
    "preload": SCREW.preload_torque,
    "share of failures": LAW.life,
    "known share": lambda v: WeibullLaw.through(1.0, v, 2.0),
    "known slope": lambda v: WeibullLaw.through(1.0, 0.1, v),
    "measured slope": lambda v: complete_slope_interval(v, 10),
    "axis ratio": lambda v: greatest_shear_on_axis(v),
    "depth": lambda v: axis_stresses(0.3, v),
    "mass": lambda v: natural_frequency(1e8, v),
    "stiffness": lambda v: natural_frequency(v, 100.0),
}


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf, -1.0])
@pytest.mark.parametrize("name", REFUSING)
def test_impossible_values_are_refused(name: str, value: float) -> None:
    with pytest.raises(InputError) as caught:
        REFUSING[name](value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_signed_values_must_be_finite(value: float) -> None:
    for attempt in (
        lambda: guide_equilibrium(HSR_20R, value),
        lambda: guide_equilibrium(HSR_20R, 0.0, value),
        lambda: carriage_friction(HSR_20R, SET_A, value),
        lambda: SCREW.torque(value, 1.0),
        lambda: SCREW.torque(1.0, value),
        lambda: OIL.viscosity(value),
    ):
        with pytest.raises(InputError):
            attempt()


@pytest.mark.parametrize("value", [np.array([1.0, -1.0]), np.array([math.nan])])
def test_every_load_of_an_array_counts(value: np.ndarray) -> None:
    with pytest.raises(InputError, match="contact"):
        CONTACT.semi_axes(value)


def test_huge_and_tiny_values_end_in_the_limit() -> None:
    """Beyond the range of numbers the limit is told, no error of arithmetic."""
    assert LAW.survival(1e300) == 0.0
    assert LAW.failure(1e300) == 1.0
    assert survival(1e300, 1.0) == 0.0
    assert survival(1.0, math.inf) == 1.0
    assert survival(1e-300, 1e6) == 1.0
    assert rated_revolutions(1e4, 0.0) == math.inf


def test_unusual_drag_of_seals_is_told() -> None:
    with pytest.warns(ValidityWarning, match="seal_drag"):
        carriage_friction(HSR_20R, SET_A, 0.1, seal_drag=500.0)
