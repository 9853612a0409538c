"""The heat balance of screw and nut with what varies in operation kept as parameters.

    C dθ/dt = -(K₀ + Σ gᵢ Kᵢ) θ + Σ gᵢ aᵢ θ_i + Σ b_j Q_j,    y = L θ

| symbol | meaning | unit |
|---|---|---|
| θ | rise of the nodes over the reference, the temperature at the start | K |
| C | heat capacities | J/K |
| K₀ | conduction in the steel, symmetric | W/K |
| gᵢ, Kᵢ | film coefficients and contact conductance; their areas as matrices, symmetric, not negative | W/(m² K), m² |
| aᵢ, θ_i | areas facing the air (or coolant) and its rise | m², K |
| b_j, Q_j | where friction and other heats enter; heats | 1, W |

Full and reduced models are of this one class: the reduction is a congruence, so symmetry and signs survive.
"""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from enum import StrEnum

import numpy as np
import scipy.sparse as sparse

from feeddrive.errors import InputError, ValidityWarning
from feeddrive.thermal.reduced.system import HeatSystem
from feeddrive.thermal.rig import Body, refuse_unless
from feeddrive.typing import Expression, FloatArray


class Path(StrEnum):
    """A way for heat whose conductance depends on the operation."""

    CONTACT = "contact"
    """Balls between shaft and nut, per area of the cylinder of the shaft's radius [W/(m² K)]."""
    SCREW_FILM = "screw_film"
    """Air on the bare shaft [W/(m² K)]."""
    NUT_FILM = "nut_film"
    """Air on the nut [W/(m² K)]."""
    FRONT_FILM = "front_film"
    """Air on the front seat [W/(m² K)]."""
    REAR_FILM = "rear_film"
    """Air on the rear seat [W/(m² K)]."""
    COOLING = "cooling"
    """From the nut's outer surface to a coolant [W/K]."""


AMBIENT, COOLANT = "ambient", "coolant"


@dataclass(frozen=True, eq=False)
class Way:
    """Matrix and source of one path.

    Attributes:
        matrix: Kᵢ, (n, n), sparse or dense.
        facing: aᵢ, (n,).
        source: input that it takes its temperature from; "" where the path lies inside.
    """

    matrix: Expression
    facing: FloatArray
    source: str


@dataclass(frozen=True, eq=False)
class HeatModel:
    """Heat balance of n states, affine in its conductances.

    Attributes:
        capacity: C, (n,) [J/K]; ones after a projection.
        conduction: K₀, (n, n).
        ways: path to its matrix.
        heats: input name to b_j, (n,).
        readings: output name to its row of L, (n,); temperatures [K], growths [m].
        profile: from states to the mean rise of each cross-section of the shaft, (axial, n).
        edges: of these sections, (axial + 1,) [m].
        ports: "nut", "front", "rear" to the vector by which a body is attached there, (n,).
        air: conductances to the air that do not depend on the operation, contained in `conduction`, (n,) [W/K].
        limits: path to the range of its conductance in which a reduced model holds; empty for a full one.
    """

    capacity: FloatArray
    conduction: Expression
    ways: Mapping[Path, Way]
    heats: Mapping[str, FloatArray]
    readings: Mapping[str, FloatArray]
    profile: Expression
    edges: FloatArray
    ports: Mapping[str, FloatArray]
    air: FloatArray
    limits: Mapping[Path, tuple[float, float]] = field(default_factory=dict)

    @property
    def order(self) -> int:
        """Number of states."""
        return len(self.capacity)

    @property
    def input_names(self) -> tuple[str, ...]:
        """Heats [W], then the temperatures that the paths face [K]."""
        return (*self.heats, AMBIENT, COOLANT)

    def at(self, conductances: Mapping[Path, float]) -> HeatSystem:
        """The linear system at given conductances.

        Args:
            conductances: path to g; those left out are zero.

        Raises:
            InputError: a negative or non-finite conductance.

        Warns:
            ValidityWarning: a conductance outside the range of a reduced model.
        """
        refuse_negative_conductances(conductances)
        self.warn_of_extrapolation(conductances)
        matrix = self.conduction.copy()
        facing = {AMBIENT: self.air, COOLANT: np.zeros(self.order)}
        for path, g in conductances.items():
            way = self.ways[path]
            if g != 0:
                matrix = matrix + g * way.matrix
                if way.source:
                    facing[way.source] = facing[way.source] + g * way.facing
        columns = [*self.heats.values(), facing[AMBIENT], facing[COOLANT]]
        return HeatSystem(
            self.capacity,
            matrix,
            np.column_stack(columns),
            np.vstack(list(self.readings.values())),
            self.input_names,
            tuple(self.readings),
        )

    def warn_of_extrapolation(self, conductances: Mapping[Path, float]) -> None:
        """Warn of conductances outside the range that a reduced model was made for; `limits` gives it."""
        for path, g in conductances.items():
            low, high = self.limits.get(path, (0.0, np.inf))
            if not low * (1 - 1e-9) <= g <= high * (1 + 1e-9):
                what = f"{path} of {g:.4g} lies outside {low:.4g} to {high:.4g}, for which the reduced model was made"
                warnings.warn(f"{what}: extrapolated, reduce it for a wider range", ValidityWarning, stacklevel=3)

    def projected(self, basis: FloatArray) -> HeatModel:
        """The model on the columns of `basis`, (n, r) with basisᵀ C basis = 1: stable and passive as this one is."""

        def folded(matrix: Expression) -> FloatArray:
            small = basis.T @ (matrix @ basis)
            return np.asarray((small + small.T) / 2)

        def shortened(vectors: Mapping[str, FloatArray]) -> dict[str, FloatArray]:
            return {name: vector @ basis for name, vector in vectors.items()}

        return HeatModel(
            capacity=np.ones(basis.shape[1]),
            conduction=folded(self.conduction),
            ways={path: Way(folded(way.matrix), way.facing @ basis, way.source) for path, way in self.ways.items()},
            heats=shortened(self.heats),
            readings=shortened(self.readings),
            profile=np.asarray(self.profile @ basis),
            edges=self.edges,
            ports=shortened(self.ports),
            air=self.air @ basis,
        )

    def with_body(self, body: Body) -> HeatModel:
        """The model with a body attached; full or reduced, its own heat is the input of its name.

        Raises:
            InputError: a name in use.
        """
        name = body.name
        free = name not in self.readings and name not in self.input_names
        refuse_unless(free, f'"{name}" is in use', "body", "give the body another name")
        link = np.append(self.ports[body.port], -1.0)
        own = np.zeros(self.order + 1)
        own[-1] = 1.0
        conduction = _grown(self.conduction) + body.conductance * _outer(link, self.conduction)
        return replace(
            self,
            capacity=np.append(self.capacity, body.capacity),
            conduction=conduction + body.to_air * _outer(own, self.conduction),
            ways={p: Way(_grown(w.matrix), np.append(w.facing, 0.0), w.source) for p, w in self.ways.items()},
            heats={**_lengthened(self.heats), name: own},
            readings={**_lengthened(self.readings), name: own},
            profile=_widened(self.profile),
            ports=_lengthened(self.ports),
            air=np.append(self.air, body.to_air),
        )


def refuse_negative_conductances(conductances: Mapping[Path, float]) -> None:
    """Refuse film coefficients and contact conductances that are negative or not finite.

    Raises:
        InputError: names the path.
    """
    for path, g in conductances.items():
        if not (np.isfinite(g) and g >= 0):
            raise InputError(f"a conductance of {g:g} is not possible", str(path), "write zero or a value above it")


def _lengthened(vectors: Mapping[str, FloatArray]) -> dict[str, FloatArray]:
    return {name: np.append(vector, 0.0) for name, vector in vectors.items()}


def _grown(matrix: Expression) -> Expression:
    """A matrix with a row and a column of zeros more."""
    if sparse.issparse(matrix):
        return sparse.block_diag([matrix, sparse.csr_array((1, 1))]).tocsr()
    return np.pad(matrix, ((0, 1), (0, 1)))


def _widened(matrix: Expression) -> Expression:
    if sparse.issparse(matrix):
        return sparse.hstack([matrix, sparse.csr_array((matrix.shape[0], 1))]).tocsr()
    return np.pad(matrix, ((0, 0), (0, 1)))


def _outer(vector: FloatArray, like: Expression) -> Expression:
    """vector·vectorᵀ, sparse or dense as `like`."""
    if sparse.issparse(like):
        column = sparse.csr_array(vector[:, None])
        return (column @ column.T).tocsr()
    return np.outer(vector, vector)
