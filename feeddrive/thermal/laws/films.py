"""Film coefficients of the turning screw and the travelling nut.

    h_s = 0.133 Re^(2/3) Pr^(1/3) λ_a / d,  Re = ω d²/ν_a          rotating cylinder, equation (30)
    h_n = (h_free⁴ + h_forced⁴ (N/N₀)²)^(1/4)                      free convection blended with laminar forced

| symbol | meaning | unit |
|---|---|---|
| ω, N | speed of the screw | rad/s, rev/min |
| d | diameter of the shaft | m |
| λ_a, ν_a, Pr | conductivity, kinematic viscosity, Prandtl number of air | W/(m K), m²/s, 1 |

Source: paper 002, section 4 and table 3. h_s of table 3 is 0.29033 N^(2/3), which (30) gives within 4 % for air at 23
to 27 degC; h_n is a fit, exact to 0.005 W/(m² K) between 250 and 750 rev/min and no more than plausible outside.

Thermal contact conductance of the balls against their preload.

    R = K/(2π λ_groove a) + K/(2π λ_ball a)          one contact, equation (11)
    C = Z / (R A)                                     per area, equation (12)

K is the complete elliptic integral of the ellipse's shape, λ a conductivity, Z the number of loaded balls. The long
semi-axis a of the contact grows with the third root of the load, and A, the area of the cylinder that the balls stand
for, does not: C grows with the third root of the preload. With the area of the Hertz ellipse, as the paper says, it
would fall, and its table 5 rises. Source: paper 002, section 2.3; Yovanovich 1971.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import casadi as ca
import numpy as np

from feeddrive.thermal.rig import refuse_negative, refuse_unless_positive
from feeddrive.typing import Expression, FloatArray

REFERENCE_SPEED = 250 * math.pi / 30
"""Speed at which films are declared: 250 rev/min [rad/s]."""


@dataclass(frozen=True)
class Air:
    """Air at about 25 degC.

    Attributes:
        conductivity: λ_a [W/(m K)].
        viscosity: ν_a [m²/s].
        prandtl: Pr [1].
    """

    conductivity: float = 0.0261
    viscosity: float = 15.6e-6
    prandtl: float = 0.71


def rotating_cylinder_film(speed: float, diameter: float, air: Air | None = None) -> float:
    """h at a speed [rad/s] and diameter [m] in still air, of about 25 degC if not given, equation (30) [W/(m² K)]."""
    refuse_unless_positive(diameter, "m", "diameter")
    a = air or Air()
    reynolds = abs(speed) * diameter**2 / a.viscosity
    return float(0.133 * reynolds ** (2 / 3) * a.prandtl ** (1 / 3) * a.conductivity / diameter)


@dataclass(frozen=True)
class Films:
    """Film coefficients against speed.

    Attributes:
        screw: h_s at 250 rev/min, growing with speed to the power 2/3 [W/(m² K)].
        screw_least: h_s at rest and slow speeds [W/(m² K)].
        nut_free: h_n at rest [W/(m² K)].
        nut_forced: h_n of the motion alone at 250 rev/min [W/(m² K)].
    """

    screw: float
    screw_least: float
    nut_free: float
    nut_forced: float

    def __post_init__(self) -> None:
        for key in ("screw", "screw_least", "nut_free", "nut_forced"):
            refuse_negative(getattr(self, key), "W/(m^2 K)", f"film.{key}")

    def on_screw(self, speeds: FloatArray) -> FloatArray:
        """h_s at speeds [rad/s], of the same shape [W/(m² K)]."""
        return _evaluated(film_on_screw, self, speeds)

    def on_nut(self, speeds: FloatArray) -> FloatArray:
        """h_n at speeds [rad/s], of the same shape [W/(m² K)]."""
        return _evaluated(film_on_nut, self, speeds)


def film_on_screw(speed: Expression, p: Mapping[str, Expression]) -> Expression:
    """h_s at a speed of the screw, not negative [rad/s], with the values of `Films`, [W/(m² K)]."""
    turning = p["screw"] * (speed / REFERENCE_SPEED) ** (2 / 3)
    # no maximum: at rest the slope of the power is infinite, and must not be multiplied by zero
    return ca.if_else(turning > p["screw_least"], turning, p["screw_least"])


def film_on_nut(speed: Expression, p: Mapping[str, Expression]) -> Expression:
    """h_n, arguments as `film_on_screw`, [W/(m² K)]."""
    return (p["nut_free"] ** 4 + p["nut_forced"] ** 4 * (speed / REFERENCE_SPEED) ** 2) ** 0.25


def _evaluated(
    law: Callable[[Expression, Mapping[str, Expression]], Expression], films: Films, speeds: FloatArray
) -> FloatArray:
    """A law at speeds of any shape."""
    shown = law(ca.DM(np.abs(np.ravel(speeds))), vars(films))
    return np.asarray(ca.DM(shown).full().reshape(np.shape(speeds)))


def conductance_at_preload(reference: float, preload: float, reference_preload: float) -> float:
    """C at another preload [N] than that of the reference, by the third root that (11) and (12) give [W/(m² K)]."""
    refuse_unless_positive(preload, "N", "preload")
    refuse_unless_positive(reference_preload, "N", "reference_preload")
    return float(reference * (preload / reference_preload) ** (1 / 3))
