"""Advancing a heat system by a constant step with inputs held over it.

Sparse: the two-stage SDIRK of second order, L-stable, γ = 1 - 1/√2, so that both stages share one factorisation.
Dense: the exact propagator exp(-C⁻¹K·h).
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import scipy.linalg
import scipy.sparse as sparse
import scipy.sparse.linalg

from feeddrive.thermal.rig import refuse_unless_positive
from feeddrive.typing import Expression, FloatArray

Stepper = Callable[[FloatArray, FloatArray], FloatArray]
"""(states (n,), inputs (m,)) -> states after the step (n,)."""

γ = 1 - 1 / np.sqrt(2)


def stepper_of(
    capacity: FloatArray, conductance: Expression, gains: FloatArray, step: float, substeps: int = 1
) -> Stepper:
    """The stepper of C dθ/dt = -Kθ + Bu over `step` [s], which a sparse system divides into `substeps`."""
    refuse_unless_positive(step, "s", "step")
    if sparse.issparse(conductance):
        return _implicit(capacity, conductance, gains, step / substeps, substeps)
    return _exact(capacity, conductance, gains, step)


def _implicit(capacity: FloatArray, conductance: Expression, gains: FloatArray, h: float, substeps: int) -> Stepper:
    matrix = sparse.diags_array(capacity) + γ * h * conductance
    solve = scipy.sparse.linalg.splu(matrix.tocsc(), permc_spec="MMD_AT_PLUS_A").solve

    def advance(state: FloatArray, given: FloatArray) -> FloatArray:
        source = γ * h * (gains @ given)
        for _ in range(substeps):
            stage = solve(capacity * state + source)
            state = solve(capacity * (state + (1 - γ) / γ * (stage - state)) + source)
        return state

    return advance


def _exact(capacity: FloatArray, conductance: FloatArray, gains: FloatArray, h: float) -> Stepper:
    propagator, input_map = exact_propagator(conductance / capacity[:, None], gains / capacity[:, None], h)

    def advance(state: FloatArray, given: FloatArray) -> FloatArray:
        return np.asarray(propagator @ state + input_map @ given)

    return advance


def exact_propagator(rate: FloatArray, gains: FloatArray, h: float) -> tuple[FloatArray, FloatArray]:
    """exp(-rate·h), (n, n), and its integral times the gains, (n, m): dx/dt = -rate·x + gains·u with u held."""
    n, m = gains.shape
    block = np.zeros((n + m, n + m))
    block[:n, :n], block[:n, n:] = -rate * h, gains * h
    whole = scipy.linalg.expm(block)
    return whole[:n, :n], whole[:n, n:]
