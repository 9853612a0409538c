"""The constants of a step: how state, input and node forces reach the states at the Radau nodes, and what errors weigh.

The error of a step is told as a table position. An error e in position and e' in velocity count

    sqrt(e M e / m) + sqrt(e' M e' / m) / omega,      m = 1 / (L M^-1 L')

| symbol | meaning | unit |
|---|---|---|
| M, L | mass matrix, row with x = L q | |
| m | mass felt at the table | kg |
| omega | rate at which a velocity is forgotten: lowest frequency where the motor is driven, else 100 1/s | 1/s |
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import casadi as ca
import numpy as np

from feeddrive.errors import InputError
from feeddrive.plant.chain import Chain
from feeddrive.plant.plant import Plant
from feeddrive.simulate.propagators import HERMITE_BASIS, NODE_BASIS, basis_propagators, monomial_propagators
from feeddrive.typing import Expression, FloatArray

FORGETTING = 100.0
"""Rate at which a controlled axis forgets an error in velocity [1/s]: the position loop of a machine tool."""

FULL_SCALE = 10.0
"""Acceleration of the full scale of effect forces [m/s^2]."""

CONVERGED = 1e-9
"""Newton ends where its last correction is below this share of the force, or of full scale."""

BRISTLE_SCALE = 1e-8
"""Deflection that counts as full scale where bristles alone are solved [m]."""

_CURVATURE = np.array([1.0, -4.0, 3.0])
"""Monomial coefficients of the parabola that is 1 at the start and 0 at both nodes."""

_CUBIC_SHARE = 1 / 36
"""Impulse that the two nodes miss of a force whose curvature at the start changes by 1 from step to step."""


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
    """

    driven: bool
    lagging: bool
    coordinates: int
    states: int
    forced: tuple[int, ...]
    bristles: int
    inputs: int

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


def propagator_shapes(layout: Layout) -> list[tuple[int, int]]:
    """Shapes of the blocks: per node E, response to the input, to the first and to the second node force."""
    n, m = layout.states, len(layout.forced)
    return [(n, n), (n, layout.inputs), (n, m), (n, m)] * 2


def constant_shapes(layout: Layout) -> list[tuple[int, int]]:
    """Shapes of all blocks of `step_constants`: propagators; step, its share, reference; full scales; two weights."""
    watched = layout.watched
    return [
        *propagator_shapes(layout),
        (3, 1),
        (max(len(layout.forced), layout.bristles), 1),
        (watched, 1),
        (watched, 1),
    ]


def unflatten(flat: Expression, shapes: list[tuple[int, int]]) -> list[Expression]:
    """The blocks of a flat column, each column-major."""
    blocks, at = [], 0
    for rows, columns in shapes:
        blocks.append(ca.reshape(flat[at : at + rows * columns], rows, columns))
        at += rows * columns
    return blocks


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
    """The linear part for the plant's present values.

    Args:
        plant: with its values.
        layout: of the step.
        torque_lag: time constant of the torque loop [s], where the layout has one.
        reference: table position at which a chain that varies is taken [m].

    Raises:
        SimulationError: a mass matrix with which nothing can move.
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


def step_constants(linear: Linear, layout: Layout, step: float, share: float, tolerance: float) -> FloatArray:
    """The blocks of `constant_shapes`, column-major.

    Args:
        linear: part of the plant.
        layout: of the step.
        step: h [s].
        share: of the step in the span over which the input is given.
        tolerance: error of the table position that a step may make [m].
    """
    blocks, curved = propagator_blocks((linear.a, linear.on_force, linear.on_input), layout, step)
    blocks.append(np.array([step, share, linear.reference]))
    blocks += _weights(linear, layout, step, curved, tolerance)
    return flattened(blocks)


def flattened(blocks: list[FloatArray]) -> FloatArray:
    """Blocks one after the other, column-major."""
    return np.concatenate([block.ravel(order="F") for block in blocks])


def propagator_blocks(
    first_order: tuple[FloatArray, FloatArray, FloatArray], layout: Layout, step: float
) -> tuple[list[FloatArray], FloatArray]:
    """The blocks of `propagator_shapes` from A, G and B, and what a parabola of each force does, shape (n, m)."""
    blocks: list[FloatArray] = []
    a, on_force, on_input = first_order
    curved = np.zeros((layout.states, len(layout.forced)))
    count, degree = len(layout.forced), 3 if layout.driven else 2
    for exponential, monomials in monomial_propagators(a, np.hstack([on_force, on_input]), step, degree):
        by_force, by_input = monomials[:3, :, :count], monomials[:, :, count:]
        on_nodes = basis_propagators(by_force[:2], NODE_BASIS)
        from_input = _of_cubic(by_input, step) if layout.driven else by_input[0]
        blocks += [exponential, from_input, on_nodes[0], on_nodes[1]]
        curved = basis_propagators(by_force, _CURVATURE[None, :])[0]
    return blocks, curved


def _weights(
    linear: Linear, layout: Layout, step: float, curved: FloatArray, tolerance: float
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Full scales of what Newton solves, and what curvature and its change weigh in tolerances."""
    n, count = layout.coordinates, len(layout.forced)
    if count == 0:
        # no force moves anything: the deflection itself is judged, by the impulse of its rate
        on_bristle = np.full(layout.bristles, step / 12 / (1e-2 * BRISTLE_SCALE))
        if not np.isfinite(tolerance):
            on_bristle[:] = 0.0
        return np.full(layout.bristles, CONVERGED * BRISTLE_SCALE), on_bristle, on_bristle
    own = np.array([1 / linear.inverse[i, i] for i in (k - int(layout.driven) for k in layout.forced)])
    scales = CONVERGED * FULL_SCALE * np.sqrt(own * linear.felt_mass)
    scales = np.concatenate([scales, np.zeros(max(0, layout.bristles - count))])
    moved, moving = (_energy_norm(linear, curved[rows]) for rows in (slice(0, n), slice(n, 2 * n)))
    by_curvature = moved + moving / linear.forgetting
    by_change = _CUBIC_SHARE * step / np.sqrt(own * linear.felt_mass) / linear.forgetting
    return scales, by_curvature / tolerance, by_change / tolerance


def _energy_norm(linear: Linear, columns: FloatArray) -> FloatArray:
    norm: FloatArray = np.sqrt(np.einsum("ik,ij,jk->k", columns, linear.mass, columns) / linear.felt_mass)
    return norm


def _of_cubic(monomials: FloatArray, step: float) -> FloatArray:
    """Response to (value, rate) at both ends of the motor's cubic, shape (n, 4)."""
    # value, rate and acceleration are polynomials in the same four end values
    basis = [HERMITE_BASIS, _derivative(HERMITE_BASIS) / step, _derivative(_derivative(HERMITE_BASIS)) / step**2]
    parts = [basis_propagators(monomials[:, :, k : k + 1], basis[k])[:, :, 0] for k in range(3)]
    response: FloatArray = np.sum(parts, axis=0).T * np.array([1.0, step, 1.0, step])
    return response


def _derivative(basis: FloatArray) -> FloatArray:
    """Monomial coefficients of the derivatives; same shape."""
    slopes = np.zeros_like(basis)
    slopes[:, :3] = basis[:, 1:] * np.arange(1, 4)
    return slopes
