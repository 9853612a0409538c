"""Finite volumes of a solid or hollow cylinder, axisymmetric: volumes and conductances between them.

Radially the nodes lie on the vertices, so that the surfaces carry nodes that own half cells; axially they lie in the
middle of the cells (paper 002, section 2.2 and figure 3). With that the balances are those of the paper's equations
(7) to (13), k1 and k2 in (7) put right.

| symbol | meaning | unit |
|---|---|---|
| r, z | radius, place along the axis | m |
| Δr, Δz | distance of nodes | m |
| λ, ρc | conductivity, heat capacity of volume | W/(m K), J/(m³ K) |
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sparse

from feeddrive.thermal.full.occupancy import cell_edges
from feeddrive.thermal.rig import Steel, refuse_unless
from feeddrive.typing import Expression, FloatArray


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
    """Divide a cylinder; `inner` = 0 is a solid one, whose first node is its axis.

    Args:
        inner, outer: radii [m].
        radial, axial: numbers of cells.
        length: [m].
        steel: material.
    """
    radii = np.linspace(inner, outer, radial + 1)
    faces = np.concatenate([[inner], (radii[1:] + radii[:-1]) / 2, [outer]])
    return Cylinder(cell_edges(length, axial), radii, np.pi * np.diff(faces**2), steel)


def _chain(conductances: FloatArray) -> Expression:
    """Conductance matrix of nodes in a row, (n + 1, n + 1) sparse."""
    n = len(conductances) + 1
    difference = sparse.diags([-np.ones(n - 1), np.ones(n - 1)], [0, 1], shape=(n - 1, n))
    return difference.T @ sparse.diags(conductances) @ difference
