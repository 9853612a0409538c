"""Curves through a table of points that do not overshoot, as CasADi expressions of the points."""

from __future__ import annotations

import casadi as ca

from feeddrive.typing import Expression

_NO_SLOPE = 1e-300
"""Keeps the slope of a flat table from 0/0, and changes no other."""


def smooth_curve(x: Expression, nodes: Expression, values: Expression) -> Expression:
    """Monotone cubic through the points, constant outside.

    Between points it rises and falls where they do, and its slope is continuous; at an end point the slope is that of
    the neighbouring chord.

    Args:
        x: where.
        nodes: ascending, shape (k, 1).
        values: at the nodes, shape (k, 1).

    Source: Fritsch and Butland, SIAM J. Sci. Stat. Comput. 5 (1984) 300.
    """
    count = nodes.numel()
    if count == 1:
        return values[0]
    widths = [nodes[i + 1] - nodes[i] for i in range(count - 1)]
    chords = [(values[i + 1] - values[i]) / widths[i] for i in range(count - 1)]
    slopes = [chords[0], *(_slope(widths[i : i + 2], chords[i : i + 2]) for i in range(count - 2)), chords[-1]]
    result = values[0]
    for i in range(count - 1):
        s = ca.fmin(ca.fmax((x - nodes[i]) / widths[i], 0), 1)
        result += widths[i] * _rise(s, chords[i], slopes[i], slopes[i + 1])
    return result


def _slope(widths: list[Expression], chords: list[Expression]) -> Expression:
    """Weighted harmonic mean of two chords, 0 where they differ in sign."""
    first, second = 2 * widths[1] + widths[0], widths[1] + 2 * widths[0]
    same = ca.fmax(chords[0] * chords[1], 0) * ca.sign(chords[0])
    return (first + second) * same / (first * ca.fabs(chords[1]) + second * ca.fabs(chords[0]) + _NO_SLOPE)


def _rise(s: Expression, chord: Expression, start: Expression, end: Expression) -> Expression:
    """Rise of Hermite's cubic over its width, from 0 at s = 0 to the chord at s = 1."""
    return s * (start + s * ((3 * chord - 2 * start - end) + s * (start + end - 2 * chord)))
