"""What a slender screw stands: whirling and buckling, by its kind of support.

    w_c = 0.8 (lambda / l)^2 sqrt(E I / mu),     P = 0.5 n pi^2 E I / l^2,     I = pi d_s^4 / 64

| symbol | meaning | unit |
|---|---|---|
| w_c | highest screw speed | rad/s |
| P | highest axial force | N |
| lambda, n | of the kind of support, below | 1 |
| l | longest free piece: between the bearings (whirling), between nut and a bearing that takes force (buckling) | m |
| d_s | diameter counted for stiffness: root diameter where declared | m |
| mu | mass per length | kg/m |

The factors 0.8 and 0.5 are the margins of ball-screw catalogues. Source: beam of Euler and Bernoulli with the end
conditions named; catalogues of ball screws use the same formulas.
"""

from __future__ import annotations

import math

from feeddrive.parts.bearings.supports import Support
from feeddrive.parts.screw.ball_screw import ScrewShaft

WHIRLING = {
    Support.FIXED_FREE: 1.875,
    Support.SUPPORTED_SUPPORTED: math.pi,
    Support.FIXED_SUPPORTED: 3.927,
    Support.FIXED_FIXED: 4.730,
}
"""lambda: root of the first bending mode."""

BUCKLING = {
    Support.FIXED_FREE: 0.25,
    Support.SUPPORTED_SUPPORTED: 1.0,
    Support.FIXED_SUPPORTED: 2.0,
    Support.FIXED_FIXED: 4.0,
}
"""n: Euler's number of the end conditions."""

WHIRLING_MARGIN = 0.8
BUCKLING_MARGIN = 0.5


def critical_speed(screw: ScrewShaft, kind: Support, length: float) -> float:
    """Highest screw speed [rad/s] for a free length [m]."""
    bending = _bending_rigidity(screw)
    return WHIRLING_MARGIN * (WHIRLING[kind] / length) ** 2 * math.sqrt(bending / screw.mass_per_length)


def buckling_force(screw: ScrewShaft, kind: Support, length: float) -> float:
    """Highest axial force [N] for a loaded length [m]."""
    return BUCKLING_MARGIN * BUCKLING[kind] * math.pi**2 * _bending_rigidity(screw) / length**2


def _bending_rigidity(screw: ScrewShaft) -> float:
    """E I [N m^2]."""
    return screw.material.young * math.pi * screw.stiffness_diameter**4 / 64.0
