"""The reduced model: a few states, the full model's class, its conductances still parameters.

1. Moments of the full model at several rates and at operating points spread over the range (`krylov`): a wide basis.
2. On that basis, dense, each point is balanced; its strongest directions are gathered, weighted, and an SVD gives the
   basis V of the order that was asked for.
3. Congruence: C_r = VᵀCV = 1, K_r(g) = VᵀK₀V + Σ gᵢ VᵀKᵢV. As every g ≥ 0 keeps K_r symmetric and not negative, the
   model is stable and passive at every operating point, also while conductances change within a run.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from feeddrive.thermal.reduced.balancing import balance
from feeddrive.thermal.reduced.krylov import moments, orthonormal
from feeddrive.thermal.reduced.parametric_model import AMBIENT, COOLANT, HeatModel, Path
from feeddrive.thermal.reduced.system import HeatSystem
from feeddrive.typing import FloatArray

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
