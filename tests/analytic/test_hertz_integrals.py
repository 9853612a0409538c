"""Hertz's numbers beside his own integrals, summed numerically from the pressure under the ellipse.

The approach of a half space under p = p_max sqrt(1 - x²/a² - y²/b²) is, for any ellipse (Hertz 1881; Johnson, Contact
Mechanics (1985), section 4.2),

    w(x, y) = (3 Q c / 4 pi) ∫_0^∞ [1 - x²/(a² + s) - y²/(b² + s)] / sqrt((a² + s)(b² + s) s) ds

so that w = delta - A x² - B y² gives A, B and delta of an ellipse without an elliptic integral of the program.
"""

from __future__ import annotations

import math

import pytest
from scipy.integrate import quad

from feeddrive.parts.contact import ellipse_numbers


def integral(powers: tuple[float, float], a: float, b: float) -> float:
    """∫_0^∞ ds / ((a² + s)^m (b² + s)^n sqrt(s)), with s = tan²(t) so that it is finite and smooth."""

    def share(t: float) -> float:
        s = math.tan(t) ** 2
        return 2.0 / math.cos(t) ** 2 / ((a * a + s) ** powers[0] * (b * b + s) ** powers[1])

    # The integrand turns over where s = b²: told, so that slender ellipses are summed as well.
    return float(quad(share, 0.0, math.pi / 2, points=[math.atan(b), math.atan(a)], limit=200, epsrel=1e-11)[0])


@pytest.mark.parametrize("ellipticity", [1.0, 1.05, 1.3, 2.0, 3.5, 8.0, 15.0, 40.0])
def test_numbers_are_those_of_the_pressure(ellipticity: float) -> None:
    a, b = ellipticity, 1.0
    # With 3 Q c / 4 pi = 1: curvatures along a and b over two, and the approach.
    along, across, approach = (integral(p, a, b) for p in ((1.5, 0.5), (0.5, 1.5), (0.5, 0.5)))
    total = 2.0 * (along + across)
    size = (2.0 * math.pi / total) ** (1.0 / 3.0)  # s of the program, 3 Q c = 4 pi
    found = ellipse_numbers((2.0 * along, 2.0 * across))
    # Quadrature to 1e-11; near the circle the ellipticity goes as the root of the difference, which halves the digits.
    assert found.semi_major * size == pytest.approx(a, rel=1e-6)
    assert found.semi_minor * size == pytest.approx(b, rel=1e-6)
    assert 0.5 * found.approach * total * size**2 == pytest.approx(approach, rel=1e-9)
