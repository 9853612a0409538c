"""Hertz contact at a point: two curved elastic bodies pressed together over an ellipse.

    F(rho)  = |A - B| / (A + B),    A = rho_11 + rho_21,  B = rho_12 + rho_22,  Srho = A + B
    B / A   = (k^2 E - K) / (K - E),   K, E complete elliptic integrals of the parameter 1 - 1/k^2
    a       = a* s,  b = b* s,   s = [3 Q c / (2 Srho)]^(1/3),   c = (1 - xi_1^2)/E_1 + (1 - xi_2^2)/E_2
    delta   = C Q^(2/3),    C = (delta* Srho / 2) [3 c / (2 Srho)]^(2/3),    p_max = 3 Q / (2 pi a b)

| symbol | meaning | unit |
|---|---|---|
| rho_ij | curvature of body i in principal plane j, hollow negative | 1/m |
| k | ellipticity a/b | 1 |
| a, b | long and short semi-axis of the ellipse | m |
| a*, b*, delta* | Hertz's numbers, 1 for a circle | 1 |
| Q | load | N |
| delta | approach of the two bodies | m |
| C | Hertz's constant | m/N^(2/3) |
| p_max | pressure at the middle | Pa |

Valid for elastic bodies whose principal planes coincide, an ellipse small beside the radii, and 0 <= F(rho) < 1; with
F(rho) = 1 the bodies touch along a line.
Source: Hertz, J. reine angew. Math. 92 (1881) 156; Harris, Rolling Bearing Analysis (2001), chapter 6; paper 003, (2).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import TypeVar

import numpy as np
from scipy.optimize import brentq
from scipy.special import ellipe, ellipkm1, elliprd

from feeddrive.errors import InputError
from feeddrive.parts.values import PartValue, check_values
from feeddrive.typing import FloatArray

LONGEST_ELLIPSE = 1e4
"""Ellipticity beyond which a contact is called a line: F(rho) is within 1e-6 of 1."""

_LARGEST_LOAD, _LARGEST_APPROACH = 1e12, 1.0
"""Load [N] and approach [m] that no contact of a machine reaches; beyond them powers would overflow."""

Number = TypeVar("Number", float, FloatArray)
"""A load or an approach, one or an array of them."""


@dataclass(frozen=True)
class Material:
    """An elastic body.

    Attributes:
        elastic_modulus: [Pa].
        poisson_ratio: [1].
    """

    elastic_modulus: float
    poisson_ratio: float

    def __post_init__(self) -> None:
        check_values("material", MATERIAL_VALUES, vars(self))

    @property
    def compliance(self) -> float:
        """(1 - xi^2)/E [1/Pa]."""
        return (1.0 - self.poisson_ratio**2) / self.elastic_modulus


MATERIAL_VALUES = (
    PartValue("elastic_modulus", "Pa", 0.0, usual=(50e9, 700e9)),
    PartValue("poisson_ratio", "1", -1.0, 0.5, usual=(0.15, 0.4)),
)

BEARING_STEEL = Material(205.8e9, 0.3)
"""Balls and races as in table 2 of paper 003."""


@dataclass(frozen=True)
class Curvatures:
    """Principal curvatures of two bodies that touch, hollow negative [1/m].

    Attributes:
        first: of body 1, in principal plane 1 and 2.
        second: of body 2, in the same planes.
    """

    first: tuple[float, float]
    second: tuple[float, float]

    @property
    def relative(self) -> tuple[float, float]:
        """Relative curvature in plane 1 and 2: A, B [1/m]."""
        return self.first[0] + self.second[0], self.first[1] + self.second[1]

    @property
    def total(self) -> float:
        """Srho [1/m]."""
        return sum(self.relative)

    @property
    def difference(self) -> float:
        """F(rho) [1]: 0 for a circle, 1 for a line."""
        plane_1, plane_2 = self.relative
        return abs(plane_1 - plane_2) / self.total


@dataclass(frozen=True)
class EllipseNumbers:
    """Hertz's numbers of an ellipse, all 1 for a circle.

    Attributes:
        ellipticity: k = a/b.
        semi_major: a*.
        semi_minor: b*.
        approach: delta*.
    """

    ellipticity: float
    semi_major: float
    semi_minor: float
    approach: float


@dataclass(frozen=True)
class PointContact:
    """A contact ready to be loaded; made by `point_contact`.

    Attributes:
        curvatures: of the bodies.
        compliance: c, sum over both [1/Pa].
        numbers: of its ellipse.
    """

    curvatures: Curvatures
    compliance: float
    numbers: EllipseNumbers

    @property
    def constant(self) -> float:
        """C of delta = C Q^(2/3) [m/N^(2/3)]."""
        total = self.curvatures.total
        return 0.5 * self.numbers.approach * total * float((1.5 * self.compliance / total) ** (2 / 3))

    def approach(self, load: Number) -> Number:
        """delta [m] under the load [N]; refuses one that is negative or not finite."""
        result: Number = self.constant * _checked(load, "load", _LARGEST_LOAD) ** (2 / 3)
        return result

    def load(self, approach: Number) -> Number:
        """Q [N] at an approach [m]; refuses one that is negative or not finite."""
        result: Number = (_checked(approach, "approach", _LARGEST_APPROACH) / self.constant) ** 1.5
        return result

    def semi_axes(self, load: Number) -> tuple[Number, Number]:
        """a and b [m] under the load [N]; refuses one that is negative or not finite."""
        pressing = _checked(load, "load", _LARGEST_LOAD)
        size: Number = (1.5 * self.compliance / self.curvatures.total * pressing) ** (1 / 3)
        return self.numbers.semi_major * size, self.numbers.semi_minor * size

    def maximum_pressure(self, load: Number) -> Number:
        """p_max [Pa] under the load [N]; refuses one that is negative or not finite."""
        area = math.pi * self.numbers.semi_major * self.numbers.semi_minor
        size = 1.5 * self.compliance / self.curvatures.total
        result: Number = 1.5 / (area * size ** (2 / 3)) * _checked(load, "load", _LARGEST_LOAD) ** (1 / 3)
        return result


def point_contact(curvatures: Curvatures, first: Material, second: Material) -> PointContact:
    """The contact of two bodies by their curvatures in the principal planes that they share, and their materials.

    Raises InputError where they do not touch at a point: flat, hollow beyond the other's radius, or along a line.
    """
    return PointContact(curvatures, first.compliance + second.compliance, ellipse_numbers(curvatures.relative))


def ball_in_groove(diameter: float, conformity: float, material: Material = BEARING_STEEL) -> PointContact:
    """A ball in a straight groove of radius `conformity` times the ball's diameter [m], both of one material.

    Raises:
        InputError: a diameter that is not positive, conformity of 0.5 or less, or so near that the contact is a line.
    """
    check_values("ball", _BALL, {"diameter": diameter})
    if not conformity > 0.5:
        mend = "write a conformity above 0.5, such as 0.52"
        raise InputError(f"a groove of {conformity:g} ball diameters is narrower than the ball", "conformity", mend)
    ball = 2.0 / diameter
    return point_contact(Curvatures((ball, ball), (0.0, -1.0 / (conformity * diameter))), material, material)


_BALL = (PartValue("diameter", "m", 0.0, 10.0),)


def _checked(value: Number, name: str, largest: float) -> Number:
    """The value, where all of it lies from 0 to `largest`: a power of less than 0 would be complex."""
    if not np.all((np.asarray(value) >= 0.0) & (np.asarray(value) <= largest)):
        raise InputError(f"a {name} that is negative or not finite", "contact", f"write a {name} of 0 or more")
    return value


@lru_cache(maxsize=256)
def ellipse_numbers(relative: tuple[float, float]) -> EllipseNumbers:
    """Hertz's numbers for the relative curvatures A, B [1/m] of the two planes, in any order; kept, for balls repeat.

    Raises:
        InputError: as `point_contact`.
    """
    small, large = sorted(relative)
    if not (small > 0.0 and math.isfinite(large)):
        where = "curvatures"
        what = f"relative curvatures of {relative[0]:g} and {relative[1]:g} 1/m make no contact at a point"
        raise InputError(what, where, "both must be above 0 (hollow negative), and a cylinder on a plane is a line")
    ratio = large / small
    if ratio > _curvature_ratio(math.log(LONGEST_ELLIPSE)):
        raise InputError("the contact is a line, F(rho) is 1", "curvatures", "curve the bodies in both planes")
    logarithm = brentq(lambda k: math.log(_curvature_ratio(k) / ratio), 0.0, math.log(LONGEST_ELLIPSE), xtol=1e-14)
    return _numbers(math.exp(logarithm))


def _curvature_ratio(logarithm: float) -> float:
    """B/A at ln k. Carlson's integrals stand for E/(1 - m) - K and K - E, whose differences vanish for a circle."""
    complement = math.exp(-2.0 * logarithm)
    return float(elliprd(0.0, 1.0, complement) / elliprd(0.0, complement, 1.0))


def _numbers(k: float) -> EllipseNumbers:
    """a*, b*, delta* of an ellipticity."""
    complement = 1.0 / k**2
    first, second = float(ellipkm1(complement)), float(ellipe(1.0 - complement))
    semi_major = (2.0 * k**2 * second / math.pi) ** (1 / 3)
    return EllipseNumbers(k, semi_major, semi_major / k, 2.0 * first / (math.pi * semi_major))
