"""Balanced truncation of a dense heat system, the inputs and outputs weighted by the sizes they work at.

| symbol | meaning |
|---|---|
| P, Q | Gramians of what the inputs reach and what the outputs see, A P + P Aᵀ + B Bᵀ = 0, AᵀQ + Q A + LᵀL = 0 |
| σ | Hankel singular values: σ² are the eigenvalues of P Q; the error is at most twice the sum of those left out |

Source: Moore 1981; square-root form. A stable system stays stable. It is two-sided: K is no longer symmetric.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.linalg

from feeddrive.thermal.reduced.system import HeatSystem
from feeddrive.thermal.rig import refuse_unless
from feeddrive.typing import FloatArray


@dataclass(frozen=True, eq=False)
class Balance:
    """Balancing transformation of a system.

    Attributes:
        left, right: (n, r) each, leftᵀ right = 1; the reduced A is leftᵀ A right.
        strengths: Hankel singular values in the weighted sizes, (n,), largest first.
    """

    left: FloatArray
    right: FloatArray
    strengths: FloatArray


def balance(system: HeatSystem, order: int, input_sizes: FloatArray, output_sizes: FloatArray) -> Balance:
    """Balance a dense system.

    Args:
        system: dense, every C one, stable.
        order: number of states to keep.
        input_sizes: working size of each input, (m,) [W, K].
        output_sizes: size of each output that counts as one, (p,) [K, m].

    Raises:
        InputError: an order below one or above that of the system.
    """
    what = f"order {order} of a system of order {system.order}"
    refuse_unless(1 <= order <= system.order, what, "order", f"write a number from 1 to {system.order}")
    A, B, L = -system.conductance, system.gains * input_sizes, system.rows / output_sizes[:, None]
    reached = _root(scipy.linalg.solve_continuous_lyapunov(A, -B @ B.T))
    seen = _root(scipy.linalg.solve_continuous_lyapunov(A.T, -L.T @ L))
    u, strengths, vh = np.linalg.svd(seen.T @ reached)
    scale = 1 / np.sqrt(strengths[:order])
    return Balance(seen @ u[:, :order] * scale, reached @ vh[:order].T * scale, strengths)


def _root(gramian: FloatArray) -> FloatArray:
    """R with R Rᵀ = gramian, which rounding may have made slightly indefinite."""
    values, vectors = np.linalg.eigh((gramian + gramian.T) / 2)
    return np.asarray(vectors * np.sqrt(np.clip(values, 0.0, None)))
