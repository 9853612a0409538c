"""Small pieces of symbolic algebra that steps are made of."""

from __future__ import annotations

import casadi as ca

from feeddrive.simulate.propagators import HERMITE_BASIS
from feeddrive.typing import Expression


def cubic(ends: Expression, place: Expression, span: Expression) -> tuple[Expression, Expression]:
    """Value and rate at a place in 0..1 of the cubic with (value, rate) at both ends, `span` [s] apart."""
    scaled = ca.vertcat(ends[0], span * ends[1], ends[2], span * ends[3])
    monomials = ca.mtimes(ca.DM(HERMITE_BASIS).T, scaled)
    value = monomials[0] + place * (monomials[1] + place * (monomials[2] + place * monomials[3]))
    rate = (monomials[1] + place * (2 * monomials[2] + place * 3 * monomials[3])) / span
    return value, rate


def part(column: Expression, start: int, count: int) -> Expression:
    """Rows of a column; a column of no rows where count is 0, which slicing would turn into a row."""
    return ca.reshape(column[start : start + count], count, 1)


def newton_correction(residual: Expression, unknown: Expression) -> Expression:
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
