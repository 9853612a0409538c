"""Declared values as nuisance coordinates of every fit: marginalised, not fitted one by one.

    y = f(θ, c0) + K (c - c0) + e,   c ~ N(0, 1),   e ~ N(0, λ)
    -2 log p(y|θ) = r' A r / λ + const,   r = y - f(θ, c0) + K c0,   A = (1 + K K'/λ)^-1 = W'W
    ĉ = (K'K + λ)^-1 K' r

| symbol | meaning | unit |
|---|---|---|
| y, f | measured and predicted channels over their noise, in the band | 1 |
| θ | coordinates of a set of effects | 1 |
| c | logarithms of declared values over what is declared, over their deviation, `declared` | 1 |
| c0, K | values at which the prediction is linear, its slope there, shared by all sets of a round | 1 |
| λ | variance of a row that stands for one independent value | 1 |

Every measured and predicted series of a fit passes W, so that an effect is worth what no declared value within its
tolerance does as well, in every set, at no simulation more. Source: Lindley and Smith, J. Roy. Statist. Soc. B 34
(1972) 1, for the marginal likelihood of a linear model.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from feeddrive.diagnosis.calibration.declared import CalibratedValue
from feeddrive.plant.plant import Plant
from feeddrive.recording import Recording
from feeddrive.typing import FloatArray


@dataclass(frozen=True, eq=False)
class Calibration:
    """Declared values that are fitted, and the slopes of every recording with them.

    Attributes:
        values: that are fitted.
        coordinates: c0, (k,).
        slopes: recording to channel to its slope with c, (n, k), SI.
        variance: λ.
        number_slopes: slope of the numbers that were measured beside the recordings, over their deviations, (n, k).
        taken: machine of which the slopes are; None where they are of none, or rough.
    """

    values: tuple[CalibratedValue, ...]
    coordinates: FloatArray
    slopes: Mapping[Recording, Mapping[str, FloatArray]]
    variance: float
    number_slopes: FloatArray = field(default_factory=lambda: np.zeros((0, 0)))
    taken: Plant | None = None


@dataclass(frozen=True, eq=False)
class Whitener:
    """W for the rows of a problem.

    Attributes:
        columns: K over the noise at those rows, (m, k).
        basis: left singular vectors of K, (m, k).
        sizes: its singular values, (k,).
        kept: what W leaves along each, (k,).
        offset: K c0, (m,).
        variance: λ.
    """

    columns: FloatArray
    basis: FloatArray
    sizes: FloatArray
    kept: FloatArray
    offset: FloatArray
    variance: float

    def applied(self, rows: FloatArray) -> FloatArray:
        """W times rows, (m,)."""
        result: FloatArray = rows - self.basis @ ((1 - self.kept) * (self.basis.T @ rows))
        return result

    def lengths(self, applied: FloatArray) -> FloatArray:
        """Lengths, (n,), that columns had before W was applied to them, (m, n)."""
        along = self.basis.T @ applied
        rest = np.sum(applied**2, axis=0) - np.sum(along**2, axis=0)
        found: FloatArray = np.sqrt(np.maximum(rest, 0.0) + np.sum((along / self.kept[:, None]) ** 2, axis=0))
        return found

    def most_likely(
        self, residual: FloatArray, low: FloatArray | float = -np.inf, high: FloatArray | float = np.inf
    ) -> FloatArray:
        """ĉ for y - f, (m,), with no value beyond its ends, (k,) each: one that would be ends there.

        The others are then solved for again.
        """
        normal: FloatArray = self.columns.T @ self.columns + self.variance * np.eye(self.columns.shape[1])
        wanted = self.columns.T @ (residual + self.offset)
        found, free = np.zeros(len(wanted)), np.ones(len(wanted), dtype=bool)
        while free.any():
            held = normal[np.ix_(free, ~free)] @ found[~free]
            found[free] = np.linalg.solve(normal[np.ix_(free, free)], wanted[free] - held)
            outside = free & ((found < low) | (found > high))
            if not outside.any():
                break
            found[outside] = np.clip(found, low, high)[outside]
            free &= ~outside
        return found

    def at(self, coordinates: FloatArray, variance: float) -> Whitener:
        """W of the same slopes with other c0, (k,), and λ."""
        return _whitener(self.columns, self.basis, self.sizes, coordinates, variance)


def whitener(columns: FloatArray, coordinates: FloatArray, variance: float) -> Whitener:
    """W of slopes over the noise, (m, k), with c0, (k,), and λ."""
    basis, sizes, _ = np.linalg.svd(columns, full_matrices=False)
    return _whitener(columns, basis, sizes, coordinates, variance)


def _whitener(
    columns: FloatArray, basis: FloatArray, sizes: FloatArray, coordinates: FloatArray, variance: float
) -> Whitener:
    kept: FloatArray = np.asarray(np.sqrt(variance / (sizes**2 + variance)), dtype=np.float64)
    return Whitener(columns, basis, sizes, kept, columns @ coordinates, variance)
