"""Paper 001, sections 3.1 to 3.3: shear under the contact, exponents of the life law, rating equations."""

from __future__ import annotations

import math

import numpy as np

from feeddrive.parts.contact import PointContact
from feeddrive.parts.life.life_exponents import (
    BALL_BEARING,
    BALL_SCREW,
    LifeExponents,
    diameter_exponent,
    load_exponent,
)
from feeddrive.parts.life.rating import combined_rating, double_nut_share, groove_factor
from feeddrive.parts.life.stress_cycles import nut_cycles, screw_cycles, stressed_nut_groove, stressed_screw_groove
from feeddrive.parts.life.subsurface_shear import greatest_shear_on_axis, greatest_shear_under_line
from feeddrive.parts.screw.screw_contact import nut_contact, screw_contact
from feeddrive.reproduce.row import Paper, Row, claim, not_possible, number, span
from feeddrive.reproduce.specimen_001 import CIRCLE, STROKE, specimen_track

_LIFE = Paper.LIFE
_SCREW_STRESS, _BEARING_STRESS = 31.4, 31.0 / 3.0
_LUNDBERG_PALMGREN_DEPTH = 7.0 / 3.0
_TWO_DIMENSIONAL = "line contact with traction (McEwen) in place of the cited numerical solution"


def law_rows() -> tuple[Row, ...]:
    """Rows of shear, exponents and equations."""
    return (*_shear(), *_screw_exponents(), *_bearing_exponents(), *_equations())


def _shear() -> tuple[Row, ...]:
    depths = [greatest_shear_on_axis(float(k)).relative_depth for k in np.linspace(0.1, 0.3, 9)]
    track = specimen_track()
    ratios = tuple(1.0 / contact.numbers.ellipticity for contact in (screw_contact(track), nut_contact(track)))
    little, much = greatest_shear_under_line(0.05), greatest_shear_under_line(0.1)
    return (
        span(_LIFE, "sec. 3.1, Fig. 4", "b/a of ball screws, here of the specimen", "", 0.1, 0.3, ratios,
             law=screw_contact, assumption=CIRCLE),
        claim(_LIFE, "sec. 3.1, Fig. 4", "depth of the greatest shear over b, b/a of 0.1 to 0.3", "about 0.75",
              f"{min(depths):.3f} to {max(depths):.3f}", all(abs(depth - 0.75) < 0.05 for depth in depths),
              law=greatest_shear_on_axis),
        claim(_LIFE, "sec. 3.1", "with friction up to 0.05 the greatest shear stays below the surface", "below",
              f"at {little.relative_depth:.3f} b, {little.relative_stress:.3f} p_max", little.relative_depth > 0.5,
              law=greatest_shear_under_line, assumption=_TWO_DIMENSIONAL),
        claim(_LIFE, "sec. 1, ref. 2", "with friction of 0.1 pits start at the surface (earlier work)", "surface",
              f"at {much.relative_depth:.3f} b, {much.relative_stress:.3f} p_max", much.relative_depth < 0.1,
              law=greatest_shear_under_line,
              otherwise="a smooth elastic contact is sheared most below the surface up to a friction of about 0.3"),
        not_possible(_LIFE, "Fig. 4", "values of Kannel's numerical solution", "", "curves",
                     "neither the cited report nor values of the figure are in the available text"),
    )  # fmt: skip


def _screw_exponents() -> tuple[Row, ...]:
    return (
        number(_LIFE, "table 2, eq. (8)", "load-life exponent p of the screw", "", "3",
               load_exponent(_SCREW_STRESS, BALL_SCREW.slope), law=load_exponent),
        number(_LIFE, "table 2", "exponent of the ball diameter of the screw", "", "1.815",
               diameter_exponent(_SCREW_STRESS), law=diameter_exponent),
        number(_LIFE, "table 2", "stress exponent c of the screw", "", "31.4", BALL_SCREW.stress,
               law=LifeExponents, assumption="c is not measured: it is what p = 3 and e = 3.6 give in eq. (8)"),
        claim(_LIFE, "sec. 3.2", "shear stress weighs more in screws than in bearings", "c of 31.4 against 10.33",
              f"{BALL_SCREW.stress:.1f} against {BALL_BEARING.stress:.1f} by eq. (8)",
              BALL_SCREW.stress > BALL_BEARING.stress, law=LifeExponents,
              assumption="follows from the Weibull slopes alone: both load-life exponents are 3"),
    )  # fmt: skip


def _bearing_exponents() -> tuple[Row, ...]:
    depth = _LUNDBERG_PALMGREN_DEPTH
    with_depth = load_exponent(_BEARING_STRESS, BALL_BEARING.slope, depth)
    other = diameter_exponent(_BEARING_STRESS, depth)
    return (
        number(_LIFE, "table 2", "Weibull slope of ball bearings", "", "1.11", BALL_BEARING.slope, law=None,
               assumption="Lundberg and Palmgren's 10/9, cut to its digits"),
        number(_LIFE, "table 2, eq. (8)", "load-life exponent p of ball bearings", "", "3",
               load_exponent(_BEARING_STRESS, BALL_BEARING.slope), law=load_exponent, within=0.01,
               otherwise=f"c = 31/3 belongs to the law with depth, which gives {with_depth:.3g}; eq. (8) has none"),
        number(_LIFE, "table 2, eq. (8)", "stress exponent c of ball bearings", "", "10.33", BALL_BEARING.stress,
               law=LifeExponents,
               otherwise="with p = 3 and e = 10/9 eq. (8) gives 9; 31/3 is Lundberg and Palmgren's with depth"),
        number(_LIFE, "table 2", "exponent of the ball diameter of ball bearings", "", "1.47",
               diameter_exponent(_BEARING_STRESS), law=diameter_exponent,
               assumption=f"by the paper's law without depth; Lundberg and Palmgren's own is {other:.2f}"),
    )  # fmt: skip


def _equations() -> tuple[Row, ...]:
    track, w = specimen_track(), BALL_SCREW.product
    screw, nut = screw_contact(track), nut_contact(track)
    gamma = track.curvature_ratio
    sides = (
        (screw, stressed_screw_groove(track, STROKE), screw_cycles(track, STROKE), 1.0 - gamma),
        (nut, stressed_nut_groove(track), nut_cycles(track, STROKE), 1.0 + gamma),
    )
    direct = [_phi_by_5(contact, length, cycles) for contact, length, cycles, _ in sides]
    split = [_phi_by_12(contact, length, cycles, radius) for contact, length, cycles, radius in sides]
    printed = _phi_by_12(screw, sides[0][1], sides[0][2], 1.0 + gamma)
    share = double_nut_share()
    combined, product = combined_rating((8.0, 10.0)), (8.0**-w + 10.0**-w) ** (-1 / w)
    return (
        claim(_LIFE, "eqs. (5), (11) to (13)", "phi by eq. (5) and by eq. (12) of screw and nut", "the same",
              f"{direct[0]:.5f}, {direct[1]:.5f} and {split[0]:.5f}, {split[1]:.5f}",
              np.allclose(direct, split, rtol=1e-9), law=groove_factor,
              assumption="omega of eq. (13) put into eq. (12), minus for the screw"),
        claim(_LIFE, "eq. (12)", "sign + for the screw too", "+", f"phi {printed:.5f} in place of {direct[0]:.5f}",
              math.isclose(printed, direct[0], rel_tol=1e-3), law=None,
              otherwise="the contact on the screw lies inside the circle of ball centres: minus"),
        claim(_LIFE, "eqs. (16), (17)", "exponent by which screw and nut combine", "not readable in the available text",
              f"w = p e = {w:.1f}; 8 and 10 kN give {combined:.4f} kN", math.isclose(combined, product, rel_tol=1e-9),
              law=combined_rating,
              assumption="w = p e, the exponent for which eq. (17) is the product of the survivals"),
        claim(_LIFE, "eq. (26), conclusion 4", "rating of the double nut over that of the single one",
              "almost the same", f"{share:.5f}", share > 0.9, law=double_nut_share),
    )  # fmt: skip


def _phi_by_5(contact: PointContact, length: float, cycles: float) -> float:
    """phi of eq. (5): stressed length [m], cycles in one stroke; u = l u_s / l_s of eq. (10)."""
    track, c, e = specimen_track(), BALL_SCREW.stress, BALL_SCREW.slope
    numbers = contact.numbers
    share = _relative_shear(contact)
    size = (track.ball_diameter * contact.curvatures.total) ** ((2 * c - 1) / 3)
    ellipse = numbers.semi_major ** (c - 1) * numbers.semi_minor**c
    u = track.lead * cycles / STROKE
    return float((share**c * size / ellipse * length / track.ball_diameter * u**e) ** (-3 / (c + 1)))


def _phi_by_12(contact: PointContact, length: float, cycles: float, radius: float) -> float:
    """phi of eqs. (11) to (13); radius is 1 -/+ gamma."""
    track, c, p = specimen_track(), BALL_SCREW.stress, BALL_SCREW.load
    shape = (radius / 4) ** ((2 * c - 1) / (c + 1)) * (track.ball_diameter / length) ** (3 / (c + 1))
    return float(groove_factor(contact) * shape * cycles ** (-1 / p) * (STROKE / track.lead) ** (1 / p))


def _relative_shear(contact: PointContact) -> float:
    """T / T_1 of a contact."""
    here = greatest_shear_on_axis(1.0 / contact.numbers.ellipticity).relative_stress
    return here / greatest_shear_on_axis(1.0).relative_stress
