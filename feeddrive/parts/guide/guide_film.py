"""Oil film between ball and groove: thickness of an elastohydrodynamic point contact.

    U = eta_0 u / (E' R),   G = alpha_p E',   W = Q / (E' R^2),   u = v / 2,   R = d_b / 2
    h_min / R = 3.63 U^0.68 G^0.49 W^-0.073 (1 - exp(-0.68 k))
    h_c / R   = 2.69 U^0.67 G^0.53 W^-0.067 (1 - 0.61 exp(-0.73 k)),    h = (h_min + h_c) / 2

| symbol | meaning | unit |
|---|---|---|
| eta_0 | viscosity of the oil at ambient pressure | Pa s |
| alpha_p | pressure-viscosity coefficient | 1/Pa |
| v, u | speed of the carriage, entrainment speed | m/s |
| E' | 2/c of the contact's compliance, E/(1 - xi^2) for equal bodies | Pa |
| R | radius along the rolling direction | m |
| k | ellipticity a/b | 1 |
| h | film thickness, mean of smallest and central | m |

Valid fully flooded, isothermal and thicker than the roughness: at 1 mm/s the film is some nanometres, and what follows
from it there is the law continued, not physics.
Source: Hamrock and Dowson, Ball Bearing Lubrication (1981); paper 003, section 3.2, which leaves u, R and E' unsaid:
those given here are assumed.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from feeddrive.parts.contact import PointContact
from feeddrive.parts.values import PartValue, check_values
from feeddrive.typing import FloatArray

OIL_VALUES = (
    PartValue("viscosity", "Pa s", 0.0, usual=(1e-3, 10.0)),
    PartValue("pressure_viscosity", "1/Pa", 0.0, usual=(5e-9, 5e-8)),
)


@dataclass(frozen=True)
class Oil:
    """A lubricant at its running temperature.

    Attributes:
        viscosity: eta_0, dynamic viscosity [Pa s].
        pressure_viscosity: alpha_p [1/Pa].

    Raises:
        InputError: a value that is not possible.

    Warns:
        ValidityWarning: an unusual one.
    """

    viscosity: float
    pressure_viscosity: float

    def __post_init__(self) -> None:
        check_values("oil", OIL_VALUES, vars(self))


def film_thickness(
    contact: PointContact, ball_diameter: float, oil: Oil, speed: FloatArray, load: FloatArray
) -> FloatArray:
    """h [m] under a ball of d_b [m] that rolls at speeds of the carriage [m/s], not negative, loaded [N]."""
    radius, modulus, k = 0.5 * ball_diameter, 2.0 / contact.compliance, contact.numbers.ellipticity
    U = oil.viscosity * 0.5 * speed / (modulus * radius)
    G = oil.pressure_viscosity * modulus
    W = load / (modulus * radius**2)
    smallest = 3.63 * U**0.68 * G**0.49 * W**-0.073 * (1.0 - np.exp(-0.68 * k))
    central = 2.69 * U**0.67 * G**0.53 * W**-0.067 * (1.0 - 0.61 * np.exp(-0.73 * k))
    return np.asarray(0.5 * radius * (smallest + central))
