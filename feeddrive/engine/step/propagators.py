"""Exact propagation of a linear chain over one step, with polynomial forces and inputs.

    s' = A s + B w(t),   w(t) = sum_k w_k (t/h)^k

    s(c h) = E(c) s(0) + sum_k P_k(c) w_k,   P_k(c) = h int_0^c exp(h A (c - tau)) B tau^k d tau

E and P_k come together from one matrix exponential of the chain augmented by the monomials.
Source: Van Loan, IEEE Trans. Automat. Contr. 23 (1978) 395; Hairer and Wanner, Solving ODEs II, section IV.5 (Radau
IIA).
"""

from __future__ import annotations

import casadi as ca
import numpy as np
from scipy.linalg import expm

from feeddrive.typing import Expression, FloatArray

NODES = (1 / 3, 1.0)
"""Nodes of Radau IIA with two stages; order 3, stiffly accurate."""

RADAU = np.array([[5 / 12, -1 / 12], [3 / 4, 1 / 4]])
"""Coefficients of Radau IIA with two stages."""

NODE_BASIS = np.array([[1.5, -1.5], [-0.5, 1.5]])
"""Row j: monomial coefficients (1, tau) of the polynomial that is 1 at node j and 0 at the other."""

HERMITE_BASIS = np.array([[1, 0, -3, 2], [0, 1, -2, 1], [0, 0, 3, -2], [0, 0, -1, 1]], dtype=float)
"""Rows: monomial coefficients of value and scaled slope at the start, value and scaled slope at the end of a step."""


def monomial_propagators(a: FloatArray, b: FloatArray, step: float, degree: int) -> list[tuple[FloatArray, FloatArray]]:
    """E(c), (n, n), and P_k(c), (degree + 1, n, m), at both nodes c, of A, (n, n) [1/s], B, (n, m), and h [s]."""
    n, m = b.shape
    if n == 0:
        return [(np.zeros((0, 0)), np.zeros((degree + 1, 0, m)))] * 2
    size = n + m * (degree + 1)
    generator = np.zeros((size, size), dtype=np.result_type(a, b))  # complex where a change is carried along
    generator[:n, :n] = step * a
    # the monomials tau^k obey d/dtau tau^k = k tau^(k-1); P_k is the response to tau^k alone
    for k in range(degree + 1):
        start = n + k * m
        if k == 0:
            generator[:n, start : start + m] = step * b
        else:
            generator[n + (k - 1) * m : n + k * m, start : start + m] = k * np.eye(m)
    third = expm(NODES[0] * generator)
    maps = [third, third @ third @ third]  # the second node is three times as far
    return [
        (full[:n, :n], np.stack([full[:n, n + k * m : n + (k + 1) * m] for k in range(degree + 1)])) for full in maps
    ]


def basis_propagators(propagators: FloatArray, basis: FloatArray) -> FloatArray:
    """Responses (functions, n, m) to functions whose monomial coefficients are the rows of `basis`, from P.

    P is (degree + 1, n, m), the basis (functions, degree + 1).
    """
    responses: FloatArray = np.einsum("fk,knm->fnm", basis, propagators)
    return responses


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
