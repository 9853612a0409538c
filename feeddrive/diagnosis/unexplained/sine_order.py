"""The order of the sine that fits best near a peak of the periodogram, beside a slow curve, from sums taken once.

Over the orders near a peak n0 that the travel tells apart, exp(i n a) turns by little more than exp(i n0 a). So all
sums that a fit at an order n needs follow from a few that are taken at n0:

    a = m + h u,   exp(i n a) = exp(i n m) exp(i n0 h u) Σ_p c_p J_p((n - n0) h) T_p(u),   c_0 = 1,  c_p = 2 i^p

| symbol | meaning | unit |
|---|---|---|
| a | angle; m its middle, h half of what it passes | rad |
| u | place within it, from -1 to 1 | 1 |
| n, n0 | orders, no farther apart than half of what the travel tells apart, pi / (2 h) | 1 |
| J_p, T_p | Bessel function, Chebyshev polynomial | 1 |

Source: Jacobi and Anger; Abramowitz and Stegun (1964), 9.1.44 and 9.1.45. The residual is as it is, not averaged over
cells: an order between two cells of a grid would be off.
"""

from __future__ import annotations

import numpy as np
from scipy.optimize import minimize_scalar
from scipy.special import jv

from feeddrive.diagnosis.motion.lead_map import SIZE, lead_map
from feeddrive.typing import ComplexArray, FloatArray

ONCE, TWICE = 13, 17
"""Polynomials for sums of the sine, and of its square, which turns twice as far: J_13(pi / 2) and J_17(pi) are below
1e-10."""

ROWS = 1 << 12
"""Samples that are summed at a time: their polynomials stay in a core's own memory."""


class SineOrder:
    """Orders of sines over one angle, beside a slow curve.

    What is left may be without a lead map (`motion.lead_map`), and without its curve the order would be off.

    Not a record: it holds what all fits have in common.
    """

    def __init__(self, angle: FloatArray) -> None:
        self._half = 0.5 * max(float(np.ptp(angle)), 1e-9)
        self._middle = float(np.min(angle)) + self._half
        self._place = (angle - self._middle) / self._half
        self._slow = np.vstack([np.ones(len(angle)), lead_map(angle, 1.0).T / SIZE])
        self._square = np.eye(2 + len(self._slow))
        self._square[2:, 2:] += self._slow @ self._slow.T

    def near(self, order: float, series: FloatArray) -> float:
        """The order at which a sine fits a series best.

        Args:
            order: of a peak, periods per revolution.
            series: (n,), any unit.

        Returns:
            The order, within half of what the travel tells apart about the peak.
        """
        once, twice = self._sums(order, series)
        square, moment = self._square.copy(), np.concatenate([np.zeros(2), self._slow @ series])

        def missed(n: float) -> float:
            turn = np.exp(1j * n * self._middle)
            beside = turn * (_factors(ONCE, (n - order) * self._half) @ once)
            double = turn**2 * (_factors(TWICE, 2 * (n - order) * self._half) @ twice)
            sines, cosines = beside.imag, beside.real
            square[0, 2:], square[1, 2:] = sines[:-1], cosines[:-1]
            square[2:, :2] = square[:2, 2:].T
            moment[:2] = sines[-1], cosines[-1]
            count = len(series)
            square[0, 0], square[1, 1] = 1 + 0.5 * (count - double.real), 1 + 0.5 * (count + double.real)
            square[0, 1] = square[1, 0] = 0.5 * double.imag
            return -float(moment @ np.linalg.solve(square, moment))

        width = 0.5 * np.pi / self._half  # half the distance of two orders that the travel tells apart
        bounds = max(order - width, 1e-6), order + width
        return float(minimize_scalar(missed, bounds=bounds, method="bounded", options={"xatol": 1e-3 * width}).x)

    def _sums(self, order: float, series: FloatArray) -> tuple[ComplexArray, ComplexArray]:
        """Sums of exp(i n0 h u) T_p(u) times the slow curve and the series, (p, k), and of its square, (p,)."""
        count = len(self._slow) + 1
        sums = np.zeros((TWICE, 2 * count + 2))
        shapes, turned = np.empty((TWICE, ROWS)), np.empty((2 * count + 2, ROWS))  # memory that is new costs time
        for first in range(0, len(series), ROWS):
            place = self._place[first : first + ROWS]
            rows = slice(first, first + len(place))
            t, y = shapes[:, : len(place)], turned[:, : len(place)]
            _polynomials(place, t)
            angle = order * self._half * place
            cosine, sine = np.cos(angle, out=y[-2]), np.sin(angle, out=y[-1])
            for k, column in enumerate((*self._slow[:, rows], series[rows])):
                np.multiply(column, cosine, out=y[k])
                np.multiply(column, sine, out=y[count + k])
            y[-2], y[-1] = cosine**2 - sine**2, 2 * sine * cosine
            sums += t @ y.T
        once = sums[:ONCE, :count] + 1j * sums[:ONCE, count : 2 * count]
        return once, sums[:, -2] + 1j * sums[:, -1]


def _polynomials(u: FloatArray, found: FloatArray) -> None:
    """Write Chebyshev polynomials of the first kind at places (n,) into a table (`TWICE`, n)."""
    found[0], found[1] = 1.0, u
    double = 2 * u
    for p in range(2, TWICE):
        np.multiply(double, found[p - 1], out=found[p])
        found[p] -= found[p - 2]


def _factors(count: int, z: float) -> ComplexArray:
    """c_p J_p(z) for p below a count, (count,)."""
    p = np.arange(count)
    factors: ComplexArray = np.where(p == 0, 1.0, 2.0) * 1j**p * jv(p, z)
    return factors
