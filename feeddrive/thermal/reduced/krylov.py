"""Moment matching: a basis on which a heat model keeps its answer at chosen rates and operating points.

The columns (s C + K)⁻¹ B and (s C + K)⁻¹ Lᵀ span a space on which the projected model has the full model's transfer
function and its first derivative at s (K is symmetric, so that both sides need one factorisation). Several s and
several operating points are gathered, and an SVD weighted by C leaves out what they have in common.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from feeddrive.thermal.reduced.system import HeatSystem
from feeddrive.typing import FloatArray

RATES = (1e-5, 2e-4, 1e-3, 5e-3, 3e-2, 0.2)
"""Matched rates s [1/s]: from the steady state (a day) to the quickest that a minute's step shows."""


def moments(system: HeatSystem, rates: Iterable[float] = RATES, scales: FloatArray | None = None) -> FloatArray:
    """Answers of the states to each input, and of the transposed system to each output, at some rates.

    Args:
        system: full system, K symmetric.
        rates: s [1/s].
        scales: working size of each input, (m,); None for equal sizes.

    Returns:
        Columns (n, k) of length one in the norm of C; inputs and outputs that do nothing are left out.
    """
    sizes = np.ones(len(system.input_names)) if scales is None else scales
    right = np.hstack([system.gains * sizes, system.rows.T])
    right = right[:, np.any(right != 0, axis=0)]
    found = np.hstack([system.shifted_solve(rate, right) for rate in rates])
    return np.asarray(found / np.sqrt(system.capacity @ found**2))


def orthonormal(columns: FloatArray, capacity: FloatArray, order: int | None = None) -> FloatArray:
    """Basis V of the dominant directions of some columns, VᵀCV = 1.

    Args:
        columns: (n, k).
        capacity: C, (n,).
        order: number of directions; None for all above rounding.

    Returns:
        (n, r).
    """
    root = np.sqrt(capacity)[:, None]
    left, strengths, _ = np.linalg.svd(root * columns, full_matrices=False)
    kept = int(np.sum(strengths > 1e-9 * strengths[0]))
    return np.asarray(left[:, : kept if order is None else min(order, kept)] / root)
