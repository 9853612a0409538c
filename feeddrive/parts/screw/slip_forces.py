"""Moment on the screw and axial force on the nut that one ball transmits while it slips.

    M   = r_m Q { sin(a) sin(b) + f [-sin(a) cos(psi_B) (cos(b) - r_a) + cos(a) sin(psi_B) (1 - r_a cos(b))] }
    F_a = Q { cos(a) sin(b) + f [cos(a) cos(b) cos(psi_A) + sin(a) sin(psi_A)] }

| symbol | meaning | unit |
|---|---|---|
| a, b | lead angle, contact angle | rad |
| psi_A, psi_B | slip angle at the nut contact A, at the screw contact B | rad |
| Q | normal load of the ball, equal at A and B | N |
| r_m | distance from axis to ball centre | m |
| r_a | ball diameter over diameter of the circle of ball centres; it cancels in the efficiency | 1 |
| f | Coulomb friction coefficient | 1 |

Source: paper 000, eqs. (3), (4), after Lin (1989). Eq. (3) stands in the available text as (-r_a cos b); only
(cos b - r_a) leads to eqs. (5) and (6).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from feeddrive.typing import FloatArray


def screw_moment(
    load: ArrayLike,
    radius: ArrayLike,
    lead_angle: ArrayLike,
    contact_angle: ArrayLike,
    slip_angle: ArrayLike,
    ball_ratio: ArrayLike,
    friction: ArrayLike,
) -> FloatArray:
    """M [N m] of one ball, eq. (3), with psi_B; arguments broadcast, units as in the table above."""
    a, psi, r_a = (np.asarray(value, dtype=float) for value in (lead_angle, slip_angle, ball_ratio))
    sin_b, cos_b = np.sin(contact_angle), np.cos(contact_angle)
    across = -np.sin(a) * np.cos(psi) * (cos_b - r_a)
    along = np.cos(a) * np.sin(psi) * (1 - r_a * cos_b)
    return np.asarray(np.asarray(radius) * load * (np.sin(a) * sin_b + np.asarray(friction) * (across + along)))


def axial_force(
    load: ArrayLike, lead_angle: ArrayLike, contact_angle: ArrayLike, slip_angle: ArrayLike, friction: ArrayLike
) -> FloatArray:
    """F_a [N] of one ball, eq. (4), with psi_A; arguments broadcast, units as in the table above."""
    a, b, psi = (np.asarray(value, dtype=float) for value in (lead_angle, contact_angle, slip_angle))
    slip = np.cos(a) * np.cos(b) * np.cos(psi) + np.sin(a) * np.sin(psi)
    return np.asarray(np.asarray(load) * (np.cos(a) * np.sin(b) + np.asarray(friction) * slip))
