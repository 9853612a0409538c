"""Which stretch of the shaft a moving nut covers: overlaps of cells, and their mean over the travel.

A nut that goes to and fro at constant speed has its centre equally often everywhere in between. Overlaps are linear in
the centre, so that their mean is a second difference of a quadratic and needs no quadrature.
"""

from __future__ import annotations

import math

import numpy as np

from feeddrive.thermal.rig import Travel
from feeddrive.typing import FloatArray


def cell_edges(length: float, cells: int) -> FloatArray:
    """Edges of equal cells from 0 to `length`, (cells + 1,) [m]."""
    return np.linspace(0.0, length, cells + 1)


def places_of(travel: Travel, cell: float) -> tuple[FloatArray, FloatArray]:
    """Places where the nut's centre stands on its way, a cell or less apart, and the share of time at each.

    Args:
        travel: of the nut's centre.
        cell: axial cell of the nut [m].

    Returns:
        Places (k,) [m] and shares (k,); at the two ends it stands half as long as elsewhere.
    """
    stretches = math.ceil(travel.stroke / cell - 1e-9)
    if stretches == 0:
        return np.array([travel.low]), np.ones(1)
    shares = np.full(stretches + 1, 1.0 / stretches)
    shares[[0, -1]] /= 2
    return np.linspace(travel.low, travel.high, stretches + 1), shares


def overlap(nut_edges: FloatArray, shaft_edges: FloatArray, travel: Travel) -> FloatArray:
    """Mean length on which each nut cell faces each shaft cell.

    Args:
        nut_edges: edges of the nut's cells counted from its centre, (k + 1,) [m].
        shaft_edges: edges of the shaft's cells, (n + 1,) [m].
        travel: of the nut's centre.

    Returns:
        Lengths, (k, n) [m]; a row adds up to the length of its nut cell while the nut is on the shaft.
    """
    between = nut_edges[:, None] - shaft_edges[None, :]
    ramp = _mean_ramp(between, travel)
    lengths = ramp[1:, :-1] - ramp[:-1, :-1] - ramp[1:, 1:] + ramp[:-1, 1:]
    tiny = 1e-12 * float(shaft_edges[-1])
    return np.where(lengths > tiny, lengths, 0.0)


def covered_share(low: float, high: float, edges: FloatArray) -> FloatArray:
    """Share of each cell that lies between two fixed places, (n,)."""
    return np.asarray(np.clip(np.minimum(edges[1:], high) - np.maximum(edges[:-1], low), 0.0, None) / np.diff(edges))


def _mean_ramp(start: FloatArray, travel: Travel) -> FloatArray:
    """Mean of max(start + c, 0) with c equally distributed over the travel."""
    if travel.stroke <= 1e-12:
        return np.maximum(start + travel.low, 0.0)
    squares = np.maximum(start + travel.high, 0.0) ** 2 - np.maximum(start + travel.low, 0.0) ** 2
    return np.asarray(squares / (2 * travel.stroke))
