"""The ball screw of paper 001 and its test: printed values, and what had to be assumed.

Printed (table 1, sections 2.1 and 2.2): nominal diameter 25 mm, lead 6 mm, balls of 3.175 mm, conformity 0.55, contact
angle 45 degrees, 2.5 turns in one circuit, preload 13.5 kN, stroke 288 mm, 480 rev/min; ten double nuts, opened first
at 200 000 revolutions and then every 30 000; first failure at 230 000, last at 500 000; slope 3.6; L10 of 300 000.
Assumed: ball-centre circle of 25.5 mm (screws of this size have 25 to 26 mm), outer diameter of the nut 40 mm.
"""

from __future__ import annotations

import math
from functools import cache

from feeddrive.parts.life.life import rating_of_test
from feeddrive.parts.life.rating import double_nut_share, material_constant_of_test
from feeddrive.parts.screw.load_distribution import LoadDistribution, NutBody, load_distribution, nut_body
from feeddrive.parts.screw.screw_contact import BallTrack

PRELOAD = 13.5e3
"""Preload in the test [N]."""

STROKE = 0.288
"""Stroke of the test, one way [m]."""

RATED_LIFE = 300e3
"""L10, conclusion 5 [rev]."""

FIRST_FAILURE, LAST_FAILURE = 230e3, 500e3
"""First and last failure of ten specimens [rev]."""

SPECIMENS = 10
FIRST_OPENED, OPENED_EVERY = 200e3, 30e3

NUT_DIAMETER = 0.04
CIRCLE = "ball-centre circle of 25.5 mm assumed, not printed"
CIRCLE_AND_NUT = "ball-centre circle of 25.5 mm and nut of 40 mm outer diameter assumed, not printed"


def specimen_track(turns: float = 2.5) -> BallTrack:
    """Balls and grooves of the specimen, or of a nut with more turns."""
    return BallTrack(3.175e-3, 25.5e-3, 0.55, math.radians(45), 6e-3, turns)


def specimen_body(turns: float = 2.5, nut_diameter: float = NUT_DIAMETER) -> NutBody:
    """Nut of the specimen, or one with more turns or of another outer diameter [m]."""
    return nut_body(specimen_track(turns), nut_diameter)


@cache
def specimen_loads() -> LoadDistribution:
    """Ball loads at the preload of the test."""
    return load_distribution(specimen_body(), PRELOAD)


def double_nut_rating() -> float:
    """C_d from preload and L10 of the test [N]."""
    return rating_of_test(PRELOAD, RATED_LIFE)


def single_nut_rating() -> float:
    """C_s from the same [N]."""
    return double_nut_rating() / double_nut_share()


@cache
def specimen_material() -> float:
    """A_1 for which the specimen has C_s at the stroke of the test [N, mm]."""
    return material_constant_of_test(specimen_track(), specimen_loads(), STROKE, single_nut_rating())
