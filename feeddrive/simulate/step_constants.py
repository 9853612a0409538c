"""The constants of a step: how state, input and node forces reach the states at the Radau nodes."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca
import numpy as np

from feeddrive.plant.plant import Plant
from feeddrive.simulate.propagators import HERMITE_BASIS, NODE_BASIS, NODES, basis_propagators, monomial_propagators
from feeddrive.typing import Expression, FloatArray


@dataclass(frozen=True)
class Layout:
    """Sizes of a step: free coordinates, states, effect forces that are not identically zero, bristles, inputs."""

    driven: bool
    coordinates: int
    states: int
    forced: tuple[int, ...]
    bristles: int
    inputs: int

    @property
    def memory(self) -> int:
        """Length of what is carried from step to step: states, bristles, last node forces."""
        return self.states + self.bristles + len(self.forced)


def propagator_shapes(layout: Layout) -> list[tuple[int, int]]:
    """Shapes of the blocks: per node E, response to the input, to the first and to the second node force."""
    n, m = layout.states, len(layout.forced)
    return [(n, n), (n, layout.inputs), (n, m), (n, m)] * 2


def unflatten(flat: Expression, shapes: list[tuple[int, int]]) -> list[Expression]:
    """The blocks of a flat column, each column-major."""
    blocks, at = [], 0
    for rows, columns in shapes:
        blocks.append(ca.reshape(flat[at : at + rows * columns], rows, columns))
        at += rows * columns
    return blocks


def step_propagators(plant: Plant, layout: Layout, step: float) -> FloatArray:
    """The blocks of `propagator_shapes`, column-major, for the plant's present values."""
    p = plant.chain_values()
    mass, damping, stiffness = (
        np.array(matrix(p), dtype=float) for matrix in (plant.chain.mass, plant.chain.damping, plant.chain.stiffness)
    )
    first = 1 if layout.driven else 0
    free = slice(first, None)
    inverse = np.linalg.inv(mass[free, free]) if layout.coordinates else np.zeros((0, 0))
    a = _state_matrix(inverse, damping[free, free], stiffness[free, free])
    force = _force_matrix(inverse, [i - first for i in layout.forced])
    blocks: list[FloatArray] = []
    for node in NODES:
        exponential, on_force = monomial_propagators(a, force, step, 1, node)
        on_nodes = basis_propagators(on_force, NODE_BASIS)
        from_input = _input_propagator(plant, layout, a, inverse, damping, stiffness, step, node)
        blocks += [exponential, from_input, on_nodes[0], on_nodes[1]]
    return np.concatenate([block.ravel(order="F") for block in blocks])


def _input_propagator(
    plant: Plant, layout: Layout, a: FloatArray, inverse: FloatArray, damping: FloatArray, stiffness: FloatArray,
    step: float, node: float,
) -> FloatArray:  # fmt: skip
    n = layout.coordinates
    if not layout.driven:
        p = plant.chain_values()
        columns = np.column_stack([plant.chain.motor(p), plant.chain.table(p)])  # virtual work: force = L' torque
        held = np.vstack([np.zeros((n, 2)), inverse @ columns])
        on_held: FloatArray = monomial_propagators(a, held, step, 0, node)[1][0]
        return on_held
    zeros = np.zeros((n, 1))
    by_angle = np.vstack([zeros, -inverse @ stiffness[1:, :1]])
    by_speed = np.vstack([zeros, -inverse @ damping[1:, :1]])
    slopes = np.zeros_like(HERMITE_BASIS)
    slopes[:, :3] = HERMITE_BASIS[:, 1:] * np.arange(1, 4) / step
    angle = basis_propagators(monomial_propagators(a, by_angle, step, 3, node)[1], HERMITE_BASIS)
    speed = basis_propagators(monomial_propagators(a, by_speed, step, 3, node)[1], slopes)
    response: FloatArray = (angle + speed)[:, :, 0].T * np.array([1.0, step, 1.0, step])
    return response


def _state_matrix(inverse: FloatArray, damping: FloatArray, stiffness: FloatArray) -> FloatArray:
    n = len(inverse)
    matrix: FloatArray = np.block([[np.zeros((n, n)), np.eye(n)], [-inverse @ stiffness, -inverse @ damping]])
    return matrix


def _force_matrix(inverse: FloatArray, forced: list[int]) -> FloatArray:
    n = len(inverse)
    matrix: FloatArray = np.vstack([np.zeros((n, len(forced))), inverse[:, forced]])
    return matrix
