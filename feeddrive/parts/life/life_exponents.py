"""The exponents of rolling fatigue, and how they hang together.

    ln(1/S) ~ tau^c N^e A        (stressed area A, no factor of depth)
    L = (Q_c / Q)^p,   p = (c + 1) / (3 e),        Q_c ~ D_a^((2c - 4)/(c + 1)),        w = p e = (c + 1) / 3
    with Lundberg and Palmgren's factor of depth z^-h on the stressed volume:
    p = (c - h + 2) / (3 e),     Q_c ~ D_a^((2c + h - 5)/(c - h + 2))

| symbol | meaning | unit |
|---|---|---|
| c | exponent of the shear stress | 1 |
| e | Weibull slope, exponent of the cycles | 1 |
| h | exponent of the depth; 1 is the stressed area | 1 |
| p | exponent of the load in the life | 1 |
| w | exponent of the load in the probability of failure | 1 |

Source: paper 001, eqs. (1), (4), (7), (8) and table 2; Lundberg and Palmgren (1947) for h. The paper's c = 31.4 is not
measured: it is what p = 3 and e = 3.6 give. Its table for ball bearings mixes c of h = 7/3 with the formulas of h = 1.
"""

from __future__ import annotations

from dataclasses import dataclass

from feeddrive.parts.values import PartValue, check_values


@dataclass(frozen=True)
class LifeExponents:
    """Load-life exponent and Weibull slope; all others follow.

    Attributes:
        load: p [1].
        slope: e [1].

    Raises:
        InputError: a value that is not possible.

    Warns:
        ValidityWarning: unusual value.
    """

    load: float = 3.0
    slope: float = 3.6

    def __post_init__(self) -> None:
        check_values("life exponents", _VALUES, vars(self))

    @property
    def product(self) -> float:
        """w = p e [1]."""
        return self.load * self.slope

    @property
    def stress(self) -> float:
        """c = 3 p e - 1 of the stressed area [1]."""
        return 3.0 * self.product - 1.0


_VALUES = (
    PartValue("load", "1", 1.0, 10.0, usual=(2.5, 4.0)),
    PartValue("slope", "1", 0.1, 20.0, usual=(0.7, 6.0)),
)

_LAW = (PartValue("stress", "1", 5.0, 1e3), PartValue("depth", "1", 0.0, 5.0, open_ends=False))

BALL_SCREW = LifeExponents(3.0, 3.6)
"""Ball screws, table 2 of paper 001: p taken over from bearings, e of its ten specimens (90 % interval 2.0 to 4.9)."""

BALL_BEARING = LifeExponents(3.0, 10.0 / 9.0)
"""Ball bearings, Lundberg and Palmgren."""


def load_exponent(stress: float, slope: float, depth: float = 1.0) -> float:
    """p [1] from c, e and h; h = 1 is eq. (8).

    Raises:
        InputError: c, e or h that is not possible.
    """
    check_values("life exponents", (*_LAW, _VALUES[1]), {"stress": stress, "depth": depth, "slope": slope})
    return (stress - depth + 2.0) / (3.0 * slope)


def diameter_exponent(stress: float, depth: float = 1.0) -> float:
    """Exponent of the ball diameter in the rating [1] from c and h; h = 1 is eq. (11).

    Raises:
        InputError: c or h that is not possible.
    """
    check_values("life exponents", _LAW, {"stress": stress, "depth": depth})
    return (2.0 * stress + depth - 5.0) / (stress - depth + 2.0)
