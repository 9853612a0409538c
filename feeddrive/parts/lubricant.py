"""The lubricant: kinematic viscosity against temperature.

    log10 log10(nu + 0.7) = A - B log10(T)

| symbol | meaning | unit |
|---|---|---|
| nu | kinematic viscosity | mm^2/s in the equations, m^2/s at every function |
| T | temperature | K |
| A, B | constants of the oil, from two measured viscosities | 1 |

Validity: Newtonian mineral and synthetic oils above their pour point, nu from 2 to 2e7 mm^2/s (below 2 the standard
adds further terms), between about -20 and 150 degC; at atmospheric pressure. A grease enters friction torques with the
viscosity of its base oil.
Source: Walther's law as in ASTM D341.
"""

from __future__ import annotations

import math
import warnings
from dataclasses import dataclass

import casadi as ca

from feeddrive.errors import InputError, ValidityWarning
from feeddrive.parts.values import PartValue, check_values
from feeddrive.typing import Expression

KELVIN = 273.15
LOWEST, HIGHEST = -20.0, 150.0
"""Temperatures between which the law is trusted [degC]."""

_HOTTEST = 500.0  # no oil is left [degC]
_SHIFT = 0.7
_SQUARE_MILLIMETRE = 1e-6
_LEAST = 2e-6


@dataclass(frozen=True)
class Lubricant:
    """An oil known at two temperatures.

    Attributes:
        viscosity_40, viscosity_100: nu at 40 and 100 degC [m^2/s].

    Raises:
        InputError: a value that is not possible, or an oil that thickens when warm.

    Warns:
        ValidityWarning: unusual value; mm^2/s written for m^2/s is refused.
    """

    viscosity_40: float
    viscosity_100: float

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

    def _shifted(self, temperature: Expression) -> Expression:
        """nu + 0.7 in mm^2/s."""
        fall = self.walther_slope * ca.log10((temperature + KELVIN) / (40.0 + KELVIN))
        return ca.exp(math.log(10.0) * ca.fmin(10.0 ** (_double_logarithm(self.viscosity_40) - fall), 300.0))


_VALUES = (
    PartValue("viscosity_40", "m^2/s", 1e-6, 0.1, usual=(2e-6, 4e-3)),
    PartValue("viscosity_100", "m^2/s", 1e-6, 0.1, usual=(1e-6, 2e-4)),
)


def _check_temperature(temperature: float) -> None:
    """Refuse a temperature [degC] at which there is no oil, the unit being the likeliest cause."""
    if not -KELVIN < temperature <= _HOTTEST:
        where = "below absolute zero" if temperature <= -KELVIN else f"no temperature of an oil up to {_HOTTEST:g} °C"
        raise InputError(f"{temperature:g} °C is {where}", "lubricant", "write the temperature in degC")


def _double_logarithm(viscosity: float) -> float:
    """log10 log10(nu + 0.7) of nu in m^2/s."""
    return math.log10(math.log10(viscosity / _SQUARE_MILLIMETRE + _SHIFT))
