"""The reduced model: a few states, the full model's class, its conductances still parameters.

1. Moments of the full model at several rates and at operating points spread over the range (`moments`): a wide basis.
2. On that basis, dense, each point is balanced; its strongest directions are gathered, weighted, and an SVD gives the
   basis V of the order that was asked for.
3. Congruence: C_r = VᵀCV = 1, K_r(g) = VᵀK₀V + Σ gᵢ VᵀKᵢV. As every g ≥ 0 keeps K_r symmetric and not negative, the
   model is stable and passive at every operating point, also while conductances change within a run.

Moment matching: a basis on which a heat model keeps its answer at chosen rates and operating points.

The columns (s C + K)⁻¹ B and (s C + K)⁻¹ Lᵀ span a space on which the projected model has the full model's transfer
function and its first derivative at s (K is symmetric, so that both sides need one factorisation). Several s and
several operating points are gathered, and an SVD weighted by C leaves out what they have in common.

Balanced truncation of a dense heat system, the inputs and outputs weighted by the sizes they work at.

| symbol | meaning |
|---|---|
| P, Q | Gramians of what the inputs reach and what the outputs see, A P + P Aᵀ + B Bᵀ = 0, AᵀQ + Q A + LᵀL = 0 |
| σ | Hankel singular values: σ² are the eigenvalues of P Q; the error is at most twice the sum of those left out |

Source: Moore 1981; square-root form. A stable system stays stable. It is two-sided: K is no longer symmetric.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from itertools import product

import numpy as np
import scipy.linalg

from feeddrive.thermal.reduced.parametric_model import AMBIENT, COOLANT, HeatModel, Path
from feeddrive.thermal.reduced.system import HeatSystem
from feeddrive.thermal.rig import refuse_unless
from feeddrive.typing import FloatArray

RATES = (1e-5, 2e-4, 1e-3, 5e-3, 3e-2, 0.2)
"""Matched rates s [1/s]: from the steady state (a day) to the quickest that a minute's step shows."""


def moments(system: HeatSystem, rates: Iterable[float] = RATES, scales: FloatArray | None = None) -> FloatArray:
    """Answers of the states to each input, and of the transposed system to each output, at some rates s [1/s].

    `scales` are working sizes of the inputs, (m,), or equal. Columns (n, k) of length one in the norm of C; inputs and
    outputs that do nothing are left out.
    """
    sizes = np.ones(len(system.input_names)) if scales is None else scales
    right = np.hstack([system.gains * sizes, system.rows.T])
    right = right[:, np.any(right != 0, axis=0)]
    found = np.hstack([system.shifted_solve(rate, right) for rate in rates])
    return np.asarray(found / np.sqrt(system.capacity @ found**2))


def orthonormal(columns: FloatArray, capacity: FloatArray, order: int | None = None) -> FloatArray:
    """Basis V (n, r) of the dominant directions of columns (n, k), VᵀCV = 1, of `order` or of all above rounding."""
    root = np.sqrt(capacity)[:, None]
    left, strengths, _ = np.linalg.svd(root * columns, full_matrices=False)
    kept = int(np.sum(strengths > 1e-9 * strengths[0]))
    return np.asarray(left[:, : kept if order is None else min(order, kept)] / root)


DEFAULT_ORDER = 36
"""Within 2 mK and 5 nm of the full model over the wide range of `Heat.limits`."""

_GATHERED = 20


@dataclass(frozen=True)
class Sizes:
    """Sizes that inputs and outputs work at: they weight the reduction and scale its stated error.

    Attributes:
        heats: input name to its heat [W]; others have `other_heat`.
        other_heat: [W].
        surroundings: swing of ambient and coolant [K].
        rise: error of a temperature that counts as one [K].
        growth: error of a growth that counts as one [m].
    """

    heats: tuple[tuple[str, float], ...] = (("nut", 3.0),)
    other_heat: float = 1.0
    surroundings: float = 2.0
    rise: float = 0.01
    growth: float = 0.02e-6

    def of_inputs(self, names: Iterable[str]) -> FloatArray:
        """Size of each input, (m,)."""
        known = {AMBIENT: self.surroundings, COOLANT: self.surroundings, **dict(self.heats)}
        return np.array([known.get(name, self.other_heat) for name in names])

    def of_outputs(self, names: Iterable[str]) -> FloatArray:
        """Size of each output, (p,)."""
        return np.array([self.growth if name.startswith("growth") else self.rise for name in names])


def reduce_model(
    models: Iterable[HeatModel],
    limits: Mapping[Path, tuple[float, float]],
    order: int = DEFAULT_ORDER,
    sizes: Sizes | None = None,
) -> tuple[HeatModel, ...]:
    """Reduce full models of one rig at one or several travels on one common basis.

    Args:
        models: one a travel; the states of a model on the common basis mean the same in all of them.
        limits: path to the range of its conductance; within it the model is meant to hold.
        order: number of states.
        sizes: working sizes; None for those of a small axis.

    Returns:
        The reduced models, in the order given; they warn outside `limits`.
    """
    full = tuple(models)
    basis = common_basis(full, limits, order, sizes)
    return tuple(replace(model.projected(basis), limits=dict(limits)) for model in full)


def common_basis(
    models: Iterable[HeatModel],
    limits: Mapping[Path, tuple[float, float]],
    order: int = DEFAULT_ORDER,
    sizes: Sizes | None = None,
) -> FloatArray:
    """The basis V of `reduce_model`, (n, order), VᵀCV = 1; arguments as there."""
    full, sizes = tuple(models), sizes or Sizes()
    inputs, outputs = sizes.of_inputs(full[0].input_names), sizes.of_outputs(full[0].readings)
    points = list(operating_points(limits))
    rates = (1e-5, 1e-3, 3e-2, 1.0)  # [1/s]: a day to the skin of a seat
    columns = [moments(model.at(point), rates, inputs) for model, point in product(full, points)]
    wide = orthonormal(np.hstack(columns), full[0].capacity)
    small = [model.projected(wide) for model in full]
    strong = [_directions(model.at(point), inputs, outputs) for model, point in product(small, points)]
    return np.asarray(wide @ orthonormal(np.hstack(strong), np.ones(wide.shape[1]), order))


def operating_points(limits: Mapping[Path, tuple[float, float]]) -> Iterable[dict[Path, float]]:
    """Both ends and the middle of the range, and each path in turn at the other end [conductances]."""
    low = {path: ends[0] for path, ends in limits.items()}
    high = {path: ends[1] for path, ends in limits.items()}
    yield low
    yield high
    yield {path: (low[path] * high[path]) ** 0.5 for path in limits}
    for path in limits:
        if low[path] < high[path]:
            yield {**low, path: high[path]}
            yield {**high, path: low[path]}


def compressed_basis(system: HeatSystem, sizes: Sizes | None = None) -> FloatArray:
    """Basis on which a full system at one operating point keeps its answer to about 1 mK, (n, r)."""
    inputs = (sizes or Sizes()).of_inputs(system.input_names)
    return orthonormal(moments(system, scales=inputs), system.capacity)


def compressed(system: HeatSystem, sizes: Sizes | None = None) -> HeatSystem:
    """A full system at one operating point on the basis of its moments: one-sided, stable and passive."""
    basis = compressed_basis(system, sizes)
    small = basis.T @ (system.conductance @ basis)
    return replace(
        system,
        capacity=np.ones(basis.shape[1]),
        conductance=(small + small.T) / 2,
        gains=basis.T @ system.gains,
        rows=system.rows @ basis,
    )


def _directions(system: HeatSystem, inputs: FloatArray, outputs: FloatArray) -> FloatArray:
    """Balanced directions of both sides, each as long as its part in the answer, (n, k)."""
    found = balance(system, min(_GATHERED, system.order), inputs, outputs)
    weights = np.sqrt(found.strengths[: found.right.shape[1]])
    return np.hstack([found.right * weights, found.left * weights])


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
    """Balance a dense stable system, every C one, down to `order` states.

    The sizes are the working size of each input, (m,) [W, K], and what counts as one of each output, (p,) [K, m].
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
