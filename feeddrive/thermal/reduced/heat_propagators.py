"""Exact steps of a reduced heat network, and their exact slopes with its matrices.

    C dθ/dt = -K θ + B u over h:    x₁ = Φ x + Γ u,  Φ = e^(-hS),  Γ = ∫ e^(-tS) dt C^(-1/2) B,  S = C^(-1/2) K C^(-1/2)
    S = V Λ Vᵀ:    dΦ = V (F ∘ Vᵀ dS V) Vᵀ,    F_ij = (f(λ_i) - f(λ_j)) / (λ_i - λ_j),  F_ii = f'(λ_i)

| symbol | meaning | unit |
|---|---|---|
| x | states times C^(1/2): S is symmetric, as K is | K (J/K)^½ |
| f | e^(-hλ) of Φ, (1 - e^(-hλ))/λ of the integral | 1, s |

Source: derivative of a function of a symmetric matrix after Daleckii and Krein; Higham, Functions of Matrices (2008),
theorem 3.11.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import scipy.linalg

from feeddrive.typing import FloatArray

_NEAR = 1e-5
"""Difference of two rates times the step below which a quotient of differences is taken as the slope at their mean: its
error is the square of it, that of the quotient the rounding over it."""


@dataclass(frozen=True, eq=False)
class Propagator:
    """One step at fixed matrices.

    Attributes:
        step: h [s].
        rates: λ, (n,) [1/s].
        modes: V, (n, n).
        gains: C^(-1/2) B, (n, m).
        propagator, input_map: Φ, (n, n), and Γ, (n, m).
    """

    step: float
    rates: FloatArray
    modes: FloatArray
    gains: FloatArray
    propagator: FloatArray
    input_map: FloatArray

    def held(self, start: FloatArray, inputs: FloatArray, count: int) -> FloatArray:
        """States at the ends of `count` steps under constant inputs, (count, n): a power for each mode."""
        driven = self.modes.T @ (self.gains @ inputs)
        shown = held_states(self.rates, driven, count, self.step, self.modes.T @ start)
        return np.asarray(shown @ self.modes.T)

    def slopes(self, matrix: FloatArray, gains: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Slopes of Φ and Γ with a parameter, from those of S, (n, n), and of C^(-1/2) B, (n, m)."""
        h, V = self.step, self.modes
        turned = V.T @ matrix @ V
        decay = _quotients(self.rates, h, _decay, _decay_slope)
        integral = _quotients(self.rates, h, _integral, _integral_slope)
        propagator = V @ (decay * turned) @ V.T
        fed = V @ ((integral * turned) @ (V.T @ self.gains) + _integral(self.rates, h)[:, None] * (V.T @ gains))
        return propagator, fed


def propagator(matrix: FloatArray, gains: FloatArray, step: float) -> Propagator:
    """The step of S, (n, n), symmetric, and C^(-1/2) B, (n, m), over `step` [s]."""
    rates, modes = scipy.linalg.eigh(matrix)
    rates = np.maximum(rates, 0.0)  # none is negative but by rounding
    kept = (modes * _decay(rates, step)) @ modes.T
    fed = (modes * _integral(rates, step)) @ (modes.T @ gains)
    return Propagator(step, rates, modes, gains, kept, fed)


def held_states(
    rates: FloatArray, driven: FloatArray, count: int, step: float, start: FloatArray | None = None
) -> FloatArray:
    """Modes at the ends of `count` steps, (count, n), of rates λ, (n,), under constant drives, from rest or a start."""
    times = np.arange(1.0, count + 1)[:, None] * step
    shown = _integral_over(rates, times) * driven
    return shown if start is None else np.asarray(np.exp(-times * rates) * start + shown)


def _decay(rates: FloatArray, h: float) -> FloatArray:
    return np.asarray(np.exp(-h * rates))


def _decay_slope(rates: FloatArray, h: float) -> FloatArray:
    return np.asarray(-h * np.exp(-h * rates))


def _integral(rates: FloatArray, h: float) -> FloatArray:
    return _integral_over(rates, np.float64(h))


def _integral_over(rates: FloatArray, times: FloatArray | np.float64) -> FloatArray:
    """(1 - e^(-λt)) / λ, t where λ is zero, at one time or several, (k, 1)."""
    safe = np.where(rates > 0, rates, 1.0)
    return np.asarray(np.where(rates > 0, -np.expm1(-times * safe) / safe, times))


def _integral_slope(rates: FloatArray, h: float) -> FloatArray:
    z = h * rates
    safe = np.where(z > 1e-3, z, 1.0)
    far = (safe * np.exp(-safe) + np.expm1(-safe)) / safe**2
    near = -0.5 + z / 3 - z**2 / 8 + z**3 / 30
    return np.asarray(h**2 * np.where(z > 1e-3, far, near))


def _quotients(
    rates: FloatArray,
    h: float,
    law: Callable[[FloatArray, float], FloatArray],
    slope: Callable[[FloatArray, float], FloatArray],
) -> FloatArray:
    """(f(λ_i) - f(λ_j)) / (λ_i - λ_j), (n, n)."""
    apart = rates[:, None] - rates[None, :]
    near = np.abs(apart) * h < _NEAR
    values = law(rates, h)
    return np.where(
        near,
        slope((rates[:, None] + rates[None, :]) / 2, h),
        (values[:, None] - values[None, :]) / np.where(near, 1.0, apart),
    )
