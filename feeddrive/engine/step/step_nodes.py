"""The equations at the two Radau nodes, and Newton's method for them.

    f_i = f(u_i, z_i, t_i),     sum_j b_ij (z_j - z_0) = h z'(u_i, z_i, t_i),     u_i = base_i + sum_j P_ij f_j

Effects are differentiated once per node, with respect to what they read; how that follows from the node forces is
linear. So the Jacobian costs one derivative for each quantity read, however many forces there are.

| symbol | meaning |
|---|---|
| u_i | rows of the response at node i that the effects read |
| base_i | the same without node forces |
| P_ij | how force j reaches them |
| b | inverse of the Radau coefficients |
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca
import numpy as np

from feeddrive.engine.step.propagators import NODES, RADAU, part, solved_in_pairs
from feeddrive.engine.step.step_constants import converged
from feeddrive.engine.step.step_symbols import StepSymbols
from feeddrive.typing import Expression

INVERSE = np.linalg.inv(RADAU).round(12)
"""Inverse of the Radau coefficients: 3/2, 1/2; -9/2, 5/2."""


@dataclass(frozen=True)
class _AtNode:
    """Forces and rates of bristles at a node, and how they change with u and z."""

    force: Expression
    rate: Expression
    force_by_read: Expression
    force_by_bristle: Expression
    rate_by_read: Expression
    rate_by_bristle: Expression


class NodeEquations:
    """Residual, correction and tangent of the unknowns at the nodes.

    Attributes:
        read: rows of a response that the effects read.
        base: symbol of these rows at both nodes, without node forces.
    """

    def __init__(self, symbols: StepSymbols) -> None:
        self.symbols = symbols
        self.read = _rows_read(symbols)
        self.base = ca.SX.sym("base", 2 * len(self.read))
        self._effects = self._node_function()
        self._nodes = [self._at_node(i) for i in range(2)]

    def corrected(self) -> tuple[Expression, Expression]:
        """A Newton correction, and the largest correction over its limit."""
        s = self.symbols
        pairs = self._pairs()
        correction = ca.SX.zeros(len(pairs), 1)
        correction[pairs] = solved_in_pairs(self._jacobian()[pairs, pairs], self._residual()[pairs])
        improved = s.guess - correction
        count = 2 * (s.forced or s.layout.bristles)
        largest, share = ca.SX(0), converged(s.layout)
        for k in range(count):
            limit = ca.fmax(share * ca.fabs(improved[k]), s.scales[k % (count // 2)])
            largest = ca.fmax(largest, ca.fabs(correction[k]) / limit)
        return improved, largest

    def tangent(self) -> ca.Function:
        """The implicit function theorem at the nodes: J d(guess) = -d(residual)."""
        s, pairs = self.symbols, self._pairs()
        given = [s.memory, self.base, s.fixed, s.values]
        changes = [ca.SX.sym(f"change_{i}", symbol.numel()) for i, symbol in enumerate(given)]
        changed = ca.jtimes(self._residual(), ca.vertcat(*given), ca.vertcat(*changes))
        change = ca.SX.zeros(len(pairs), 1)
        change[pairs] = solved_in_pairs(self._jacobian()[pairs, pairs], -changed[pairs])
        arguments = [s.memory, self.base, s.guess, s.time, s.fixed, s.values, *changes]
        return ca.Function("feeddrive_tangent", arguments, [change])

    def _residual(self) -> Expression:
        s, m, nodes = self.symbols, self.symbols.forced, self._nodes
        residual = [part(s.guess, i * m, m) - nodes[i].force for i in range(2)]
        moved = [s.node_bristles(j) - s.bristles for j in range(2)]
        for i in range(2):
            residual.append(INVERSE[i, 0] * moved[0] + INVERSE[i, 1] * moved[1] - s.step * nodes[i].rate)
        return ca.vertcat(*residual)

    def _jacobian(self) -> Expression:
        """Jacobian of the residual; its diagonal is 1 or more, plus dissipation."""
        s, m, nz, nodes = self.symbols, self.symbols.forced, self.symbols.layout.bristles, self._nodes
        jacobian = ca.SX(2 * (m + nz), 2 * (m + nz))
        for i in range(2):
            forces, own = slice(i * m, (i + 1) * m), slice(2 * m + i * nz, 2 * m + (i + 1) * nz)
            for j in range(2):
                to, bristles = slice(j * m, (j + 1) * m), slice(2 * m + j * nz, 2 * m + (j + 1) * nz)
                jacobian[forces, to] = ca.mtimes(-nodes[i].force_by_read, self._reach(i, j))
                jacobian[own, to] = ca.mtimes(-s.step * nodes[i].rate_by_read, self._reach(i, j))
                jacobian[own, bristles] = INVERSE[i, j] * ca.SX.eye(nz)
            jacobian[forces, forces] += ca.SX.eye(m)
            jacobian[forces, own] = -nodes[i].force_by_bristle
            jacobian[own, own] -= s.step * nodes[i].rate_by_bristle
        return jacobian

    def _reach(self, node: int, force: int) -> Expression:
        """P: how the force at a node reaches what is read at another."""
        block = ca.vertcat(self.symbols.blocks[4 * node + 2 + force], ca.SX.zeros(3, self.symbols.forced))
        return block[self.read, :]

    def _at_node(self, node: int) -> _AtNode:
        s, m, count = self.symbols, self.symbols.forced, len(self.read)
        read = part(self.base, node * count, count)
        for force in range(2):
            read = read + ca.mtimes(self._reach(node, force), part(s.guess, force * m, m))
        time = s.time + NODES[node] * s.step
        return _AtNode(*self._effects(read, s.node_bristles(node), time, s.fixed, s.values))

    def _node_function(self) -> ca.Function:
        """(what is read, bristles, time, fixed, values) -> the entries of `_AtNode`."""
        s = self.symbols
        read, z, time = ca.SX.sym("read", len(self.read)), ca.SX.sym("z", s.layout.bristles), ca.SX.sym("t")
        response = ca.SX.zeros(s.rows, 1)
        for k, row in enumerate(self.read):
            response[row] = read[k]
        found = s.forces(response, z, time)
        force, rate = s.on_forced(found), found.bristle_rates
        # at once, so that what force and rate have in common is differentiated once
        slopes = ca.jacobian(ca.vertcat(force, rate), ca.vertcat(read, z))
        count, m = len(self.read), s.forced
        parts = [
            slopes[rows, columns]
            for rows in (slice(0, m), slice(m, None))
            for columns in (slice(0, count), slice(count, None))
        ]
        return ca.Function("node", [read, z, time, s.fixed, s.values], [force, rate, *parts])

    def _pairs(self) -> list[int]:
        """The unknowns, each quantity at both nodes: first the bristles, which their own equations hold best."""
        m, nz = self.symbols.forced, self.symbols.layout.bristles
        bristles = [2 * m + node * nz + k for k in range(nz) for node in range(2)]
        return [*bristles, *(node * m + k for k in range(m) for node in range(2))]


def _rows_read(symbols: StepSymbols) -> list[int]:
    response = ca.SX.sym("response", symbols.rows)
    z = ca.SX.sym("z", symbols.layout.bristles)
    found = symbols.forces(response, z, symbols.time)
    outputs = ca.vertcat(symbols.on_forced(found), found.bristle_rates)
    return [k for k, used in enumerate(ca.which_depends(outputs, response, 1, False)) if used]
