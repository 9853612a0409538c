"""The lubricant: kinematic viscosity and density against temperature.

    log10 log10(nu + 0.7) = A - B log10(T)        d nu/dT = -B (nu + 0.7) ln(nu + 0.7) / T
    rho = rho_15 (1 - beta (t - 15))

| symbol | meaning | unit |
|---|---|---|
| nu | kinematic viscosity | mm^2/s in the equations, m^2/s at every function |
| T, t | temperature | K, degC |
| A, B | constants of the oil, from two measured viscosities | 1 |
| rho, rho_15 | density, at 15 degC | kg/m^3 |
| beta | coefficient of expansion | 1/K |

Validity: Newtonian mineral and synthetic oils above their pour point, nu from 2 to 2e7 mm^2/s (below 2 the standard
adds further terms), between about -20 and 150 degC; at atmospheric pressure. A grease enters friction torques with the
viscosity of its base oil.
Source: Walther's law as in ASTM D341; grades of ISO 3448: nu at 40 degC, each within 10 per cent.
"""

from __future__ import annotations

import math
import warnings
from dataclasses import dataclass

import casadi as ca

from feeddrive.errors import InputError, ValidityWarning
from feeddrive.parts.values import PartValue, check_values
from feeddrive.typing import Expression

ISO_GRADES = (2.2, 3.2, 4.6, 6.8, 10, 15, 22, 32, 46, 68, 100, 150, 220, 320, 460, 680, 1000, 1500, 2200, 3200)
"""ISO 3448: middle of the grade's range of viscosity at 40 degC [mm^2/s]; a grade's name is this number, rounded."""

GRADE_TOLERANCE = 0.1
"""Half the range of a grade over its middle [1]."""

KELVIN = 273.15
LOWEST, HIGHEST = -20.0, 150.0
"""Temperatures between which the law is trusted [degC]."""

_HOTTEST = 500.0  # no oil is left [degC]
_SHIFT = 0.7
_SQUARE_MILLIMETRE = 1e-6
_LEAST = 2e-6


@dataclass(frozen=True)
class Lubricant:
    """An oil known at two temperatures; `mineral_oil` where only its grade is known.

    Attributes:
        viscosity_40, viscosity_100: nu at 40 and 100 degC [m^2/s].
        density_15: at 15 degC [kg/m^3].
        expansion: beta [1/K].

    Raises:
        InputError: a value that is not possible, or an oil that thickens when warm.

    Warns:
        ValidityWarning: unusual value; mm^2/s written for m^2/s is refused.
    """

    viscosity_40: float
    viscosity_100: float
    density_15: float = 870.0
    expansion: float = 6.7e-4

    def __post_init__(self) -> None:
        check_values("lubricant", _VALUES, vars(self))
        if self.viscosity_100 >= self.viscosity_40:
            raise InputError("the oil is not thinner at 100 degC", "lubricant.viscosity_100", "check both viscosities")

    @property
    def walther_slope(self) -> float:
        """B [1]."""
        cold, warm = (_double_logarithm(nu) for nu in (self.viscosity_40, self.viscosity_100))
        return (cold - warm) / math.log10((100.0 + KELVIN) / (40.0 + KELVIN))

    def viscosity(self, temperature: float) -> float:
        """nu [m^2/s] at a temperature [degC].

        Warns:
            ValidityWarning: outside -20 to 150 degC, or thinner than 2 mm^2/s.

        Raises:
            InputError: at or below absolute zero, or above 500 degC.
        """
        _check_temperature(temperature)
        nu = float(self.viscosity_law(temperature))
        if not LOWEST <= temperature <= HIGHEST or nu < _LEAST:
            text = f"lubricant: {nu / _SQUARE_MILLIMETRE:.3g} mm²/s at {temperature:g} °C lies outside Walther's law"
            warnings.warn(
                f"{text}, good from {LOWEST:g} to {HIGHEST:g} °C above 2 mm²/s", ValidityWarning, stacklevel=2
            )
        return nu

    def viscosity_law(self, temperature: Expression) -> Expression:
        """nu [m^2/s] as `viscosity`, unchecked, of a CasADi expression or a number."""
        return _SQUARE_MILLIMETRE * (self._shifted(temperature) - _SHIFT)

    def viscosity_slope(self, temperature: float) -> float:
        """d nu/dT [m^2/s/K] at a temperature [degC], negative.

        Raises:
            InputError: at or below absolute zero, or above 500 degC.
        """
        _check_temperature(temperature)
        shifted = float(self._shifted(temperature))
        slope = -self.walther_slope * shifted * math.log(shifted) / (temperature + KELVIN)
        return _SQUARE_MILLIMETRE * slope

    def density(self, temperature: float) -> float:
        """rho [kg/m^3] at a temperature [degC].

        Raises:
            InputError: at or below absolute zero, or above 500 degC.
        """
        _check_temperature(temperature)
        return self.density_15 * (1.0 - self.expansion * (temperature - 15.0))

    def dynamic_viscosity(self, temperature: float) -> float:
        """eta = nu rho [Pa s] at a temperature [degC]; raises and warns as `viscosity`."""
        return self.viscosity(temperature) * self.density(temperature)

    def _shifted(self, temperature: Expression) -> Expression:
        """nu + 0.7 in mm^2/s."""
        fall = self.walther_slope * ca.log10((temperature + KELVIN) / (40.0 + KELVIN))
        return ca.exp(math.log(10.0) * ca.fmin(10.0 ** (_double_logarithm(self.viscosity_40) - fall), 300.0))


_VALUES = (
    PartValue("viscosity_40", "m^2/s", 1e-6, 0.1, usual=(2e-6, 4e-3)),
    PartValue("viscosity_100", "m^2/s", 1e-6, 0.1, usual=(1e-6, 2e-4)),
    PartValue("density_15", "kg/m^3", 500.0, 3000.0, usual=(780.0, 1100.0)),
    PartValue("expansion", "1/K", 0.0, 0.01, usual=(5e-4, 1e-3)),
)

MINERAL_OILS = {10: 2.65, 15: 3.4, 22: 4.3, 32: 5.3, 46: 6.7, 68: 8.6, 100: 11.2, 150: 14.8, 220: 19.0}
"""Grade -> nu at 100 degC [mm^2/s] of a mineral oil of a viscosity index of 95 to 101 by ASTM D2270, typical of
circulating and hydraulic oils; oils differ by 5 per cent and more, and the two viscosities of a data sheet in
`Lubricant` are better."""


def mineral_oil(grade: float) -> Lubricant:
    """A typical mineral oil of an ISO VG grade, of the grade's middle viscosity at 40 degC.

    Args:
        grade: number of the grade, such as 32.

    Raises:
        InputError: no ISO grade, or one for which no typical oil is listed; names those that are.
    """
    if grade not in MINERAL_OILS:
        kind = (
            "no typical oil is listed"
            if grade in [round(middle) for middle in ISO_GRADES]
            else "there is no such ISO grade"
        )
        grades = ", ".join(str(one) for one in MINERAL_OILS)
        raise InputError(f"VG {grade:g}: {kind}", "lubricant.grade", f"take one of {grades}, or give both viscosities")
    return Lubricant(grade * _SQUARE_MILLIMETRE, MINERAL_OILS[int(grade)] * _SQUARE_MILLIMETRE)


def _check_temperature(temperature: float) -> None:
    """Refuse a temperature [degC] at which there is no oil, the unit being the likeliest cause."""
    if not -KELVIN < temperature <= _HOTTEST:
        where = "below absolute zero" if temperature <= -KELVIN else f"no temperature of an oil up to {_HOTTEST:g} °C"
        raise InputError(f"{temperature:g} °C is {where}", "lubricant", "write the temperature in degC")


def _double_logarithm(viscosity: float) -> float:
    """log10 log10(nu + 0.7) of nu in m^2/s."""
    return math.log10(math.log10(viscosity / _SQUARE_MILLIMETRE + _SHIFT))
