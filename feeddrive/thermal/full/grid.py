"""Finite volumes of a solid or hollow cylinder, axisymmetric: volumes and conductances between them.

Radially the nodes lie on the vertices, so that the surfaces carry nodes that own half cells; axially they lie in the
middle of the cells (paper 002, section 2.2 and figure 3). With that the balances are those of the paper's equations
(7) to (13), k1 and k2 in (7) put right.

| symbol | meaning | unit |
|---|---|---|
| r, z | radius, place along the axis | m |
| Δr, Δz | distance of nodes | m |
| λ, ρc | conductivity, heat capacity of volume | W/(m K), J/(m³ K) |

Which stretch of the shaft a moving nut covers: overlaps of cells, and their mean over the travel.

A nut that goes to and fro at constant speed has its centre equally often everywhere in between. Overlaps are linear in
the centre, so that their mean is a second difference of a quadratic and needs no quadrature.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sparse

from feeddrive.thermal.rig import Steel, Travel, refuse_unless
from feeddrive.typing import Expression, FloatArray


def cell_edges(length: float, cells: int) -> FloatArray:
    """Edges of equal cells from 0 to `length`, (cells + 1,) [m]."""
    return np.linspace(0.0, length, cells + 1)


def places_of(travel: Travel, cell: float) -> tuple[FloatArray, FloatArray]:
    """Places (k,) [m] of the nut's centre on its way, a cell [m] or less apart, and the share of time at each, (k,).

    At the two ends it stands half as long as elsewhere.
    """
    stretches = math.ceil(travel.stroke / cell - 1e-9)
    if stretches == 0:
        return np.array([travel.low]), np.ones(1)
    shares = np.full(stretches + 1, 1.0 / stretches)
    shares[[0, -1]] /= 2
    return np.linspace(travel.low, travel.high, stretches + 1), shares


def overlap(nut_edges: FloatArray, shaft_edges: FloatArray, travel: Travel) -> FloatArray:
    """Mean length on which each nut cell faces each shaft cell along the travel, (k, n) [m].

    Edges of the nut's cells count from its centre, (k + 1,) [m], those of the shaft's are (n + 1,) [m]. A row adds up
    to the length of its nut cell while the nut is on the shaft.
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


@dataclass(frozen=True)
class Cells:
    """Numbers of cells: along the shaft and the nut, over their radii.

    The default suits a shaft of about half a metre: 2.5 mm along it, so that the heated surface of a bearing's seat is
    resolved (with 5 mm the seat is 20 mK per watt off), 2 mm over the radii.
    """

    shaft_axial: int = 200
    shaft_radial: int = 4
    nut_axial: int = 20
    nut_radial: int = 6

    def __post_init__(self) -> None:
        least = min(self.shaft_axial, self.nut_axial, self.shaft_radial, self.nut_radial)
        refuse_unless(least >= 1, f"{least} cells are none", "cells", "write at least 1 in each direction")

    def refined(self, factor: int) -> Cells:
        """A grid with `factor` times as many cells in each direction."""
        return Cells(*(factor * n for n in (self.shaft_axial, self.shaft_radial, self.nut_axial, self.nut_radial)))


@dataclass(frozen=True, eq=False)
class Cylinder:
    """A cylinder in finite volumes; node (n, m), radial n, axial m, has the index n·axial + m.

    Attributes:
        edges: of the axial cells, (axial + 1,) [m].
        radii: of the nodes, (radial + 1,) [m].
        areas: cross-section that each radial node owns, (radial + 1,) [m²].
        steel: material.
    """

    edges: FloatArray
    radii: FloatArray
    areas: FloatArray
    steel: Steel

    @property
    def axial(self) -> int:
        """Number of axial cells."""
        return len(self.edges) - 1

    @property
    def nodes(self) -> int:
        """Number of nodes."""
        return self.axial * len(self.radii)

    @property
    def spacing(self) -> float:
        """Δz [m]."""
        return float(self.edges[1] - self.edges[0])

    def capacities(self) -> FloatArray:
        """ρcV of each node, (nodes,) [J/K]."""
        return np.repeat(self.steel.heat_capacity * self.areas * self.spacing, self.axial)

    def conduction(self) -> Expression:
        """Conductance matrix, (nodes, nodes) sparse, symmetric, its rows add up to zero [W/K]."""
        λ, Δz = self.steel.conductivity, self.spacing
        along = sparse.kron(sparse.diags(λ * self.areas / Δz), _chain(np.ones(self.axial - 1)))
        Δr = self.radii[1] - self.radii[0]
        between = (self.radii[1:] + self.radii[:-1]) / 2
        across = sparse.kron(_chain(λ * 2 * np.pi * between * Δz / Δr), sparse.eye(self.axial))
        return (along + across).tocsr()

    def surface(self, radial: int) -> slice:
        """Indices of the nodes of one radius; radial = -1 is the outer surface."""
        layer = radial % len(self.radii)
        return slice(layer * self.axial, (layer + 1) * self.axial)

    def section_mean(self) -> Expression:
        """Matrix from nodes to the mean over each cross-section, (axial, nodes) sparse."""
        return sparse.kron(self.areas / self.areas.sum(), sparse.eye(self.axial)).tocsr()


def cylinder(inner: float, outer: float, radial: int, length: float, axial: int, steel: Steel) -> Cylinder:
    """Divide a cylinder of radii and length [m] into cells; `inner` = 0 is solid, its first node the axis."""
    radii = np.linspace(inner, outer, radial + 1)
    faces = np.concatenate([[inner], (radii[1:] + radii[:-1]) / 2, [outer]])
    return Cylinder(cell_edges(length, axial), radii, np.pi * np.diff(faces**2), steel)


def _chain(conductances: FloatArray) -> Expression:
    """Conductance matrix of nodes in a row, (n + 1, n + 1) sparse."""
    n = len(conductances) + 1
    difference = sparse.diags([-np.ones(n - 1), np.ones(n - 1)], [0, 1], shape=(n - 1, n))
    return difference.T @ sparse.diags(conductances) @ difference
