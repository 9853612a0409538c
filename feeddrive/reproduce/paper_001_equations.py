"""Paper 001: how its equations follow from each other, and what the test and its references state beside them."""

from __future__ import annotations

import math

import numpy as np

from feeddrive.parts.contact import PointContact
from feeddrive.parts.life.life import survival
from feeddrive.parts.life.life_exponents import BALL_SCREW, load_exponent
from feeddrive.parts.life.rating import double_nut_share
from feeddrive.parts.life.stress_cycles import ball_travel_share
from feeddrive.parts.screw.screw_contact import BallTrack, nut_contact, screw_contact
from feeddrive.reproduce.row import Paper, Row, claim, not_possible
from feeddrive.reproduce.specimen_001 import CIRCLE, specimen_track
from feeddrive.typing import FloatArray

_LIFE = Paper.LIFE
_SEED = 1


def equation_rows() -> tuple[Row, ...]:
    """Rows of the equations that lead to others."""
    track = specimen_track()
    return (_basic_law(), _material_constant(), _exponent_of_life(), _curvature(track), _angle(track), *_double_nut())


def unmodelled_rows() -> tuple[Row, ...]:
    """What is stated and in no model of the paper."""
    return (
        not_possible(_LIFE, "sec. 2.1", "temperature of the nuts under forced air", "°C", "below 40 after 25 min",
                     "neither friction torque nor air flow nor areas are printed"),
        not_possible(_LIFE, "sec. 1, ref. 1", "the Weibull slope does not depend on the preload", "", "constant",
                     "all ten specimens ran at one preload"),
        not_possible(_LIFE, "sec. 1", "pitting raises the friction torque and lowers the efficiency", "", "higher",
                     "no torque of a pitted screw is printed, and the life law has none"),
    )  # fmt: skip


def _basic_law() -> Row:
    """Eq. (3) over eqs. (1), (2), at random values: a constant."""
    c, e = BALL_SCREW.stress, BALL_SCREW.slope
    T, mu, nu, E0, total, D_a, Q, u, L, l_0 = np.random.default_rng(_SEED).uniform(0.5, 2.0, (10, 20))
    size = (3 * Q / (E0 * total)) ** (1 / 3)
    a, b = mu * size, nu * size
    by_1 = (T * 3 * Q / (2 * math.pi * a * b)) ** c * (u * L) ** e * a * l_0
    by_3 = _eq_3(np.array([T, mu, nu, E0, total, D_a, Q, u, L, l_0]), c, e)
    spread = float(np.ptp(by_3 / by_1) / np.mean(by_3 / by_1))
    return claim(_LIFE, "eq. (3)", "life law from eqs. (1), (2)", "follows",
                 f"in proportion to {spread:.0e} at random values", spread < 1e-10, law=None)  # fmt: skip


def _eq_3(values: FloatArray, c: float, e: float) -> FloatArray:
    T, mu, nu, E0, total, D_a, Q, u, L, l_0 = values
    shape = T**c / (mu ** (c - 1) * nu**c) * (E0 * D_a * total / 3) ** ((2 * c - 1) / 3)
    return np.asarray(shape * (Q / D_a**2) ** ((c + 1) / 3) * l_0 * u**e * L**e * D_a)


def _material_constant() -> Row:
    """A_1 against T_1 where Q of eq. (4) does not depend on it: phi of (5) goes as T_1^(3c/(c+1))."""
    c = BALL_SCREW.stress
    needed, printed = -3 * c / (c + 1), -3 / (c + 1)
    return claim(_LIFE, "eq. (6)", "power of T_1 in the material constant", f"{printed:.3f}", f"{needed:.3f}",
                 math.isclose(needed, printed, rel_tol=1e-3), law=None,
                 otherwise="the exponent c of T_1 is missing: T_1 must cancel in eqs. (4), (5)")  # fmt: skip


def _exponent_of_life() -> Row:
    exponent = load_exponent(BALL_SCREW.stress, BALL_SCREW.slope)
    return claim(_LIFE, "eqs. (7), (9)", "exponent of the load, named b", "b",
                 f"eq. (4) solved for L gives {exponent:.3f}, p of eq. (8)",
                 math.isclose(exponent, BALL_SCREW.load, rel_tol=1e-9), law=load_exponent,
                 assumption="the letter b of the available text is p of eq. (8)")  # fmt: skip


def _curvature(track: BallTrack) -> Row:
    found = [_eq_14(track, sign) for sign in (1.0, -1.0)]
    contacts: tuple[PointContact, ...] = (screw_contact(track), nut_contact(track))
    direct = [contact.curvatures.difference for contact in contacts]
    return claim(_LIFE, "eq. (14)", "F(b/a) is the difference of curvatures, screw and nut", "identical",
                 f"{found[0]:.5f}, {found[1]:.5f} and {direct[0]:.5f}, {direct[1]:.5f}",
                 np.allclose(found, direct, rtol=1e-12), law=screw_contact, assumption=CIRCLE)  # fmt: skip


def _eq_14(track: BallTrack, sign: float) -> float:
    """F(b/a) as printed; sign +1 of the screw, -1 of the nut."""
    across = track.ball_diameter * math.cos(track.contact_angle)
    f, d_m = track.conformity, track.pitch_diameter
    return (across * sign * (2 * f - 1) + d_m) / (-across * sign * (2 * f - 1) + d_m * (4 * f - 1))


def _angle(track: BallTrack) -> Row:
    """K of eqs. (20), (22) with the difference and with the sum of the two lead angles."""
    at_screw, at_balls = track.lead_angle(track.screw_diameter), track.lead_angle(track.pitch_diameter)
    share = ball_travel_share(track)
    with_sum = share * math.cos(at_screw + at_balls) / math.cos(at_screw - at_balls)
    reason = f"no formula is printed; by kinematics it is the difference of the lead angles, which gives the nut " \
        f"{share:.4f} of the travel, and the sum would give {with_sum:.4f}; {CIRCLE}"  # fmt: skip
    return not_possible(_LIFE, "eqs. (20), (22)", "angle between the screw's groove and the path of the balls", "",
                        "no formula", reason)  # fmt: skip


def _double_nut() -> tuple[Row]:
    """Survival of two nuts at the rated life of the pair."""
    one = survival(double_nut_share() ** BALL_SCREW.load, 1.0)
    return (
        claim(_LIFE, "eqs. (23) to (25)", "two nuts loaded with C_d both survive 10^6 revolutions", "0.9",
              f"{one**2:.6f}", math.isclose(one**2, 0.9, rel_tol=1e-9), law=double_nut_share),
    )  # fmt: skip
