"""Exact propagation of a linear chain over one step, with polynomial forces and inputs.

    s' = A s + B w(t),   w(t) = sum_k w_k (t/h)^k

    s(c h) = E(c) s(0) + sum_k P_k(c) w_k,   P_k(c) = h int_0^c exp(h A (c - tau)) B tau^k d tau

E and P_k come together from one matrix exponential of the chain augmented by the monomials.
Source: Van Loan, IEEE Trans. Automat. Contr. 23 (1978) 395; Hairer and Wanner, Solving ODEs II, section IV.5 (Radau
IIA).
"""

from __future__ import annotations

import numpy as np
from scipy.linalg import expm

from feeddrive.typing import FloatArray

NODES = (1 / 3, 1.0)
"""Nodes of Radau IIA with two stages; order 3, stiffly accurate."""

RADAU = np.array([[5 / 12, -1 / 12], [3 / 4, 1 / 4]])
"""Coefficients of Radau IIA with two stages."""

NODE_BASIS = np.array([[1.5, -1.5], [-0.5, 1.5]])
"""Row j: monomial coefficients (1, tau) of the polynomial that is 1 at node j and 0 at the other."""

HERMITE_BASIS = np.array([[1, 0, -3, 2], [0, 1, -2, 1], [0, 0, 3, -2], [0, 0, -1, 1]], dtype=float)
"""Rows: monomial coefficients of value and scaled slope at the start, value and scaled slope at the end of a step."""


def monomial_propagators(a: FloatArray, b: FloatArray, step: float, degree: int) -> list[tuple[FloatArray, FloatArray]]:
    """E(c) and P_k(c) for k = 0..degree at both nodes c.

    Args:
        a: A, shape (n, n) [1/s].
        b: B, shape (n, m).
        step: h [s].
        degree: highest power.

    Returns:
        Per node E, shape (n, n), and P, shape (degree + 1, n, m).
    """
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
    """Response to the functions whose monomial coefficients are the rows of `basis`.

    Args:
        propagators: P, shape (degree + 1, n, m).
        basis: shape (functions, degree + 1).

    Returns:
        Shape (functions, n, m).
    """
    responses: FloatArray = np.einsum("fk,knm->fnm", basis, propagators)
    return responses
