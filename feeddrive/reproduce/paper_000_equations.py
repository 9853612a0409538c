"""The equations of paper 000: what follows from what, and what the available text has wrong.

The misprinted forms stand here alone, to show what they would give.
"""

from __future__ import annotations

import math

import numpy as np

from feeddrive.parts.screw.screw_efficiency import (
    back_driving_efficiency,
    driving_efficiency,
    friction_from_torque,
    relative_preload_torque,
)
from feeddrive.parts.screw.slip_angle import Groove, groove_at, slip_angles_nut_drives, slip_angles_screw_drives
from feeddrive.parts.screw.slip_forces import axial_force, screw_moment
from feeddrive.reproduce.row import Paper, Row, claim
from feeddrive.typing import FloatArray

PAPER = Paper.EFFICIENCY
FRICTION = 0.034
BALL_RATIO = 0.15
"""Ball over ball-centre diameter: not printed; it cancels."""

LEAD_ANGLES, CONTACT_ANGLES = np.meshgrid(np.radians([2, 4.44, 5.26, 10, 20, 40]), np.radians([30, 40, 45, 60, 80]))
SAME = 1e-12
"""Largest difference between two forms of one number near 1 that is rounding."""


def equation_rows() -> tuple[Row, ...]:
    """One row per equation, and one per misprint of the available text."""
    grooves = groove_at(LEAD_ANGLES, CONTACT_ANGLES)
    return (
        _slip_angles(grooves),
        *_efficiencies(grooves),
        _printed_moment(),
        _no_friction(grooves),
        *_preload_torque(grooves),
        *_inverse(grooves),
    )


def _difference(found: FloatArray, expected: FloatArray) -> tuple[str, bool]:
    """The largest difference as text, and whether it is rounding."""
    largest = float(np.max(np.abs(found - expected)))
    return f"largest difference {largest:.1e}", largest < SAME


def _slip_angles(grooves: Groove) -> Row:
    """Both friction forces turn round between the two ways of driving."""
    screw, nut = slip_angles_screw_drives(grooves), slip_angles_nut_drives(grooves)
    turned = max(float(np.max(np.abs(np.abs(a - b) - math.pi))) for a, b in zip(screw, nut, strict=True))
    return claim(PAPER, "eqs. 1, 2", "slip angles of screw drive and nut drive", "differ by pi at A and B",
                 f"differ by pi to {turned:.0e} rad", turned < SAME,
                 law=slip_angles_screw_drives)  # fmt: skip


def _efficiencies(grooves: Groove) -> tuple[Row, Row]:
    """(5) and (6) follow from (3) and (4)."""
    shown, same = _difference(_from_forces(back=False), _printed_driving(FRICTION))
    agrees = same and _difference(np.asarray(driving_efficiency(grooves, FRICTION)), _printed_driving(FRICTION))[1]
    driving = claim(PAPER, "eq. 5", "efficiency, screw drives, from eqs. 3 and 4", "identical", shown, agrees,
                    law=driving_efficiency,
                    assumption="(cos b - r_a) in eq. 3, where the available text has (-r_a cos b)")  # fmt: skip
    shown, same = _difference(_from_forces(back=True), np.asarray(back_driving_efficiency(grooves, FRICTION)))
    back = claim(PAPER, "eq. 6", "efficiency, nut drives, from eqs. 3 and 4", "identical", shown, same,
                 law=back_driving_efficiency,
                 assumption="(cos b - r_a) in eq. 3, where the available text has (-r_a cos b)")  # fmt: skip
    return driving, back


def _from_forces(back: bool) -> FloatArray:
    """Efficiency as the ratio of works of eqs. (3) and (4)."""
    angles = slip_angles_nut_drives if back else slip_angles_screw_drives
    psi_a, psi_b = angles(groove_at(LEAD_ANGLES, CONTACT_ANGLES))
    moment = screw_moment(1.0, 1.0, LEAD_ANGLES, CONTACT_ANGLES, psi_b, BALL_RATIO, FRICTION)
    work = axial_force(1.0, LEAD_ANGLES, CONTACT_ANGLES, psi_a, FRICTION) * np.tan(LEAD_ANGLES)
    return np.asarray(moment / work if back else work / moment)


def _printed_driving(f: float) -> FloatArray:
    """Eq. (5) letter by letter."""
    R = np.sqrt(np.cos(CONTACT_ANGLES) ** 2 + np.tan(LEAD_ANGLES) ** 2)
    sin_b = np.sin(CONTACT_ANGLES)
    return np.asarray(1 - f / (np.cos(LEAD_ANGLES) ** 2 * sin_b * (R + f * sin_b)))


def _printed_moment() -> Row:
    """Eq. (3) with its bracket as the available text has it."""
    a, b = math.radians(4.44), math.pi / 4
    groove = groove_at(a, b)
    psi_a, psi_b = (float(psi) for psi in slip_angles_screw_drives(groove))
    across = -math.sin(a) * math.cos(psi_b) * (-BALL_RATIO * math.cos(b))
    along = math.cos(a) * math.sin(psi_b) * (1 - BALL_RATIO * math.cos(b))
    moment = math.sin(a) * math.sin(b) + FRICTION * (across + along)
    found = float(axial_force(1.0, a, b, psi_a, FRICTION)) * math.tan(a) / moment
    expected = float(driving_efficiency(groove, FRICTION))
    return claim(PAPER, "eq. 3", "bracket (-r_a cos b), as in the available text, leads to eq. 5",
                 f"{expected:.3f} (screw A, by eq. 5)", f"{found:.3f}", abs(found - expected) < 5e-4, law=None,
                 otherwise="a sign was lost in the text: (cos b - r_a) leads to eqs. 5 and 6 exactly")  # fmt: skip


def _no_friction(grooves: Groove) -> Row:
    torque = float(np.max(relative_preload_torque(grooves, 0.0)))
    return claim(
        PAPER, "figure 3a", "without friction no torque is needed to turn or to hold", "0", f"{torque:g}", torque == 0,
        law=relative_preload_torque,
    )  # fmt: skip


def _preload_torque(grooves: Groove) -> tuple[Row, Row]:
    """(7) and its misprint."""
    direct = 1 / driving_efficiency(grooves, FRICTION) - back_driving_efficiency(grooves, FRICTION)
    shown, same = _difference(np.asarray(relative_preload_torque(grooves, FRICTION)), np.asarray(direct))
    corrected = claim(PAPER, "eq. 7", "relative preload torque is 1/eta_a - eta_b", "identical", shown, same,
                      law=relative_preload_torque,
                      assumption='"- f_a" in the first denominator; the available text has it beside')  # fmt: skip
    groove = groove_at(math.radians(4.44), math.pi / 4)
    right, wrong = float(relative_preload_torque(groove, FRICTION)), _printed_torque(groove)
    back = float(friction_from_torque(wrong, groove))
    printed = claim(PAPER, "eq. 7", '"- f_a" beside the fraction, as in the available text', f"{right:.4f} (screw A)",
                    f"{wrong:.4f}, from which eq. 8 gives f = {back:.4f}", abs(wrong - right) < 5e-5, law=None,
                    otherwise="a misprint of the text: only in the denominator does f = 0.034 come back")  # fmt: skip
    return corrected, printed


def _printed_torque(groove: Groove) -> float:
    """Relative torque by eq. (7) as the available text has it."""
    c = 1 / (1 + groove.tangent**2)
    first = FRICTION / (c * groove.sine * (groove.slope + FRICTION * groove.sine)) - FRICTION
    return float(first + FRICTION / (c * (groove.sine * groove.slope + FRICTION * groove.slope**2)))


def _inverse(grooves: Groove) -> tuple[Row, Row]:
    """(8) is the exact inverse of (7), and the stable form the same number."""
    relative = np.asarray(relative_preload_torque(grooves, FRICTION))
    found = np.asarray(friction_from_torque(relative, grooves))
    shown, same = _difference(found, np.full_like(found, FRICTION))
    exact = claim(PAPER, "eq. 8", "gives back any f put into eq. 7", "inverse of eq. 7", shown, same,
                  law=friction_from_torque,
                  assumption='"- f_a" of eq. 7 in the first denominator')  # fmt: skip
    t, a, b = relative, grooves.a_n, grooves.b_n
    shown, same = _difference(found, np.asarray(a * (np.sqrt(1 + t**2 * b**2) - 1) / (t * b**2)))
    form = claim(
        PAPER,
        "eq. 8",
        "as printed against the form without cancellation",
        "identical",
        shown,
        same,
        law=friction_from_torque,
    )
    return exact, form
