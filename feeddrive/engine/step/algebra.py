"""Small pieces of symbolic algebra that steps are made of."""

from __future__ import annotations

import casadi as ca

from feeddrive.engine.step.propagators import HERMITE_BASIS
from feeddrive.typing import Expression


def cubic(ends: Expression, place: Expression, span: Expression) -> tuple[Expression, Expression, Expression]:
    """Value, rate, acceleration at a place in 0..1 of the cubic with (value, rate) at both ends, `span` [s] apart."""
    scaled = ca.vertcat(ends[0], span * ends[1], ends[2], span * ends[3])
    monomials = ca.mtimes(ca.DM(HERMITE_BASIS).T, scaled)
    value = monomials[0] + place * (monomials[1] + place * (monomials[2] + place * monomials[3]))
    rate = (monomials[1] + place * (2 * monomials[2] + place * 3 * monomials[3])) / span
    return value, rate, (2 * monomials[2] + place * 6 * monomials[3]) / span**2


def part(column: Expression, start: int, count: int) -> Expression:
    """Rows of a column; a column of no rows where count is 0, which slicing would turn into a row."""
    return ca.reshape(column[start : start + count], count, 1)


def solved_in_pairs(matrix: Expression, right_side: Expression) -> Expression:
    """The solution of a linear system by elimination in pairs without pivoting: the diagonal is 1 plus dissipation.

    Unknowns 2k and 2k + 1 belong together (the same quantity at both nodes). Rows are multiplied with the determinant
    of a pair and not divided by it, so that a division, which takes as long as ten products, is waited for only once.
    """
    n = right_side.numel()
    if n == 0:
        return ca.SX.zeros(0, 1)
    rows: Expression = ca.horzcat(matrix, right_side)
    pairs, adjugates, determinants = range(0, n, 2), [], []
    for k in pairs:
        a, b, c, d = rows[k, k], rows[k, k + 1], rows[k + 1, k], rows[k + 1, k + 1]
        adjugates.append(ca.vertcat(ca.horzcat(d, -b), ca.horzcat(-c, a)))
        determinants.append(a * d - b * c)
        for below in range(k + 2, n):
            if not (rows[below, k].is_zero() and rows[below, k + 1].is_zero()):
                factor = ca.mtimes(rows[below, k : k + 2], adjugates[-1])
                rest = determinants[-1] * rows[below, k + 2 :] - ca.mtimes(factor, rows[k : k + 2, k + 2 :])
                rows[below, k + 2 :] = rest
    solution: Expression = ca.SX.zeros(n, 1)
    for k, adjugate, determinant in zip(reversed(pairs), reversed(adjugates), reversed(determinants), strict=True):
        known = ca.mtimes(rows[k : k + 2, k + 2 : n], solution[k + 2 :]) if k + 2 < n else ca.SX.zeros(2, 1)
        solution[k : k + 2] = ca.mtimes(adjugate, rows[k : k + 2, n] - known) / determinant
    return solution
