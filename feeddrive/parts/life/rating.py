"""Basic dynamic rating of screw, nut and both, after the geometry of the grooves and the stroke.

    Q_c = A_1 phi D_a^((2c-4)/(c+1)) (l_s/l)^(3e/(c+1))
    phi = omega [(1 -/+ gamma) / 4]^((2c-1)/(c+1)) (D_a/l_0)^(3/(c+1)) u_s^(-1/p)
    omega = (1 + F(b/a))^((2c-1)/(c+1)) (T_1/T)^(3c/(c+1)) mu^(3(c-1)/(c+1)) nu^(3c/(c+1))
    C_B = z Q_cB J_a / J_B,    C_M = z Q_cM J_a / J_M,    C = (C_B^-w + C_M^-w)^(-1/w)
    J_a = mean(P_i/P_max) sin(a_0) cos(gamma_m),   J_B = [mean (P_i/P_max)^p]^(1/p),   J_M = [mean (P_i/P_max)^w]^(1/w)

| symbol | meaning | unit |
|---|---|---|
| C, C_B, C_M | axial load that 90 % survive for 10^6 revolutions: pair, screw, nut | N |
| Q_c | load of one ball that 90 % survive for 10^6 revolutions | N |
| A_1 | constant of the material, from a life test; Q_c in N, lengths in mm | N, mm |
| c, e, p, w | exponents of `feeddrive.parts.life.life_exponents` | 1 |
| F(b/a), mu, nu | curvature difference and Hertz's numbers of the contact | 1 |
| T, T_1 | greatest shear stress over p_max, at this b/a and at b/a = 1 | 1 |
| gamma, l, l_s, l_0, u_s | of `parts.screw.screw_contact` and `parts.life.stress_cycles`; - screw, + nut | |
| P_i, P_max | loads of the balls | N |

The screw's groove sees all loads in turn (mean of exponent p), a point of the nut's always the same one (product of
the probabilities, exponent w). In `rating` the most stressed
points of the screw stand for all of its stressed length; `rating_along_screw` counts every point.
Source: paper 001, eqs. (11) to (17); its print lacks omega in (12) and the minus for the screw, and writes other signs
for w in (16) and (17). Validity: stroke above the ball pitch; the constants of a test hold for its steel alone.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from feeddrive.errors import InputError
from feeddrive.parts.contact import PointContact
from feeddrive.parts.life.life_exponents import BALL_SCREW
from feeddrive.parts.life.stress_cycles import (
    effective_screw_groove,
    nut_cycles,
    screw_cycles,
    stressed_nut_groove,
    stressed_screw_groove,
)
from feeddrive.parts.life.subsurface_shear import greatest_shear_on_axis
from feeddrive.parts.screw.load_distribution import LoadDistribution
from feeddrive.parts.screw.screw_contact import BallTrack, nut_contact, screw_contact
from feeddrive.parts.values import PartValue, check_values

_CONSTANT = (PartValue("material_constant", "1", 0.0, 1e9),)
_TESTED = (PartValue("tested", "N", 0.0, 1e9),)


@dataclass(frozen=True)
class Rating:
    """Basic dynamic axial ratings of a single nut [N], and the share of failures that the nut has at rated load [1]."""

    screw: float
    nut: float
    pair: float
    nut_share: float


def rating(track: BallTrack, loads: LoadDistribution, stroke: float, material_constant: float) -> Rating:
    """Ratings of a nut at a stroke as the paper computes them.

    Args:
        track: balls and grooves.
        loads: how the balls share the load.
        stroke: one way [m].
        material_constant: A_1, see `material_constant_of_test`.

    Raises:
        InputError: a stroke or material constant that is not positive.
    """
    length = stressed_screw_groove(track, stroke)
    return _rating(track, loads, stroke, length, material_constant)


def rating_along_screw(track: BallTrack, loads: LoadDistribution, stroke: float, material_constant: float) -> Rating:
    """Ratings where every point of the screw counts with its own cycles, not as the most stressed; args as `rating`.

    Raises:
        InputError: as `rating`.
    """
    length = effective_screw_groove(track, stroke, BALL_SCREW.slope)
    return _rating(track, loads, stroke, length, material_constant)


def material_constant_of_test(track: BallTrack, loads: LoadDistribution, stroke: float, tested: float) -> float:
    """A_1 for which `rating` gives a single nut the tested rating [N]; arguments otherwise as `rating`.

    Raises:
        InputError: as `rating`.
    """
    check_values("life test", _TESTED, {"tested": tested})
    return tested / rating(track, loads, stroke, 1.0).pair


def combined_rating(ratings: tuple[float, ...]) -> float:
    """Rating [N] of several bodies that must all survive, eq. (17): C^-w is the sum of C_i^-w.

    Raises:
        InputError: no rating, or one that is not positive and finite.
    """
    values = np.asarray(ratings, dtype=float)
    if not (values.size and np.all(np.isfinite(values) & (values > 0.0))):
        raise InputError("a rating is not positive and finite", "ratings", "write each above 0 N")
    least = float(values.min())
    return least * float(np.sum((values / least) ** -BALL_SCREW.product) ** (-1.0 / BALL_SCREW.product))


def double_nut_share() -> float:
    """C_d / C_s = 2^(-1/(p e)), eq. (26): rating of two equally loaded nuts over that of one [1]."""
    return combined_rating((1.0, 1.0))


def load_integrals(track: BallTrack, loads: LoadDistribution) -> tuple[float, float, float]:
    """J_a, J_B and J_M [1]."""
    share = loads.ball_loads / loads.ball_loads.max()
    w, p = BALL_SCREW.product, BALL_SCREW.load
    return (
        float(share.mean()) * track.axial_part,
        float(np.mean(share**p) ** (1 / p)),
        float(np.mean(share**w) ** (1 / w)),
    )


def groove_factor(contact: PointContact) -> float:
    """omega of a contact, eq. (13) [1]."""
    c, numbers = BALL_SCREW.stress, contact.numbers
    greatest = greatest_shear_on_axis(1.0 / numbers.ellipticity).relative_stress
    share = greatest_shear_on_axis(1.0).relative_stress / greatest
    curvature = (1.0 + contact.curvatures.difference) ** ((2 * c - 1) / (c + 1))
    ellipse = numbers.semi_major ** (3 * (c - 1) / (c + 1)) * numbers.semi_minor ** (3 * c / (c + 1))
    return float(curvature * share ** (3 * c / (c + 1)) * ellipse)


def _rating(
    track: BallTrack, loads: LoadDistribution, stroke: float, screw_length: float, material_constant: float
) -> Rating:
    """Ratings with the stressed length of the screw given [m]."""
    check_values("rating", _CONSTANT, {"material_constant": material_constant})
    average, of_screw, of_nut = load_integrals(track, loads)
    gamma, factor = track.curvature_ratio, material_constant * track.balls * average
    screw_shape = groove_factor(screw_contact(track)) * _length_factor(
        track, 1.0 - gamma, screw_length, screw_cycles(track, stroke)
    )
    nut_shape = groove_factor(nut_contact(track)) * _length_factor(
        track, 1.0 + gamma, stressed_nut_groove(track), nut_cycles(track, stroke)
    )
    c, p = BALL_SCREW.stress, BALL_SCREW.load
    size = (1e3 * track.ball_diameter) ** ((2 * c - 4) / (c + 1)) * (stroke / track.lead) ** (1 / p)
    screw, nut = factor * screw_shape * size / of_screw, factor * nut_shape * size / of_nut
    pair = combined_rating((screw, nut))
    return Rating(screw, nut, pair, (pair / nut) ** BALL_SCREW.product)


def _length_factor(track: BallTrack, radius: float, length: float, cycles: float) -> float:
    """phi / omega, eq. (12): radius is 1 -/+ gamma, length l_0 [m], cycles u_s."""
    c = BALL_SCREW.stress
    shape = (0.25 * radius) ** ((2 * c - 1) / (c + 1)) * (track.ball_diameter / length) ** (3 / (c + 1))
    return float(shape * cycles ** (-1 / BALL_SCREW.load))
