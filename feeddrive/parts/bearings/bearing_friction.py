"""Friction torque of ball bearings by their lubricant, after Palmgren.

    M_0 = 1e-7 f_0 (nu n)^(2/3) d_m^3     for nu n >= 2000,        160e-7 f_0 d_m^3     below      [N mm]

| symbol | meaning | unit |
|---|---|---|
| M_0 | torque by lubricant and speed | N mm here, N m at the function |
| nu | kinematic viscosity at the bearing's temperature, of a grease its base oil's | mm^2/s; m^2/s at the function |
| n | speed | rev/min; rad/s at the function |
| d_m | mean of bore and outer diameter | mm; m at the function |
| f_0 | factor of bearing and lubrication | 1 |

Validity: no rubbing seals; speeds below the catalogue's limit, lubricant well distributed; single values scatter by a
third or more. M_0 jumps by 0.8 per cent at nu n = 2000, as in the source, and acts with the sign of the speed.
Source: Harris, Rolling Bearing Analysis (2001), chapter 14, after Palmgren; paper 002, eqs. (15) and (17), which lacks
the factor 1e-7 and its units. The limit at 2000 is quoted from memory of Harris's text, not checked against the print.
"""

from __future__ import annotations

import math

import casadi as ca

from feeddrive.typing import Expression

RESTING_PRODUCT = 2000.0
"""nu n [mm^2/s rev/min] below which M_0 no longer falls with the speed."""

_VISCOUS = 1e-7
_RESTING = 160e-7
_NEWTON_MILLIMETRE = 1e-3


def palmgren_torque(
    viscous_factor: Expression, viscosity: Expression, speed: Expression, mean_diameter: Expression
) -> Expression:
    """M_0 [N m] of CasADi expressions or numbers.

    Args:
        viscous_factor: f_0 [1].
        viscosity: nu at the bearing's temperature [m^2/s].
        speed: n, not negative [rad/s].
        mean_diameter: d_m [m].
    """
    product = 1e6 * viscosity * speed * (30.0 / math.pi)
    # the power is taken where it acts alone: at rest its slope is infinite
    size = ca.if_else(
        product < RESTING_PRODUCT, _RESTING, _VISCOUS * ca.fmax(product, 0.5 * RESTING_PRODUCT) ** (2.0 / 3.0)
    )
    return size * viscous_factor * (1e3 * mean_diameter) ** 3 * _NEWTON_MILLIMETRE
