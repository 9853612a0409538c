"""How an axial load spreads over the balls along a nut: elastic balls between an elastic screw and an elastic nut body.

    d_i = c_E Q_i^(2/3) / (sin(a_0) cos(gamma_m)),     F_i = Q_i sin(a_0) cos(gamma_m),     sum F_i = F
    d_i - d_(i+1) = (s/E)(1/A_s + 1/A_n) S_i,     S_i = sum of F_j for j > i

| symbol | meaning | unit |
|---|---|---|
| i | ball along the nut, 1 at the end from which the screw is pulled | 1 |
| Q_i, F_i | load normal to the contact, its axial part | N |
| d_i | axial deflection at the ball | m |
| c_E | approach of screw and nut along the contact: c_E Q^(2/3) | m/N^(2/3) |
| s | axial pitch of the balls, loaded length over count | m |
| A_s, A_n | sections of screw and nut body | m^2 |
| E | modulus of elasticity of both | Pa |

Validity: screw in tension and nut in compression, or the reverse; no errors of lead or ball size (which can outweigh
elasticity), one contact angle for all balls, axial deformation alone. Source: paper 001, section 3.3 (a), states the
model and figure 5 without an equation; the equations are the standard bar-and-contact model of Izawa and of Mei and
Tsutsumi.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from feeddrive.parts.screw.screw_contact import SCREW_STEEL, BallTrack, contact_constant
from feeddrive.parts.values import PartValue, check_values
from feeddrive.typing import FloatArray


@dataclass(frozen=True)
class NutBody:
    """Sections that carry the axial force, and the contact, ready to be loaded.

    Attributes:
        track: balls and grooves.
        screw_section: A_s [m^2].
        nut_section: A_n [m^2].
        contact_constant: c_E [m/N^(2/3)].
        elastic_modulus: E of screw and nut body [Pa].

    Raises:
        InputError: a value that is not possible.

    Warns:
        ValidityWarning: unusual value.
    """

    track: BallTrack
    screw_section: float
    nut_section: float
    contact_constant: float
    elastic_modulus: float = SCREW_STEEL.elastic_modulus

    def __post_init__(self) -> None:
        check_values("nut body", _VALUES, {value.key: getattr(self, value.key) for value in _VALUES})


_VALUES = (
    PartValue("screw_section", "m^2", 0.0, usual=(5e-6, 0.03)),
    PartValue("nut_section", "m^2", 0.0, usual=(5e-6, 0.1)),
    PartValue("contact_constant", "m/N^(2/3)", 0.0),
    PartValue("elastic_modulus", "Pa", 0.0, usual=(5e10, 4.5e11)),
)
_FORCE = (PartValue("force", "N", 0.0, 1e9),)


def nut_body(track: BallTrack, outer_diameter: float) -> NutBody:
    """A steel nut of an outer diameter [m].

    A_s = pi (d_m - D_a)^2 / 4, up to the bottom of the screw's groove; A_n = pi (outer^2 - d_M^2) / 4, from the contact
    outwards, which lies between the nut's land and the bottom of its groove.

    Raises:
        InputError: an outer diameter that leaves no body.
    """
    groove = track.pitch_diameter + track.ball_diameter
    root = track.pitch_diameter - track.ball_diameter
    check_values("nut", (PartValue("outer_diameter", "m", groove, 1.0),), {"outer_diameter": outer_diameter})
    section = 0.25 * math.pi * (outer_diameter**2 - track.nut_diameter**2)
    return NutBody(track, 0.25 * math.pi * root**2, section, contact_constant(track))


@dataclass(frozen=True, eq=False)
class LoadDistribution:
    """Loads of the balls.

    Attributes:
        ball_loads: Q_i normal to the contact, (z,) [N].
    """

    ball_loads: FloatArray

    @property
    def relative(self) -> FloatArray:
        """Loads over their mean, (z,) [1]."""
        return np.asarray(self.ball_loads / self.ball_loads.mean(), dtype=float)


def load_distribution(body: NutBody, force: float) -> LoadDistribution:
    """Loads of all balls under an axial force F above 0 [N].

    The deflection of the last ball is sought; from it the recursion gives all others, and their sum rises with it.
    """
    check_values("nut", _FORCE, {"force": force})
    alone = _deflection(body, force)

    def surplus(last: float) -> float:
        return float(_axial_loads(body, force, last).sum()) / force - 1.0

    # Below 0 the last ball is free: the nut body has drawn away from it.
    low = 0.0
    while surplus(low) > 0.0:
        low -= alone
    last = brentq(surplus, low, alone, xtol=1e-15 * alone, rtol=1e-14)
    return LoadDistribution(_axial_loads(body, force, last) / body.track.axial_part)


def _axial_loads(body: NutBody, force: float, last: float) -> FloatArray:
    """F_i, (z,) [N], from the deflection of the last ball; a ball whose deflection is negative carries nothing."""
    pitch = body.track.loaded_length / body.track.balls / body.elastic_modulus
    screw, nut = pitch / body.screw_section, pitch / body.nut_section
    loads = np.zeros(body.track.balls)
    deflection, behind = last, 0.0
    for ball in range(body.track.balls - 1, -1, -1):
        loads[ball] = _load(body, deflection)
        behind += loads[ball]
        # So far from the solution that the rest does not matter, and powers would overflow.
        if behind > 1e3 * force:
            break
        deflection += (screw + nut) * behind
    return loads


def _deflection(body: NutBody, axial_load: float) -> float:
    """d [m] of a ball under an axial load [N]."""
    part = body.track.axial_part
    return float(body.contact_constant * (axial_load / part) ** (2.0 / 3.0) / part)


def _load(body: NutBody, deflection: float) -> float:
    """F [N] of a ball at a deflection [m]."""
    part = body.track.axial_part
    return float(part * (part * max(deflection, 0.0) / body.contact_constant) ** 1.5)
