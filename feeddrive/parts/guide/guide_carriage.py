"""Friction of a ball guide: rolling, shearing of the oil film, differential slip, seals.

    F_r = mu_t z sum_j Q_j
    F_v = pi eta_0 v z sum_j sum_(r,c) a b / h
    F_s = (mu_s z / d_b) sum_j Q_j <R_d>,   <R_d> = (3/2) int_0^1 (1 - s^2) R_d(a s) ds
    R_d(u) = d_b/2 - sqrt(r_d^2 - u^2) + sqrt(r_d^2 - a^2) - sqrt(d_b^2/4 - a^2),   r_d = 2 f d_b / (2 f + 1)

| symbol | meaning | unit |
|---|---|---|
| z, j | balls in a row, the four rows of a carriage | 1 |
| Q | load of one ball | N |
| a, b | semi-axes of the contact, a across the rail | m |
| h | thickness of the oil film | m |
| v | speed of the carriage | m/s |
| mu_t, mu_s | rolling and slip coefficient | 1 |
| R_d | what the rolling radius at u lacks of d_b/2; <> its mean over Hertz's pressure | m |
| r_d | radius of the deformed contact surface across the rail | m |

Sums over four rows and both contacts (r, c) of a ball; slip is the mean of its contacts. Steady speed, isothermal,
Newtonian; the film is sheared at the full speed v (a law that fits, not one of traction); no cage, no recirculation.
Source: paper 003, (8) to (15). Corrections: (8) to (10) count two of the four rows, so that a carriage has twice their
force; in (10) limit and integrand are exchanged and pi is lost; in (13) the sign is minus and the coordinate that along
a. The seals are not in the paper; they are of the size of all the rest without load.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from feeddrive.errors import InputError
from feeddrive.parts.guide.guide_coefficients import GuideCoefficients
from feeddrive.parts.guide.guide_equilibrium import guide_equilibrium
from feeddrive.parts.guide.guide_film import film_thickness
from feeddrive.parts.guide.guide_geometry import BallGuide
from feeddrive.parts.values import PartValue, check_values
from feeddrive.typing import FloatArray

_MOST_CARRIAGES = 1000
_SEAL = (PartValue("seal_drag", "N", 0.0, 1e5, usual=(0.0, 100.0), open_ends=False),)

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(20)
_S, _S_WEIGHTS = 0.5 * (_NODES + 1.0), 0.5 * _WEIGHTS
"""Nodes and weights from 0 to 1; the slip radius is smooth, 20 of them leave rounding."""


@dataclass(frozen=True)
class GuideForces:
    """Friction at each speed, all positive [N], shape of `speed`.

    Attributes:
        speed: [m/s].
        rolling, viscous, slip, seal: its parts.
    """

    speed: FloatArray
    rolling: FloatArray
    viscous: FloatArray
    slip: FloatArray
    seal: FloatArray

    @property
    def total(self) -> FloatArray:
        """Sum of the parts [N]."""
        return self.rolling + self.viscous + self.slip + self.seal

    @property
    def coulomb(self) -> FloatArray:
        """What does not depend on speed [N]: rolling, slip and seal."""
        return self.rolling + self.slip + self.seal

    def shares(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Rolling, viscous and slip over their sum, without seals [1]; 0 where the sum is."""
        running = self.rolling + self.viscous + self.slip
        over = np.where(running > 0.0, running, 1.0)
        return self.rolling / over, self.viscous / over, self.slip / over


def carriage_friction(
    guide: BallGuide,
    coefficients: GuideCoefficients,
    speed: FloatArray | float,
    vertical: float = 0.0,
    lateral: float = 0.0,
    seal_drag: float = 0.0,
) -> GuideForces:
    """Friction of one carriage.

    Args:
        guide: its geometry and preload.
        coefficients: of rolling and slip, and the oil.
        speed: one or many, of either sign [m/s]; the forces oppose it and are given without sign.
        vertical, lateral: load on the carriage [N].
        seal_drag: of its seals [N].

    Raises:
        InputError: a speed or load that is not finite, seal drag below 0, or a load beyond the grooves.

    Warns:
        ValidityWarning: contact pressure that dents the races, or an unusual drag of the seals.
    """
    pace = np.abs(np.asarray(speed, dtype=float))
    if not np.all(np.isfinite(pace)):
        raise InputError("a speed is not finite", "guide speed", "write it as a number")
    check_values("guide", _SEAL, {"seal_drag": seal_drag})
    balls = guide_equilibrium(guide, vertical, lateral).ball_load
    loaded = balls[balls > 0.0]
    level = np.ones_like(pace)
    z = guide.balls_per_row
    return GuideForces(
        speed=pace,
        rolling=coefficients.rolling * z * float(loaded.sum()) * level,
        viscous=z * sum((_film_force(guide, coefficients, pace, float(load)) for load in loaded), 0.0 * level),
        slip=coefficients.slip * z * sum(_slip_force(guide, float(load)) for load in loaded) * level,
        seal=seal_drag * level,
    )


def table_friction(
    guide: BallGuide,
    coefficients: GuideCoefficients,
    carriages: int,
    speed: FloatArray | float,
    load_per_carriage: float = 0.0,
    seal_drag: float = 0.0,
) -> GuideForces:
    """Friction of a table on equal carriages that share its load equally; arguments and errors as one carriage's.

    Args:
        guide, coefficients, speed, seal_drag: as in `carriage_friction`.
        carriages: how many, at least one.
        load_per_carriage: vertical [N].
    """
    if not (1 <= carriages <= _MOST_CARRIAGES and carriages == int(carriages)):
        raise InputError(f"{carriages:g} carriages", "guide carriages", "write a whole number, at least 1")
    one = carriage_friction(guide, coefficients, speed, load_per_carriage, seal_drag=seal_drag)
    parts = (carriages * part for part in (one.rolling, one.viscous, one.slip, one.seal))
    return GuideForces(one.speed, *parts)


def mean_slip_radius(ball_diameter: float, conformity: float, semi_major: float) -> float:
    """<R_d> [m], the mean over Hertz's pressure, of d_b, f and a; 0.2154 a^2/d_b for a small ellipse, f = 0.52."""
    a, r = semi_major, 2.0 * conformity * ball_diameter / (2.0 * conformity + 1.0)
    half = 0.5 * ball_diameter
    # Differences of roots as quotients: each is of the size of a^2/d_b, and the roots themselves of d_b.
    at_edge = a**2 / (half + math.sqrt(half**2 - a**2))
    inside = a**2 * (1.0 - _S**2) / (np.sqrt(r**2 - (a * _S) ** 2) + math.sqrt(r**2 - a**2))
    return float(1.5 * np.sum(_S_WEIGHTS * (1.0 - _S**2) * (at_edge - inside)))


def _film_force(guide: BallGuide, coefficients: GuideCoefficients, speed: FloatArray, load: float) -> FloatArray:
    """Shearing the films of one ball [N]; 0 at rest, where v/h vanishes as v^0.325."""
    force = np.zeros_like(speed)
    moving = speed > 0.0
    for contact in guide.contacts:
        a, b = contact.semi_axes(load)
        h = film_thickness(contact, guide.ball_diameter, coefficients.oil, speed[moving], np.array(load))
        force[moving] += math.pi * coefficients.oil.viscosity * speed[moving] * a * b / h
    return force


def _slip_force(guide: BallGuide, load: float) -> float:
    """Differential slip of one ball over mu_s [N], mean of its two contacts."""
    conformities = (guide.rail_conformity, guide.carriage_conformity)
    radii = [
        mean_slip_radius(guide.ball_diameter, conformity, contact.semi_axes(load)[0])
        for contact, conformity in zip(guide.contacts, conformities, strict=True)
    ]
    return load / guide.ball_diameter * 0.5 * sum(radii)
