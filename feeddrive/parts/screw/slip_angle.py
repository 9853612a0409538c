"""The groove of a ball screw as a ball meets it, and the direction in which the ball slips.

    tan psi0 = tan(alpha) / cos(beta),     R = sqrt(cos^2(beta) + tan^2(alpha))
    a_n = cos^2(alpha) sin(beta) R,        b_n = cos^2(alpha) R^2,        tan(delta) = R / sin(beta) = b_n / a_n

| symbol | meaning | unit |
|---|---|---|
| alpha | lead angle at the circle of ball centres, tan(alpha) = lead / (pi d_m) | rad |
| beta | contact angle, from the radial direction | rad |
| psi0 | slip angle in the plane of contact: its sine along the ball path, its cosine across it | rad |
| R | shorthand | 1 |
| a_n, b_n | geometry of the friction torque | 1 |
| delta | lead angle of the square thread with the same efficiency | rad |

delta makes the model the classical one: with the friction angle phi = atan f the efficiencies are
tan(delta)/tan(delta + phi) and tan(delta - phi)/tan(delta), exactly; a_n = sin(delta) cos(delta), b_n = sin^2(delta).
Source: paper 000, eqs. (1), (2), (8), after Lin (1989); delta is derived here. No centrifugal force.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from feeddrive.parts.elementary import cosine, sine
from feeddrive.typing import Expression, FloatArray


@dataclass(frozen=True)
class Groove:
    """Lead and contact direction: numbers, arrays that broadcast, or CasADi expressions.

    Attributes:
        tangent: tan(alpha), positive.
        sine: sin(beta), positive.
        cosine: cos(beta).
    """

    tangent: Expression
    sine: Expression
    cosine: Expression

    @property
    def slope(self) -> Expression:
        """R."""
        return (self.cosine**2 + self.tangent**2) ** 0.5

    @property
    def a_n(self) -> Expression:
        """a_n."""
        return self.sine * self.slope / (1 + self.tangent**2)

    @property
    def b_n(self) -> Expression:
        """b_n."""
        return self.slope**2 / (1 + self.tangent**2)


def groove_at(lead_angle: Expression, contact_angle: Expression) -> Groove:
    """The groove of lead angle alpha and contact angle beta [rad]; numbers, arrays or expressions."""
    return Groove(sine(lead_angle) / cosine(lead_angle), sine(contact_angle), cosine(contact_angle))


def groove_of_screw(lead: Expression, pitch_diameter: Expression, contact_angle: Expression) -> Groove:
    """The groove of a screw: lead and diameter d_m of the circle of ball centres [m], contact angle [rad]."""
    return Groove(lead / (math.pi * pitch_diameter), sine(contact_angle), cosine(contact_angle))


def slip_angle(groove: Groove) -> FloatArray:
    """psi0 [rad] (numbers or arrays)."""
    return np.asarray(np.arctan2(groove.tangent, groove.cosine))


def slip_angles_screw_drives(groove: Groove) -> tuple[FloatArray, FloatArray]:
    """Slip angles at nut and screw contact [rad] while the screw drives, eq. (1): psi_A = psi0 + pi, psi_B = psi0."""
    psi = slip_angle(groove)
    return psi + math.pi, psi


def slip_angles_nut_drives(groove: Groove) -> tuple[FloatArray, FloatArray]:
    """Slip angles at nut and screw contact [rad] while the nut drives, eq. (2): both friction forces reversed."""
    psi = slip_angle(groove)
    return psi, psi - math.pi


def thread_angle(groove: Groove) -> FloatArray:
    """delta [rad] (numbers or arrays)."""
    return np.asarray(np.arctan2(groove.slope, groove.sine))
