"""The full model: finite volumes of screw and nut at one travel, the moving nut averaged over it or at one place.

The nut goes to and fro in seconds, the temperatures follow in minutes. So a stretch of the shaft feels the nut, and the
air where the nut is not, for the share of time that it is covered (`occupancy`). What this average leaves out, the
ripple within a period, is treated in `moving`.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sparse

from feeddrive.thermal.full.grid import Cells, Cylinder, covered_share, cylinder, overlap
from feeddrive.thermal.laws.expansion import growth_row
from feeddrive.thermal.reduced.parametric_model import AMBIENT, COOLANT, HeatModel, Path, Way
from feeddrive.thermal.rig import Rig, Seat, Travel
from feeddrive.typing import Expression, FloatArray

NUT, FRONT, REAR, SHAFT, END = "nut", "front", "rear", "shaft_travel", "growth_end"


@dataclass(frozen=True, eq=False)
class Discretisation:
    """A rig in finite volumes; states: shaft nodes, then nut nodes.

    Attributes:
        rig: geometry and material.
        shaft, nut: their cylinders.
    """

    rig: Rig
    shaft: Cylinder
    nut: Cylinder

    @property
    def nodes(self) -> int:
        """Number of states."""
        return self.shaft.nodes + self.nut.nodes

    @property
    def skin(self) -> slice:
        """States of the shaft's surface."""
        return self.shaft.surface(-1)

    @property
    def bore(self) -> slice:
        """States of the nut's inner surface."""
        return self._on_nut(0)

    @property
    def hull(self) -> slice:
        """States of the nut's outer surface."""
        return self._on_nut(-1)

    @property
    def girth(self) -> float:
        """Circumference of the shaft [m]."""
        return 2 * np.pi * self.rig.radius

    def _on_nut(self, radial: int) -> slice:
        within = self.nut.surface(radial)
        return slice(within.start + self.shaft.nodes, within.stop + self.shaft.nodes)

    def overlap(self, travel: Travel) -> FloatArray:
        """Mean lengths on which nut cells face shaft cells, (nut axial, shaft axial) [m]."""
        return overlap(self.nut.edges - self.rig.nut.length / 2, self.shaft.edges, travel)

    def spread(self, at: slice, values: FloatArray) -> FloatArray:
        """A vector over all states with `values` on some of them, (nodes,)."""
        vector = np.zeros(self.nodes)
        vector[at] = values
        return vector


def discretise(rig: Rig, cells: Cells) -> Discretisation:
    """Divide a rig into finite volumes."""
    shaft = cylinder(0.0, rig.radius, cells.shaft_radial, rig.length, cells.shaft_axial, rig.steel)
    nut = cylinder(rig.radius, rig.nut.outer_radius, cells.nut_radial, rig.nut.length, cells.nut_axial, rig.steel)
    return Discretisation(rig, shaft, nut)


def full_model(rig: Rig, cells: Cells | None = None, travel: Travel | None = None) -> HeatModel:
    """Heat balance with the nut averaged over its travel.

    Args:
        rig: geometry and material.
        cells: numbers of cells; None for the default ones.
        travel: in place of the rig's; low = high for a nut that stays.

    Returns:
        The model; inputs: heat of the nut, the front and the rear seat; outputs: mean rise of the nut's outer surface
        ("nut"), of the seats' surfaces ("front", "rear"), mean of the shaft over the travel ("shaft_travel"), growth
        from the front end to each of the rig's growth positions ("growth_200mm") and to the rear end ("growth_end").

    Raises:
        InputError: a travel on which the nut leaves the shaft.
    """
    return model_of(discretise(rig, cells or Cells()), travel or rig.travel)


def model_of(parts: Discretisation, travel: Travel) -> HeatModel:
    """As `full_model`, of a rig that is divided already."""
    parts.rig.refuse_travel(travel)
    lengths = parts.overlap(travel)
    return HeatModel(
        capacity=np.concatenate([parts.shaft.capacities(), parts.nut.capacities()]),
        conduction=sparse.block_diag([parts.shaft.conduction(), parts.nut.conduction()]).tocsr(),
        ways={Path.CONTACT: contact_way(parts, lengths), **_films(parts, lengths), Path.COOLING: _cooling(parts)},
        heats=_heats(parts, lengths),
        readings=_readings(parts, travel),
        profile=_profile(parts),
        edges=parts.shaft.edges,
        ports=_ports(parts),
        air=np.zeros(parts.nodes),
    )


def _profile(parts: Discretisation) -> Expression:
    beside = sparse.csr_array((parts.shaft.axial, parts.nut.nodes))
    return sparse.hstack([parts.shaft.section_mean(), beside]).tocsr()


def contact_way(parts: Discretisation, lengths: FloatArray) -> Way:
    """Contact between nut and shaft by the lengths on which their cells face each other."""
    area = sparse.csr_array(lengths * parts.girth)
    place = sparse.csr_array((parts.nodes, parts.nodes), dtype=float).tolil()
    place[parts.bore, parts.skin] = -area
    off = place.tocsr()
    off = off + off.T
    return Way((off - sparse.diags_array(np.asarray(off.sum(axis=1)).ravel())).tocsr(), np.zeros(parts.nodes), "")


def bare_area(parts: Discretisation, lengths: FloatArray) -> FloatArray:
    """Area of each shaft cell that faces the air: not the nut, nor a bearing with a film of its own, (axial,) [m²]."""
    seats = [
        covered_share(low, high, parts.shaft.edges) for seat, low, high in _seats(parts.rig) if seat.film is not None
    ]
    bare = parts.shaft.spacing * (1 - np.sum(seats, axis=0)) - lengths.sum(axis=0)
    return np.asarray(bare * parts.girth)


def _films(parts: Discretisation, lengths: FloatArray) -> dict[Path, Way]:
    films = {Path.SCREW_FILM: parts.spread(parts.skin, bare_area(parts, lengths)), Path.NUT_FILM: _nut_area(parts)}
    for path, (seat, low, high) in zip((Path.FRONT_FILM, Path.REAR_FILM), _seats(parts.rig), strict=True):
        films[path] = _seat_area(parts, seat, low, high) if seat.film is not None else np.zeros(parts.nodes)
    return {path: Way(sparse.diags_array(area).tocsr(), area, AMBIENT) for path, area in films.items()}


def _nut_area(parts: Discretisation) -> FloatArray:
    """Outer surface of the nut and the share of its end faces that convects, (nodes,) [m²]."""
    nut = parts.rig.nut
    area = parts.spread(parts.hull, np.full(parts.nut.axial, 2 * np.pi * nut.outer_radius * parts.nut.spacing))
    first = parts.shaft.nodes + np.arange(len(parts.nut.radii)) * parts.nut.axial
    for end in (first, first + parts.nut.axial - 1):
        area[end] += nut.end_share * parts.nut.areas
    return area


def _seat_area(parts: Discretisation, seat: Seat, low: float, high: float) -> FloatArray:
    """Cylindrical surface of a seat and its share of the end face, (nodes,) [m²]."""
    share = covered_share(low, high, parts.shaft.edges)
    area = parts.spread(parts.skin, share * parts.shaft.spacing * parts.girth)
    column = np.arange(len(parts.shaft.radii)) * parts.shaft.axial + (0 if low == 0 else parts.shaft.axial - 1)
    area[column] += seat.end_share * parts.shaft.areas
    return area


def _cooling(parts: Discretisation) -> Way:
    place = _ports(parts)[NUT]
    column = sparse.csr_array(place[:, None])
    return Way((column @ column.T).tocsr(), place, COOLANT)


def _heats(parts: Discretisation, lengths: FloatArray) -> dict[str, FloatArray]:
    share = parts.rig.nut_heat_share
    facing = lengths / lengths.sum()
    nut = parts.spread(parts.bore, share * facing.sum(axis=1)) + parts.spread(
        parts.skin, (1 - share) * facing.sum(axis=0)
    )
    return {NUT: nut, FRONT: _ports(parts)[FRONT], REAR: _ports(parts)[REAR]}


def _ports(parts: Discretisation) -> dict[str, FloatArray]:
    """Vectors that spread a heat evenly over a surface; as rows they take its mean."""
    edges = parts.shaft.edges
    ports = {NUT: parts.spread(parts.hull, np.full(parts.nut.axial, 1 / parts.nut.axial))}
    for name, (_, low, high) in zip((FRONT, REAR), _seats(parts.rig), strict=True):
        share = covered_share(low, high, edges)
        ports[name] = parts.spread(parts.skin, share / share.sum())
    return ports


def _readings(parts: Discretisation, travel: Travel) -> dict[str, FloatArray]:
    profile, edges, ports = parts.shaft.section_mean(), parts.shaft.edges, _ports(parts)

    def over(share: FloatArray) -> FloatArray:
        return parts.spread(slice(0, parts.shaft.nodes), share @ profile)

    swept = covered_share(*_not_a_point(travel, parts.shaft.spacing), edges)
    grown = {growth_name(x): over(growth_row(parts.rig, edges, x)) for x in parts.rig.growth_positions}
    return {
        NUT: ports[NUT],
        FRONT: ports[FRONT],
        REAR: ports[REAR],
        SHAFT: over(swept / swept.sum()),
        **grown,
        END: over(growth_row(parts.rig, edges, float(edges[-1]))),
    }


def growth_name(position: float) -> str:
    """Name of the growth at a place of the nut, as in recordings without its prefix: "growth_200mm"."""
    return f"growth_{position * 1e3:g}mm"


def _not_a_point(travel: Travel, width: float) -> tuple[float, float]:
    widened = max(width - travel.stroke, 0.0) / 2
    return travel.low - widened, travel.high + widened


def _seats(rig: Rig) -> Iterable[tuple[Seat, float, float]]:
    return ((rig.front, 0.0, rig.front.length), (rig.rear, rig.length - rig.rear.length, rig.length))
