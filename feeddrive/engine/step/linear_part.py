"""The linear part of a step in first order, s' = A s + G f + B w, from the plant's present values.

| symbol | meaning |
|---|---|
| s | free coordinates and their rates, then the motor torque where it lags |
| f | forces on the coordinates that effects act on |
| w | motor torque and cutting force, or angle, speed and acceleration of a driven motor |

Sizes of a step, and the error of a run that could not go on.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from feeddrive.errors import InputError
from feeddrive.plant.chain.chain import Chain
from feeddrive.plant.plant import Plant
from feeddrive.typing import Expression, FloatArray


class SimulationError(InputError):
    """A run that cannot be begun or could not go on; nothing of it is handed out."""


@dataclass(frozen=True)
class Layout:
    """Sizes of a step.

    Attributes:
        driven: whether the motor angle is prescribed; else the motor torque.
        lagging: whether the motor torque follows its command with a time constant.
        coordinates: free ones.
        states: of the linear part.
        forced: coordinates with effect forces that are not identically zero.
        bristles: deflections.
        inputs: held over a step, or the ends of a cubic.
        sharp: whether a force bends within nanometres: bristles, and the flanks of a free play.
    """

    driven: bool
    lagging: bool
    coordinates: int
    states: int
    forced: tuple[int, ...]
    bristles: int
    inputs: int
    sharp: bool

    @property
    def watched(self) -> int:
        """Quantities whose curvature tells the error: forces; rates of bristles where no force moves anything."""
        return len(self.forced) or self.bristles

    @property
    def memory(self) -> int:
        """Length of what is carried from step to step: states, bristles; value, curvature and slope of the watched."""
        return self.states + self.bristles + 3 * self.watched

    @property
    def unknowns(self) -> int:
        """Node forces and bristle deflections."""
        return 2 * (len(self.forced) + self.bristles)


FORGETTING = 100.0
"""Rate at which a controlled axis forgets an error in velocity [1/s]: the position loop of a machine tool."""


@dataclass(frozen=True)
class Linear:
    """The linear part in first order, s' = A s + G f + B w; free coordinates only.

    Attributes:
        mass, inverse: M and its inverse, shape (n, n).
        a, on_force, on_input: A, G of the forced coordinates, B; of theta, theta', theta'' where the motor is driven.
        reference: table position at which M, C and K are taken [m].
        felt_mass: m of the module [kg].
        forgetting: omega of the module [1/s].
    """

    mass: FloatArray
    inverse: FloatArray
    a: FloatArray
    on_force: FloatArray
    on_input: FloatArray
    felt_mass: float
    forgetting: float
    reference: float


def linear_part(plant: Plant, layout: Layout, torque_lag: float = 0.0, reference: float = 0.0) -> Linear:
    """The linear part for the plant's present values; a chain that varies is taken at the table position `reference`.

    `torque_lag` is the time constant of the torque loop [s], where the layout has one. Raises SimulationError for a
    mass matrix with which nothing can move.
    """
    p, n, first = plant.chain_values(), layout.coordinates, int(layout.driven)
    free = slice(first, None)
    mass = np.array(plant.chain.mass(p, reference), dtype=float)[free, free]
    if not (np.isfinite(mass).all() and (n == 0 or np.linalg.eigvalsh(mass)[0] > 0)):
        raise SimulationError("masses or inertias are not positive", plant.name, "check them and what adds to them")
    inverse = np.linalg.inv(mass) if n else np.zeros((0, 0))
    first_order = state_matrices(plant.chain, p, layout, torque_lag, reference)
    table = np.array(plant.chain.table(p), dtype=float)[free]
    felt = 1 / float(table @ inverse @ table) if n else 1.0
    forgetting = _lowest_frequency(-first_order[0][n : 2 * n, :n]) if layout.driven and n else FORGETTING
    return Linear(mass, inverse, *first_order, felt, forgetting, reference)


def state_matrices(
    chain: Chain, p: Mapping[str, Expression], layout: Layout, torque_lag: complex, reference: float
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """A, G and B of `Linear` for chain values that may be complex."""
    whole = [chain.mass(p, reference), chain.damping(p, reference), chain.stiffness(p, reference)]
    kind = np.result_type(*[np.asarray(value).dtype for value in p.values()], type(torque_lag))
    mass, damping, stiffness = (np.array(matrix, dtype=kind) for matrix in whole)
    n, first = layout.coordinates, int(layout.driven)
    free = slice(first, None)
    inverse = np.linalg.inv(mass[free, free]) if n else np.zeros((0, 0))
    a = np.block([[np.zeros((n, n)), np.eye(n)], [-inverse @ stiffness[free, free], -inverse @ damping[free, free]]])
    on_force = np.vstack([np.zeros((n, len(layout.forced))), inverse[:, [i - first for i in layout.forced]]])
    if layout.driven:
        columns = -np.column_stack([matrix[free, 0] for matrix in (stiffness, damping, mass)])
    else:
        columns = np.column_stack([chain.motor(p), chain.table(p)])  # virtual work: force = L' torque
    on_input = np.vstack([np.zeros((n, columns.shape[1])), inverse @ columns.astype(kind)])
    return _with_lag(a, on_force, on_input, torque_lag) if layout.lagging else (a, on_force, on_input)


def _lowest_frequency(dynamic: FloatArray) -> float:
    """Lowest own frequency [rad/s] of M^-1 K, but not below what is forgotten anyway."""
    squared = float(np.min(np.linalg.eigvals(dynamic).real))
    return max(float(np.sqrt(max(squared, 0.0))), FORGETTING)


def _with_lag(
    a: FloatArray, on_force: FloatArray, on_input: FloatArray, lag: complex
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """The torque as a further state, T' = (u - T) / lag."""
    n = len(a)
    kind = np.result_type(a, on_input, type(lag))
    larger = np.zeros((n + 1, n + 1), dtype=kind)
    larger[:n, :n], larger[:n, n], larger[n, n] = a, on_input[:, 0], -1 / lag
    fed = np.zeros((n + 1, 2), dtype=kind)
    fed[:n, 1], fed[n, 0] = on_input[:, 1], 1 / lag
    return larger, np.vstack([on_force, np.zeros((1, on_force.shape[1]))]), fed
