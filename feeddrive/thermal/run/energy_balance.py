"""The energy balance of a thermal run: heat in = heat to the surroundings + heat stored.

A last state J with dJ/dt = 1ᵀ(Kθ - a θ_i) counts what goes to air and coolant. It is stepped with the temperatures, by
the same scheme, so that the balance closes to rounding wherever the sums over the nodes are right, and not by
definition: the heat that is stored is summed over the capacities.

| symbol | meaning | unit |
|---|---|---|
| J | heat given to the surroundings since the start | J |
| K, a, θ, θ_i | as in `feeddrive.thermal.reduced.parametric_model` | |
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
import scipy.sparse as sparse

from feeddrive.thermal.reduced.parametric_model import AMBIENT, COOLANT, HeatModel, Way
from feeddrive.typing import Expression, FloatArray

CLOSES = 1e-9
"""Share of the heat in to which the balance closes: rounding of some thousand steps."""


@dataclass(frozen=True)
class EnergyBalance:
    """Energies of a run [J].

    Attributes:
        heats: input name to the heat that came in by it.
        to_surroundings: through films and coolant.
        stored: in steel and bodies.
    """

    heats: Mapping[str, float]
    to_surroundings: float
    stored: float

    @property
    def heat_in(self) -> float:
        """Sum of the heats [J]."""
        return float(sum(self.heats.values()))

    @property
    def imbalance(self) -> float:
        """|in - out - stored| over the largest of the three [1]."""
        largest = max(abs(self.heat_in), abs(self.to_surroundings), abs(self.stored), 1e-300)
        return abs(self.heat_in - self.to_surroundings - self.stored) / largest


def with_ledger(model: HeatModel) -> HeatModel:
    """A full model with J as its last state."""
    return replace(
        model,
        capacity=np.append(model.capacity, 1.0),
        conduction=_counting(model.conduction),
        ways={
            path: Way(_counting(way.matrix), np.append(way.facing, -way.facing.sum()), way.source)
            for path, way in model.ways.items()
        },
        heats=_lengthened(model.heats),
        readings=_lengthened(model.readings),
        profile=sparse.hstack([model.profile, sparse.csr_array((model.profile.shape[0], 1))]).tocsr(),
        ports=_lengthened(model.ports),
        air=np.append(model.air, -model.air.sum()),
    )


def balance_of(model: HeatModel, state: FloatArray, step: float, inputs: Mapping[str, FloatArray]) -> EnergyBalance:
    """The balance after a run of rows of `step` [s] from zero to `state`, (n,), of a model made by `with_ledger`.

    Inputs are name to heats over the rows (k,) [W]; temperatures of the surroundings are passed over.
    """
    heats = {name: step * float(np.sum(values)) for name, values in inputs.items() if name not in (AMBIENT, COOLANT)}
    return EnergyBalance(heats, float(state[-1]), float(model.capacity[:-1] @ state[:-1]))


def _counting(matrix: Expression) -> Expression:
    """A matrix with the row that counts what its columns lose."""
    lost = sparse.csr_array(-np.asarray(matrix.sum(axis=0)).reshape(1, -1))
    return sparse.block_array([[matrix, None], [lost, sparse.csr_array((1, 1))]]).tocsr()


def _lengthened(vectors: Mapping[str, FloatArray]) -> dict[str, FloatArray]:
    return {name: np.append(vector, 0.0) for name, vector in vectors.items()}
