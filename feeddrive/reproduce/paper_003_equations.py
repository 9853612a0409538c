"""The equations of paper 003: what holds as printed, and what the available text has wrong.

The misprinted forms stand here alone, to show what they would give.
"""

from __future__ import annotations

import math

import numpy as np
from scipy.integrate import dblquad
from scipy.optimize import fsolve

from feeddrive.parts.contact import PointContact
from feeddrive.parts.guide.guide_carriage import carriage_friction, mean_slip_radius
from feeddrive.parts.guide.guide_coefficients import SET_A
from feeddrive.parts.guide.guide_equilibrium import guide_equilibrium
from feeddrive.parts.guide.guide_geometry import HSR_20R
from feeddrive.reproduce.row import Paper, Row, claim
from feeddrive.typing import FloatArray

_PAPER = Paper.GUIDE
_LOAD = 1e3
_SAME = 1e-9
"""Relative difference that is rounding, or the tolerance of an integral."""

MILLIMETRE = 1e-3


def equation_rows() -> tuple[Row, ...]:
    """One row per equation, and one per misprint of the available text."""
    return (
        _hertz_constant(), _table_1(), _printed_balance(), _balance(), _two_rows(), _film_area(), _film_power(),
        _printed_slip(), _slip_independent_of_speed(), _printed_radius(), _deformed_radius(), _signed_accuracy(),
    )  # fmt: skip


def _hertz_constant() -> Row:
    contact = HSR_20R.contacts[0]
    total, numbers = contact.curvatures.total, contact.numbers
    printed = 0.5 * numbers.approach * total * (1.5 / total * contact.compliance) ** (2 / 3)
    error = abs(contact.approach(8.0) / (printed * 4.0) - 1.0)
    return claim(_PAPER, "eqs. 1, 2", "Hertz's constant as printed gives the approach", "delta = C Q^(2/3)",
                 f"equal to {max(error, 1e-15):.0e}", error < _SAME, law=PointContact.approach)  # fmt: skip


def _table_1() -> Row:
    sine, cosine = math.sin(HSR_20R.contact_angle), math.cos(HSR_20R.contact_angle)
    return claim(
        _PAPER, "table 1", "V_y of the rows without load", "A_0 sin a_0", f"A_0 cos a_0 is {cosine / sine:.6f} of it",
        abs(sine / cosine - 1.0) < _SAME, law=None, assumption="it stands for A_0 cos a_0, equal at 45 deg alone",
    )  # fmt: skip


def printed_balance(vertical: float) -> tuple[float, float]:
    """dx, dy [m] from (7) as printed: rows 3 and 1 in both lines, without lateral load."""
    rest = HSR_20R.centre_distance / math.sqrt(2.0)

    def residual(shift: FloatArray) -> FloatArray:
        balls = []
        for sign in (1.0, -1.0):
            centre = np.array([rest + sign * shift[0], rest + sign * shift[1]]) * MILLIMETRE
            length = float(np.hypot(*centre))
            approach = max(length - HSR_20R.centre_distance + HSR_20R.preload_oversize, 0.0)
            balls.append((approach / HSR_20R.hertz_constant) ** 1.5 * centre / length)
        return np.asarray(HSR_20R.balls_per_row * (balls[0] - balls[1]) - [vertical, 0.0])

    rest /= MILLIMETRE
    found = fsolve(residual, np.array([0.02, -0.02]), xtol=1e-12) * MILLIMETRE
    return float(found[0]), float(found[1])


def _printed_balance() -> Row:
    dx, dy = (1e6 * shift for shift in printed_balance(_LOAD))
    return claim(
        _PAPER, "eq. 7", "HSR-20R, 1 kN vertical: no lateral displacement", "balance of parts A and B in both lines",
        f"{dx:+.0f} µm vertical, {dy:+.0f} µm lateral", abs(dy) < 0.1, law=None,
        otherwise="the lateral line must pair rows by side, not by part, and both lines sum over four rows",
    )  # fmt: skip


def _balance() -> Row:
    dx, dy = 1e6 * guide_equilibrium(HSR_20R, _LOAD).displacement
    return claim(
        _PAPER, "eq. 7", "HSR-20R, 1 kN vertical, four rows paired by side", "no lateral displacement",
        f"{dx:+.2f} µm vertical, {dy:+.2f} µm lateral", abs(dy) < 1e-6, law=guide_equilibrium,
        assumption="(7) summed over four rows, by side",
    )  # fmt: skip


def _two_rows() -> Row:
    balls = guide_equilibrium(HSR_20R, _LOAD).ball_load
    share = float(balls[[0, 2]].sum() / balls.sum())
    return claim(
        _PAPER, "eqs. 8-10", "force of one carriage", "z (Q_A + Q_B)", f"{share:.2f} of its four rows",
        abs(share - 1.0) < 0.01,
        law=guide_equilibrium, otherwise="parts A and B have two rows each; shares are the same either way",
    )  # fmt: skip


def _film_area() -> Row:
    a, b = 1.7, 0.21
    area, _ = dblquad(lambda w, u: 1.0, -a, a, lambda u: -b * math.sqrt(1 - u**2 / a**2),
                      lambda u: b * math.sqrt(1 - u**2 / a**2))  # fmt: skip
    ratio = area / (math.pi * a * b)
    return claim(_PAPER, "eq. 9", "area in the viscous force", "double integral", f"{ratio:.6f} pi a b",
                 abs(ratio - 1.0) < 1e-6, law=None)  # fmt: skip


def _film_power() -> Row:
    speeds = np.array([0.06, 1.0, 10.0, 100.0]) / 60.0
    force = carriage_friction(HSR_20R, SET_A, speeds).viscous
    powers = np.diff(np.log(force)) / np.diff(np.log(speeds))
    spread = f"{powers.min():.4f} to {powers.max():.4f}"
    return claim(
        _PAPER, "sec. 5.2", "viscous force rises exponentially with speed", "exponentially", f"as v to the {spread}",
        bool(powers.max() > 1.0),
        law=carriage_friction, otherwise="a power of speed below 1: 1 less the film's exponent of 0.67 to 0.68",
    )  # fmt: skip


def printed_slip(length_unit: float) -> float:
    """Integral of k between the printed limits, j and k at u = a/2 and w = 0, lengths in a unit [m]; back in m^3."""
    a, b = (axis / length_unit for axis in HSR_20R.contacts[0].semi_axes(75.3))
    j = math.sqrt(1.0 - 0.25)
    return 2.0 * a * 2.0 * j * b * j * length_unit**3


def _printed_slip() -> Row:
    ratio = printed_slip(1.0) / printed_slip(MILLIMETRE)
    return claim(
        _PAPER, "eqs. 10-12", "slip integral the same in mm and m", "limits from -j to j, integrand k",
        f"{ratio:.4g} times as large in m", abs(ratio - 1.0) < _SAME, law=None,
        otherwise="j has no unit, k is a length: limit and integrand are exchanged, and pi is lost in the pressure",
    )  # fmt: skip


def _slip_independent_of_speed() -> Row:
    slip = carriage_friction(HSR_20R, SET_A, np.array([0.06, 100.0]) / 60.0, _LOAD).slip
    return claim(
        _PAPER, "eq. 10", "slip force does not depend on speed", "omega_b / v_c = 1 / d_b",
        f"{slip[0]:.4g} and {slip[1]:.4g} N", bool(slip[0] == slip[1]), law=carriage_friction,
        assumption="limit and integrand of (10) exchanged, with pi, sign of (13)",
    )  # fmt: skip


def _printed_radius() -> Row:
    """(13) as printed at the middle of a small ellipse, in mm, beside what a shortfall must be: of the size a^2/d_b."""
    d, a = HSR_20R.ball_diameter / MILLIMETRE, 0.1
    r = 2.0 * 0.52 * d / (2.0 * 0.52 + 1.0)
    printed = d / 2.0 * (r - math.sqrt(r**2 - a**2) + math.sqrt(d**2 / 4.0 - a**2))
    right = mean_slip_radius(d * MILLIMETRE, 0.52, a * MILLIMETRE) / MILLIMETRE
    return claim(
        _PAPER, "eq. 13", "differential radius of an ellipse of 0.1 mm", "d_b/2 times the bracket",
        f"{printed:.3g} mm², corrected {right:.2e} mm", printed < a, law=None, unit="mm",
        otherwise="the sign is minus, d_b/2 less the bracket, and the coordinate is the one along a",
    )  # fmt: skip


def _deformed_radius() -> Row:
    ball, groove = 0.5, 0.52
    printed, harmonic = 2 * 0.52 / (2 * 0.52 + 1), 2.0 / (1.0 / ball + 1.0 / groove)
    return claim(
        _PAPER, "eq. 14", "radius of the deformed surface is the harmonic mean of ball and groove", "2 f d_b/(2 f + 1)",
        f"{harmonic:.5f} d_b, printed {printed:.5f} d_b", abs(harmonic - printed) < _SAME, law=None,
    )  # fmt: skip


def accuracy(measured: FloatArray, predicted: FloatArray) -> float:
    """(16) and (17): 100 less the mean signed error [%]."""
    return float(100.0 - np.mean(100.0 * (measured - predicted) / measured))


def _signed_accuracy() -> Row:
    measured = np.array([10.0, 10.0])
    found = accuracy(measured, np.array([5.0, 15.0]))
    return claim(
        _PAPER, "eqs. 16, 17", "the accuracy tells how near prediction is", "100 % is exact",
        f"{found:.0f} % where every prediction is 50 % off", found < 60.0, law=None,
        otherwise="errors keep their sign and cancel; the mean of their sizes would tell",
    )  # fmt: skip
