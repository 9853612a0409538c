"""The constants of a step: how state, input and node forces reach the states at the Radau nodes, and what errors weigh.

The error of a step is stated as a table position. An error e in position and e' in velocity count

    sqrt(e M e / m) + sqrt(e' M e' / m) / omega,      m = 1 / (L M^-1 L')

| symbol | meaning | unit |
|---|---|---|
| M, L | mass matrix, row with x = L q | |
| m | mass felt at the table | kg |
| omega | rate at which a velocity is forgotten: lowest frequency where the motor is driven, else 100 1/s | 1/s |
"""

from __future__ import annotations

import casadi as ca
import numpy as np

from feeddrive.engine.step.linear_part import Layout, Linear
from feeddrive.engine.step.propagators import HERMITE_BASIS, NODE_BASIS, basis_propagators, monomial_propagators
from feeddrive.typing import Expression, FloatArray

FULL_SCALE = 10.0
"""Acceleration of the full scale of effect forces [m/s^2]."""

CONVERGED = 1e-5
"""Newton ends where its last correction is below this share of the force, or of full scale: each is as the square of
the one before, in shares of what bends the force. 1e-4 m/s^2 over half a millisecond are 50 nm/s, a ten-thousandth of
the 0.5 mm/s within which friction turns round. A further one would only say so, and takes a third of a run."""

CONVERGED_WHERE_SHARP = 1e-9
"""The same where forces bend within nanometres, which the last hundred-thousandth of a force crosses: a stiff bristle
that breaks away within 10 nm, the flank of a free play that takes up its damper within 1 nm."""

BRISTLE_SCALE = 1e-8
"""Deflection that counts as full scale where bristles alone are solved [m]."""

_CURVATURE = np.array([1.0, -4.0, 3.0])
"""Monomial coefficients of the parabola that is 1 at the start and 0 at both nodes."""

_CUBIC_SHARE = 1 / 36
"""Impulse that the two nodes miss of a force whose curvature at the start changes by 1 from step to step."""


def converged(layout: Layout) -> float:
    """Share of the force, or of full scale, below which Newton's last correction ends it."""
    return CONVERGED_WHERE_SHARP if layout.sharp else CONVERGED


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


def step_constants(linear: Linear, layout: Layout, step: float, share: float, tolerance: float) -> FloatArray:
    """The blocks of `constant_shapes`, column-major, for a step h [s] with an error of `tolerance` [m] at the table.

    `share` is that of the step in the span over which the input is given.
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
        return np.full(layout.bristles, converged(layout) * BRISTLE_SCALE), on_bristle, on_bristle
    own = np.array([1 / linear.inverse[i, i] for i in (k - int(layout.driven) for k in layout.forced)])
    scales = converged(layout) * FULL_SCALE * np.sqrt(own * linear.felt_mass)
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
    parts = [basis_propagators(monomials[:, :, k : k + 1], _MOTION[k] / step**k)[:, :, 0] for k in range(3)]
    response: FloatArray = np.sum(parts, axis=0).T * np.array([1.0, step, 1.0, step])
    return response


def _derivative(basis: FloatArray) -> FloatArray:
    """Monomial coefficients of the derivatives; same shape."""
    slopes = np.zeros_like(basis)
    slopes[:, :3] = basis[:, 1:] * np.arange(1, 4)
    return slopes


_MOTION = (HERMITE_BASIS, _derivative(HERMITE_BASIS), _derivative(_derivative(HERMITE_BASIS)))
"""Monomial coefficients of the motor's cubic, of its rate and of its acceleration, per step."""
