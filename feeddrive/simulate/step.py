"""One step of a plant as a CasADi function: exact linear chain, effect forces on Radau nodes.

At the two Radau nodes the coordinates follow exactly from the state at the start, the input and the node forces; the
node forces follow from the coordinates through the effects. The small system for node forces and bristle deflections
is solved by Newton with the exact Jacobian.

    s_i = E_i s_0 + I_i w + sum_j W_ij f_j,     f_i = f(q_i, q_i', z_i, t_i),     z_i = z_0 + h sum_j a_ij z_j'

The last Newton correction is handed out, so that no trajectory is wrong in silence.
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca
import numpy as np

from feeddrive.plant.equations import (
    Symbols,
    bristle_count,
    chain_symbols,
    effect_forces,
    parameter_symbols,
    parameter_values,
)
from feeddrive.plant.plant import Plant
from feeddrive.simulate.propagators import HERMITE_BASIS, NODES, RADAU
from feeddrive.simulate.step_constants import Layout, propagator_shapes, step_propagators, unflatten
from feeddrive.typing import Expression, FloatArray

NEWTON_ITERATIONS = 3
"""Corrections per step; quadratic from the last step's forces, the third is the check."""


@dataclass(frozen=True)
class StepModel:
    """A step function and the constants that it needs for given values.

    `function` maps (memory, inputs, time, constants) to (memory after, last Newton correction).
    """

    plant: Plant
    layout: Layout
    function: ca.Function

    def constants(self, plant: Plant, step: float) -> FloatArray:
        """Propagators for the plant's values and the step [s], then step and parameters; shape (k,)."""
        return np.concatenate([step_propagators(plant, self.layout, step), [step], parameter_values(plant)])


def driven_step(plant: Plant) -> StepModel:
    """The step of the load side with the motor angle prescribed as a cubic per step.

    Inputs per step: theta and theta' at its start, theta and theta' at its end [rad, rad/s].
    """
    return _build(plant, driven=True)


def torque_step(plant: Plant) -> StepModel:
    """The step of the whole plant with motor torque [N m] and cutting force [N] held over the step."""
    return _build(plant, driven=False)


def _build(plant: Plant, driven: bool) -> StepModel:
    symbols = parameter_symbols(plant)
    layout = _layout(plant, symbols, driven)
    memory = ca.SX.sym("memory", layout.memory)
    inputs = ca.SX.sym("inputs", layout.inputs)
    time = ca.SX.sym("time")
    shapes = propagator_shapes(layout)
    flat = ca.SX.sym("propagators", sum(rows * columns for rows, columns in shapes))
    step = ca.SX.sym("step")
    blocks = unflatten(flat, shapes)
    after, correction = _newton(plant, symbols, layout, memory, inputs, time, step, blocks)
    constants = ca.vertcat(flat, step, symbols.vector)
    function = ca.Function(
        "step", [memory, inputs, time, constants], [after, correction], ["memory", "inputs", "time", "constants"],
        ["after", "correction"],
    )  # fmt: skip
    return StepModel(plant, layout, function)


def _layout(plant: Plant, symbols: Symbols, driven: bool) -> Layout:
    n = len(plant.chain.coordinates)
    q, rate = ca.SX.sym("q", n), ca.SX.sym("rate", n)
    z, time = ca.SX.sym("z", bristle_count(plant)), ca.SX.sym("time")
    forces = effect_forces(plant, symbols, q, rate, z, time).on_coordinates
    first = 1 if driven else 0
    forced = tuple(i for i in range(first, n) if not forces[i].is_zero())
    free = n - first
    return Layout(driven, free, 2 * free, forced, bristle_count(plant), 4 if driven else 2)


def _newton(
    plant: Plant, symbols: Symbols, layout: Layout, memory: Expression, inputs: Expression, time: Expression,
    step: Expression, blocks: list[Expression],
) -> tuple[Expression, Expression]:  # fmt: skip
    """Memory after the step and the size of the last correction of the node forces."""
    m, nz = len(layout.forced), layout.bristles
    start = _part(memory, 0, layout.states)
    z0 = _part(memory, layout.states, nz)
    last = _part(memory, layout.states + nz, m)
    unknown = ca.SX.sym("unknown", 2 * (m + nz))
    states = _node_states(layout, start, inputs, _part(unknown, 0, 2 * m), blocks)
    forces, rates = [], []
    for i, node in enumerate(NODES):
        q, rate = _coordinates(plant, symbols, layout, states[i], inputs, node, step)
        z = _part(unknown, 2 * m + i * nz, nz)
        found = effect_forces(plant, symbols, q, rate, z, time + node * step)
        forces.append(ca.reshape(found.on_coordinates[list(layout.forced)], m, 1))
        rates.append(found.bristle_rates)
    residual = [_part(unknown, i * m, m) - forces[i] for i in range(2)]
    for i in range(2):
        z = _part(unknown, 2 * m + i * nz, nz)
        residual.append(z - z0 - step * (RADAU[i, 0] * rates[0] + RADAU[i, 1] * rates[1]))
    guess = ca.vertcat(last, last, z0, z0)
    correct = _newton_correction(ca.vertcat(*residual), unknown)
    change: Expression = ca.SX.zeros(unknown.numel(), 1)
    for _ in range(NEWTON_ITERATIONS):
        (change,) = ca.substitute([correct], [unknown], [guess])
        guess = guess - change
    (end,) = ca.substitute([states[1]], [unknown], [guess])
    after = ca.vertcat(end, _part(guess, 2 * m + nz, nz), _part(guess, m, m))
    largest = ca.mmax(ca.fabs(change[: 2 * m])) if m else ca.SX(0)
    return after, largest


def _part(column: Expression, start: int, count: int) -> Expression:
    """Rows of a column; a column of no rows where count is 0, which slicing would turn into a row."""
    return ca.reshape(column[start : start + count], count, 1)


def _newton_correction(residual: Expression, unknown: Expression) -> Expression:
    """J^-1 r by elimination without pivoting: the diagonal of J is 1 plus dissipation."""
    n = unknown.numel()
    if n == 0:
        return ca.SX.zeros(0, 1)
    rows = ca.SX(ca.horzcat(ca.jacobian(residual, unknown), residual))
    for column in range(n):
        for row in range(column + 1, n):
            if not rows[row, column].is_zero():
                rows[row, :] -= rows[row, column] / rows[column, column] * rows[column, :]
    solution = ca.SX.zeros(n, 1)
    for row in reversed(range(n)):
        known = sum((rows[row, k] * solution[k] for k in range(row + 1, n)), start=ca.SX(0))
        solution[row] = (rows[row, n] - known) / rows[row, row]
    return solution


def _node_states(
    layout: Layout, start: Expression, inputs: Expression, forces: Expression, blocks: list[Expression]
) -> list[Expression]:
    m = len(layout.forced)
    states = []
    for i in range(2):
        exponential, from_input, from_first, from_second = blocks[4 * i : 4 * i + 4]
        state = ca.mtimes(exponential, start) + ca.mtimes(from_input, inputs)
        state += ca.mtimes(from_first, _part(forces, 0, m)) + ca.mtimes(from_second, _part(forces, m, m))
        states.append(state)
    return states


def _coordinates(
    plant: Plant, symbols: Symbols, layout: Layout, state: Expression, inputs: Expression, node: float, step: Expression
) -> tuple[Expression, Expression]:
    """q and q' of the whole chain at a node."""
    half = layout.coordinates
    if not layout.driven:
        return state[:half], state[half:]
    powers = node ** np.arange(4)
    slopes = np.concatenate([[0.0], np.arange(1, 4) * node ** np.arange(3)])
    scaled = ca.vertcat(inputs[0], step * inputs[1], inputs[2], step * inputs[3])
    theta = ca.mtimes(ca.DM(HERMITE_BASIS @ powers).T, scaled)
    theta_rate = ca.mtimes(ca.DM(HERMITE_BASIS @ slopes).T, scaled) / step
    if not plant.chain.elastic:
        ratio = plant.chain.motor(chain_symbols(plant, symbols))[0]
        return theta / ratio, theta_rate / ratio
    return ca.vertcat(theta, state[:half]), ca.vertcat(theta_rate, state[half:])


__all__ = ["Layout", "StepModel", "driven_step", "torque_step"]
