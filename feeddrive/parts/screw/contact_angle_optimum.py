"""Contact angle of the highest efficiency, in closed form.

    sin(beta*) = cos(45 deg - phi/2) / cos(alpha),     eta_max = (1 - sin phi) / (1 + sin phi),     phi = atan f

while the right side is below 1, that is for alpha <= 45 deg - phi/2; beyond, beta* is 90 deg. The maximum depends on f
alone.

| symbol | meaning | unit |
|---|---|---|
| alpha, beta | lead angle, contact angle | rad |
| phi | friction angle | rad |

Source: derived here from eqs. (5), (6) of paper 000, which finds the angle numerically: as a square thread, the screw
is at its best where delta = 45 deg - phi/2, and cos(beta) enters delta alone.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from feeddrive.typing import FloatArray


def best_contact_angle(lead_angle: ArrayLike, friction: ArrayLike) -> FloatArray:
    """beta* [rad] of the screw that drives, for lead angles [rad] and f; arguments broadcast."""
    return np.asarray(np.arcsin(np.minimum(np.cos(largest_lead_angle(friction)) / np.cos(lead_angle), 1.0)))


def highest_efficiency(friction: ArrayLike) -> FloatArray:
    """eta_max at any lead angle up to `largest_lead_angle`."""
    sine = np.sin(np.arctan(friction))
    return np.asarray((1 - sine) / (1 + sine))


def largest_lead_angle(friction: ArrayLike) -> FloatArray:
    """Lead angle [rad] up to which some contact angle reaches eta_max."""
    return np.asarray(math.pi / 4 - np.arctan(friction) / 2)


def friction_of_highest_efficiency(efficiency: ArrayLike) -> FloatArray:
    """The largest f with which a screw can reach this efficiency (0 to 1): the inverse of `highest_efficiency`."""
    eta = np.asarray(efficiency, dtype=float)
    return np.asarray(np.tan(np.arcsin((1 - eta) / (1 + eta))))
