"""Small pieces of symbolic algebra that steps are made of."""

from __future__ import annotations

import casadi as ca

from feeddrive.simulate.propagators import HERMITE_BASIS
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


def newton_correction(residual: Expression, unknown: Expression, right_side: Expression | None = None) -> Expression:
    """J^-1 r by elimination in pairs without pivoting: the diagonal of J is 1 plus dissipation.

    With a right side, J^-1 times that.

    Unknowns 2k and 2k + 1 belong together (the same quantity at both nodes). A pair is inverted with one division,
    since one division takes as long as ten products.
    """
    n = unknown.numel()
    if n == 0:
        return ca.SX.zeros(0, 1)
    side = residual if right_side is None else right_side
    rows = ca.SX(ca.horzcat(ca.jacobian(residual, unknown), side))
    pairs, inverted = range(0, n, 2), []
    for k in pairs:
        inverted.append(_inverse(rows[k : k + 2, k : k + 2]))
        for below in range(k + 2, n):
            if not (rows[below, k].is_zero() and rows[below, k + 1].is_zero()):
                factor = ca.mtimes(rows[below, k : k + 2], inverted[-1])
                rows[below, k + 2 :] -= ca.mtimes(factor, rows[k : k + 2, k + 2 :])
    solution = ca.SX.zeros(n, 1)
    for k, inverse in zip(reversed(pairs), reversed(inverted), strict=True):
        known = ca.mtimes(rows[k : k + 2, k + 2 : n], solution[k + 2 :]) if k + 2 < n else ca.SX.zeros(2, 1)
        solution[k : k + 2] = ca.mtimes(inverse, rows[k : k + 2, n] - known)
    return solution


def _inverse(pair: Expression) -> Expression:
    """Inverse of a matrix of two rows."""
    a, b, c, d = pair[0, 0], pair[0, 1], pair[1, 0], pair[1, 1]
    return ca.vertcat(ca.horzcat(d, -b), ca.horzcat(-c, a)) * (1 / (a * d - b * c))
