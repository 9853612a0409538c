"""Ball loads of a four-row guide under vertical and lateral load.

    V_j = (A0 sin a0 + s_j dx, A0 cos a0 + t_j dy),   s = (-, -, +, +),  t = (-, +, +, -)
    delta_j = |V_j| - A0 + lambda, not below 0,   tan a_j = V_jx / V_jy,   Q_j = (delta_j / C)^(3/2)
    z sum_j s_j Q_j sin a_j = F_x,   z sum_j t_j Q_j cos a_j = F_y

| symbol | meaning | unit |
|---|---|---|
| dx, dy | displacement of the carriage, vertical (into the rail) and lateral | m |
| F_x, F_y | vertical (pressing) and lateral load | N |
| V_j | from groove centre to groove centre, row j | m |
| delta_j, Q_j, a_j | approach, load of one ball, contact angle | m, N, rad |

The equations are the gradient of z sum (2/5) Q_j delta_j - F_x dx - F_y dy, which is convex: there is one equilibrium,
whichever rows have lost contact. Valid without moments, for rigid rail and carriage and elastic balls.
Source: paper 003, (1) to (5), table 1. Two corrections: (7) of the paper pairs the lateral line by part instead of by
side and counts two of the four rows; V_y of table 1 is A0 cos a0 (equal at 45 degrees only).

Stiffness of a ball guide with rigid rail and carriage, and the load at which its preload is lost.

    K = z sum_j [ (dQ/ddelta) n n' + (Q/|V|) (1 - n n') ],     F_0 = 2 z Q(delta_A) sin a_A  where  delta_B = 0

| symbol | meaning | unit |
|---|---|---|
| K | change of (F_x, F_y) with (dx, dy), tangent | N/m |
| n | line of contact of a row | 1 |
| F_0 | vertical load at which rows 1 and 2 lose contact | N |

Rail, carriage and bolts of a real guide yield too, so that it is softer than this.
Source: paper 003, (1) to (7), differentiated.
"""

from __future__ import annotations

import math
import warnings
from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize, root

from feeddrive.errors import InputError, ValidityWarning
from feeddrive.parts.guide.guide_geometry import BallGuide
from feeddrive.typing import FloatArray
from feeddrive.units.quantity import format_quantity

_SIDES = np.array([[-1.0, -1.0], [-1.0, 1.0], [1.0, 1.0], [1.0, -1.0]])
"""s_j and t_j of the rows."""

_CLOSED = 1e-11
"""Force that may be missing in the balance, over that of a row at the approach of the load [1]."""

HIGHEST_PRESSURE = 4.2e9
"""Pressure at which a ball leaves a lasting dent of 1e-4 of its diameter [Pa] (ISO 76, static rating)."""


@dataclass(frozen=True)
class GuideEquilibrium:
    """A carriage at rest under its load; rows in the order j = 1 to 4.

    Attributes:
        displacement: dx, dy [m].
        approach: delta of each row, shape (4,), 0 where it has lost contact [m].
        ball_load: Q, shape (4,) [N].
        contact_angle: a, shape (4,) [rad].
        stiffness: dF/d(dx, dy), shape (2, 2) [N/m].
    """

    displacement: FloatArray
    approach: FloatArray
    ball_load: FloatArray
    contact_angle: FloatArray
    stiffness: FloatArray


def guide_equilibrium(guide: BallGuide, vertical: float, lateral: float = 0.0) -> GuideEquilibrium:
    """Ball loads of one carriage under a vertical load, positive onto the rail, and a lateral one [N].

    Raises InputError: a load that is not finite, or so large that the balls leave their grooves; warns of contact
    pressure above `HIGHEST_PRESSURE`.
    """
    load = np.array([vertical, lateral], dtype=float)
    if not np.all(np.isfinite(load)):
        raise InputError("the load is not finite", "guide load", "write a number of newtons")
    size = guide.hertz_constant * (float(np.hypot(*load)) / guide.balls_per_row) ** (2 / 3) + guide.preload_oversize
    if size > 0.5 * guide.centre_distance:
        raise InputError(
            f"{format_quantity(float(np.hypot(*load)), 'N')} presses the balls out of their grooves",
            "guide load",
            "check its unit, it is that of one carriage",
        )
    displacement = _solve(guide, load, size) if size > 0.0 else np.zeros(2)
    return _checked(guide, _state(guide, displacement))


def forces(guide: BallGuide, displacement: FloatArray) -> FloatArray:
    """F_x, F_y that hold the carriage at dx, dy [m], shape (2,) [N]."""
    _, _, direction, load = _rows(guide, displacement)
    return np.asarray(guide.balls_per_row * np.sum(load[:, None] * direction * _SIDES, axis=0))


def _solve(guide: BallGuide, load: FloatArray, size: float) -> FloatArray:
    """Displacement at which the gradient of the energy vanishes; there is one, so wherever it is found it is right."""
    force = guide.balls_per_row * float((size / guide.hertz_constant) ** 1.5)

    def energy(u: FloatArray) -> float:
        approach, _, _, ball = _rows(guide, u * size)
        return float(0.4 * guide.balls_per_row * np.sum(ball * approach) / size - np.dot(load, u)) / force

    def gradient(u: FloatArray) -> FloatArray:
        return np.asarray((forces(guide, u * size) - load) / force)

    def curvature(u: FloatArray) -> FloatArray:
        return np.asarray(_stiffness(guide, u * size) * (size / force))

    def missing(u: FloatArray) -> float:
        return float(np.max(np.abs(gradient(u))))

    # From rest first, a tenth of the time; where that does not arrive, from the minimum of the energy.
    found = np.asarray(root(gradient, np.zeros(2), jac=curvature, options={"xtol": 1e-14}).x)
    if not missing(found) < _CLOSED:
        start = minimize(
            energy, np.zeros(2), jac=gradient, hess=curvature, method="trust-exact", options={"gtol": 1e-5}
        )
        polished = np.asarray(root(gradient, start.x, jac=curvature, options={"xtol": 1e-14}).x)
        found = min((np.asarray(start.x), polished), key=missing)
    return np.asarray(found * size)


def _rows(guide: BallGuide, displacement: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Approach [m], |V| [m], unit vector V/|V| (4, 2) and ball load [N] of the rows."""
    rest = guide.centre_distance * np.array([np.sin(guide.contact_angle), np.cos(guide.contact_angle)])
    centres = rest + _SIDES * displacement
    length = np.hypot(centres[:, 0], centres[:, 1])
    approach = np.maximum(length - guide.centre_distance + guide.preload_oversize, 0.0)
    return approach, length, centres / length[:, None], (approach / guide.hertz_constant) ** 1.5


def _stiffness(guide: BallGuide, displacement: FloatArray) -> FloatArray:
    """Second derivative of the energy: dQ/d(delta) along the line of contact, Q/|V| across it."""
    approach, length, direction, load = _rows(guide, displacement)
    slope = 1.5 * np.sqrt(approach) / guide.hertz_constant**1.5
    normal = direction * _SIDES
    along = np.einsum("j,jm,jn->mn", slope - load / length, normal, normal)
    return np.asarray(guide.balls_per_row * (along + np.sum(load / length) * np.eye(2)))


def _state(guide: BallGuide, displacement: FloatArray) -> GuideEquilibrium:
    approach, _, direction, load = _rows(guide, displacement)
    angle = np.arctan2(direction[:, 0], direction[:, 1])
    return GuideEquilibrium(displacement, approach, load, angle, _stiffness(guide, displacement))


def _checked(guide: BallGuide, state: GuideEquilibrium) -> GuideEquilibrium:
    highest = max(contact.maximum_pressure(float(state.ball_load.max())) for contact in guide.contacts)
    if highest > HIGHEST_PRESSURE:
        shown = f"{highest / 1e9:.3g} GPa"
        warnings.warn(
            f"guide: contact pressure of {shown} dents the races (above 4.2 GPa)", ValidityWarning, stacklevel=3
        )
    return state


def preload_force(guide: BallGuide) -> float:
    """Vertical force of a pair of rows without load [N]: 2 z Q sin a."""
    load = float(guide_equilibrium(guide, 0.0).ball_load[0])
    return 2.0 * guide.balls_per_row * load * math.sin(guide.contact_angle)


def unloading_force(guide: BallGuide) -> float:
    """F_0 [N] of one carriage without lateral load: 2 z Q sin a of the pair that stays. 0 without preload."""
    rise, width = (guide.centre_distance * f(guide.contact_angle) for f in (math.sin, math.cos))
    touching = guide.centre_distance - guide.preload_oversize
    displacement = rise - math.sqrt(touching**2 - width**2)
    length = math.hypot(rise + displacement, width)
    load = float(((length - touching) / guide.hertz_constant) ** 1.5)
    return 2.0 * guide.balls_per_row * load * (rise + displacement) / length
