"""Where a rolling contact is sheared most: on the axis of an elliptical contact, and under a line with traction.

On the axis of an elliptical Hertz contact at the depth z, stresses over the pressure p_max:

    s_z = -k / (q P),  q = 1 + (z/a)^2,  P = T q,  T = sqrt((k^2 + (z/a)^2) / q)     tau = (greatest - least stress) / 2

s_x and s_y hold incomplete elliptic integrals; they are written here with Carlson's symmetric ones, so that a circle is
no special case. Under a line contact that also transmits the traction f p:

    2 m^2, 2 n^2 = R +/- D,   D = 1 - x^2 + z^2,   R = sqrt(D^2 + 4 x^2 z^2)     (x, z over b; n with the sign of x)
    s_x = -m (1 + (z^2 + n^2)/(m^2 + n^2)) + 2 z + f [n (2 - (z^2 - m^2)/(m^2 + n^2)) - 2 x],   s_z, tau_xz likewise

| symbol | meaning | unit |
|---|---|---|
| a, b | semi-axes of the ellipse, b <= a; b half the width of a line | m |
| k | b / a | 1 |
| x, z | place along the rolling direction from the middle, depth | m |
| tau | greatest shear stress, on planes at 45 degrees to the principal ones | Pa |
| f | friction coefficient of the contact, traction f p everywhere in it | 1 |

Validity: elastic half-space. The axis holds the greatest shear stress of the contact without traction.
Source: paper 001, section 3.1 and figure 4; stresses on the axis after Thomas and Hoersch as in Johnson, Contact
Mechanics (1985), eq. (4.46); the line with traction after McEwen, Phil. Mag. 40 (1949) 454.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize, minimize_scalar
from scipy.special import elliprd, elliprf

from feeddrive.errors import InputError
from feeddrive.typing import FloatArray

POISSON = 0.3
_LEAST_RATIO, _DEEPEST = 1e-6, 1e6  # beyond them the integrals leave the range of numbers


@dataclass(frozen=True)
class ShearPeak:
    """Greatest shear stress: tau / p_max [1], and its depth over b [1]."""

    relative_stress: float
    relative_depth: float


def axis_stresses(ratio: float, depth: float, poisson: float = POISSON) -> tuple[float, float, float]:
    """Stresses over p_max on the axis: across (along a), in the direction of rolling (along b), into the depth.

    Args:
        ratio: k, above 0 and at most 1.
        depth: z / b, 0 or more.
        poisson: Poisson's ratio.

    Raises:
        InputError: ratio, depth or Poisson's ratio outside its range.
    """
    if not _LEAST_RATIO <= ratio <= 1.0:
        raise InputError(f"an axis ratio of {ratio:g}", "contact ellipse", "b / a lies above 0 and is 1 at most")
    if not (0.0 <= depth <= _DEEPEST and -1.0 < poisson < 0.5):
        what = f"a depth of {depth:g} b with a Poisson's ratio of {poisson:g}"
        raise InputError(what, "contact ellipse", "write a depth of 0 or more and a ratio such as 0.3")
    k, zeta, square = ratio, depth * ratio, 1.0 - ratio**2
    q = 1.0 + zeta**2
    T = float(np.sqrt((k**2 + zeta**2) / q))
    # F and D = (F - E) / e^2 of the angle acot(zeta); c2, d2 are zeta^2 / q and 1 - e^2 / q.
    sine, c2, d2 = q**-0.5, zeta**2 / q, T**2
    first = sine * float(elliprf(c2, d2, 1.0))
    second = sine**3 / 3.0 * float(elliprd(c2, d2, 1.0))
    third = first - second
    # Each Omega divided by e^2 = 1 - k^2, with the division carried out.
    across = -0.5 / (q * (1.0 + T)) + zeta * second
    across_poisson = (-1.0 + square - 2.0 * zeta**2 + square * zeta**2) / (q * k**2 * (k**2 + T)) + zeta * third / k**2
    rolling = 0.5 / (q * T * (1.0 + T)) + across_poisson
    rolling_poisson = -1.0 / (q * (1.0 + T)) + zeta * second
    stress_across = 2.0 * k * (across + poisson * across_poisson)
    stress_rolling = 2.0 * k * (rolling + poisson * rolling_poisson)
    return stress_across, stress_rolling, -k / (q * T)


def greatest_shear_on_axis(ratio: float, poisson: float = POISSON) -> ShearPeak:
    """Greatest shear stress under an elliptical contact without traction, and its depth; k = b/a, up to 1."""

    def loss(depth: float) -> float:
        stresses = axis_stresses(ratio, depth, poisson)
        return min(stresses) - max(stresses)

    found = minimize_scalar(loss, bounds=(0.1, 1.5), method="bounded", options={"xatol": 1e-9})
    return ShearPeak(-0.5 * float(found.fun), float(found.x))


def line_shear(place: FloatArray, depth: FloatArray, friction: float) -> FloatArray:
    """tau / p_max in the plane of rolling under a line contact whose traction is `friction` times its pressure.

    Args:
        place: x / b along the rolling direction, the traction on the body pointing to +, any shape.
        depth: z / b, 0 or more, same shape.
        friction: f.
    """
    x, z = place, depth
    difference = 1.0 - x**2 + z**2
    root = np.hypot(difference, 2.0 * x * z)
    m = np.sqrt(0.5 * (root + difference))
    n = np.sign(x) * np.sqrt(np.maximum(0.5 * (root - difference), 0.0))
    size = np.maximum(m**2 + n**2, 1e-30)
    along = -(m * (1.0 + (z**2 + n**2) / size) - 2.0 * z)
    into = -m * (1.0 - (z**2 + n**2) / size)
    shear = -n * (m**2 - z**2) / size
    along_of_traction = n * (2.0 - (z**2 - m**2) / size) - 2.0 * x
    # By reciprocity the traction's normal stress is the pressure's shear stress, and its shear that one's s_x.
    half = 0.5 * (along + friction * along_of_traction - into - friction * shear)
    return np.asarray(np.hypot(half, shear + friction * along), dtype=float)


def greatest_shear_under_line(friction: float) -> ShearPeak:
    """Greatest shear stress in the plane of rolling under a line contact with traction f, 0 to 1, and its depth.

    From f of about 0.3 on the surface itself is sheared as much: there tau / p_max = f.
    """
    if not 0.0 <= friction <= 1.0:
        raise InputError(f"a friction coefficient of {friction:g}", "line contact", "0 to 1 is possible")
    x, z = np.meshgrid(np.linspace(-1.0, 1.0, 81), np.linspace(0.0, 1.5, 61))
    start = int(np.argmax(line_shear(x, z, friction)))

    def loss(point: FloatArray) -> float:
        return -float(line_shear(point[0], point[1], friction))

    found = minimize(
        loss,
        (x.flat[start], z.flat[start]),
        method="Nelder-Mead",
        bounds=((-1.0, 1.0), (0.0, 2.0)),
        options={"xatol": 1e-8, "fatol": 1e-12},
    )
    return ShearPeak(-float(found.fun), float(found.x[1]))
