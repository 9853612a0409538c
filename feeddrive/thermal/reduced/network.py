"""A network of few lumps that can be read and drawn: nut, segments of the shaft, what is attached to them.

| symbol | meaning | unit |
|---|---|---|
| l | length of a segment | m |
| λ A / l | conductance between the middles of two equal segments | W/K |
| g 2πR p | contact with a segment that the nut covers for the mean length p, in series with the way inside | W/K |

The boundaries lie at the ends of the swept zone. Each lump has its mean temperature; the errors beside the full model
are some per cent with 10 segments (`reduction_error`), those of balanced models of the same order a hundredth of that.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from feeddrive.thermal.full.full_model import END, FRONT, NUT, REAR, SHAFT, growth_name
from feeddrive.thermal.full.grid import covered_share, overlap
from feeddrive.thermal.laws.expansion import growth_row
from feeddrive.thermal.reduced.parametric_model import AMBIENT, COOLANT, Path
from feeddrive.thermal.reduced.system import HeatSystem
from feeddrive.thermal.rig import Body, Rig, Travel, refuse_unless
from feeddrive.typing import FloatArray

_SEGMENT = "shaft_"


@dataclass(frozen=True)
class Lump:
    """A node: its name, capacity [J/K] and conductance to the air [W/K]."""

    name: str
    capacity: float
    to_air: float


@dataclass(frozen=True)
class Link:
    """A conductance between two nodes [W/K]."""

    first: str
    second: str
    conductance: float


@dataclass(frozen=True, eq=False)
class Network:
    """Lumps and links of a rig at one operating point.

    Attributes:
        lumps: "nut", then "shaft_1" from the front end on.
        links: between them.
        edges: of the shaft's segments, (segments + 1,) [m].
        rig: of which it was made.
    """

    lumps: tuple[Lump, ...]
    links: tuple[Link, ...]
    edges: FloatArray
    rig: Rig

    def text(self) -> str:
        """Nodes and links as people read them."""
        nodes = [f"{lump.name:<9}{lump.capacity:8.1f} J/K{lump.to_air:10.4f} W/K to air" for lump in self.lumps]
        ties = [f"{link.first:<9}- {link.second:<9}{link.conductance:10.4f} W/K" for link in self.links]
        return "\n".join([*nodes, *ties])

    def system(self) -> HeatSystem:
        """The network as a system with the inputs and outputs of the full model."""
        names = [lump.name for lump in self.lumps]
        air = np.array([lump.to_air for lump in self.lumps])
        K = np.diag(air)
        for link in self.links:
            difference = np.zeros(len(names))
            difference[names.index(link.first)], difference[names.index(link.second)] = 1.0, -1.0
            K += link.conductance * np.outer(difference, difference)
        readings = self._readings()
        bodies = names[len(self.edges) :]
        own = [readings[name] for name in bodies]
        none = np.zeros(len(names))
        heats = np.column_stack([self._nut_heat(), readings[FRONT], readings[REAR], *own, air, none])
        return HeatSystem(
            np.array([lump.capacity for lump in self.lumps]),
            K,
            heats,
            np.vstack(list(readings.values())),
            (NUT, FRONT, REAR, *bodies, AMBIENT, COOLANT),
            tuple(readings),
        )

    def _nut_heat(self) -> FloatArray:
        """The nut's friction heat: its share on the nut, the rest on the segments as long as they are covered."""
        rig = self.rig
        half = rig.nut.length / 2
        covered = overlap(np.array([-half, half]), self.edges, rig.travel)[0] / rig.nut.length
        others = np.zeros(len(self.lumps) - 1 - len(covered))
        return np.concatenate([[rig.nut_heat_share], (1 - rig.nut_heat_share) * covered, others])

    def _readings(self) -> dict[str, FloatArray]:
        def mean(low: float, high: float) -> FloatArray:
            lengths = covered_share(low, high, self.edges) * np.diff(self.edges)
            others = np.zeros(len(self.lumps) - 1 - len(lengths))
            return np.concatenate([[0.0], lengths / lengths.sum(), others])

        def grows(position: float) -> FloatArray:
            return single[1 : len(self.edges)].T @ growth_row(self.rig, self.edges, position)

        single = np.eye(len(self.lumps))
        rig, travel = self.rig, self.rig.travel
        grown = {growth_name(x): grows(x) for x in rig.growth_positions}
        swept = mean(travel.low - 1e-6, travel.high + 1e-6)
        ends = {FRONT: mean(0.0, rig.front.length), REAR: mean(rig.length - rig.rear.length, rig.length)}
        bodies = {lump.name: single[i] for i, lump in enumerate(self.lumps) if i >= len(self.edges)}
        return {NUT: single[0], **ends, SHAFT: swept, **grown, END: grows(float(self.edges[-1])), **bodies}


def network(rig: Rig, conductances: Mapping[Path, float], segments: int = 10, bodies: tuple[Body, ...] = ()) -> Network:
    """Lump a rig at one operating point.

    Args:
        rig: geometry and material.
        conductances: path to g.
        segments: of the shaft, at least three.
        bodies: motor, bearing housings, table; each a lump of its own.

    Raises:
        InputError: fewer than three segments.
    """
    edges = _segment_edges(rig, segments)
    lengths = np.diff(edges)
    half = rig.nut.length / 2
    covered = overlap(np.array([-half, half]), edges, rig.travel)[0]
    λ, R = rig.steel.conductivity, rig.radius
    names = [f"{_SEGMENT}{i + 1}" for i in range(segments)]
    along = [
        Link(names[i], names[i + 1], λ * math.pi * R**2 / ((lengths[i] + lengths[i + 1]) / 2))
        for i in range(segments - 1)
    ]
    contact = _contact(rig, conductances.get(Path.CONTACT, 0.0), covered)
    across = [Link(NUT, name, float(g)) for name, g in zip(names, contact, strict=True) if g > 0]
    air = _to_air(rig, conductances, edges, covered)
    ρc_A = rig.steel.heat_capacity * math.pi * R**2
    shaft = [Lump(name, float(ρc_A * Δ), float(g)) for name, Δ, g in zip(names, lengths, air, strict=True)]
    places = {NUT: NUT, FRONT: names[0], REAR: names[-1]}
    others = [Lump(body.name, body.capacity, body.to_air) for body in bodies]
    ties = [Link(body.name, places[body.port], body.conductance) for body in bodies]
    return Network((_nut(rig, conductances), *shaft, *others), (*across, *along, *ties), edges, rig)


def _nut(rig: Rig, conductances: Mapping[Path, float]) -> Lump:
    section = math.pi * (rig.nut.outer_radius**2 - rig.radius**2)
    outside = 2 * math.pi * rig.nut.outer_radius * rig.nut.length + 2 * rig.nut.end_share * section
    g = conductances.get(Path.NUT_FILM, 0.0) * outside
    return Lump(NUT, rig.steel.heat_capacity * section * rig.nut.length, g)


def _contact(rig: Rig, g: float, covered: FloatArray) -> FloatArray:
    """Contact in series with the way from the mean of the shaft and of the nut to its surface, (segments,) [W/K]."""
    λ, R = rig.steel.conductivity, rig.radius
    mean_radius = math.sqrt((R**2 + rig.nut.outer_radius**2) / 2)
    inside = 1 / (8 * math.pi * λ) + math.log(mean_radius / R) / (2 * math.pi * λ)
    per_length = g * 2 * math.pi * R
    return np.asarray(covered * per_length / (1 + inside * per_length))


def _to_air(rig: Rig, conductances: Mapping[Path, float], edges: FloatArray, covered: FloatArray) -> FloatArray:
    lengths, girth = np.diff(edges), 2 * math.pi * rig.radius
    bare, total = lengths - covered, np.zeros(len(lengths))
    for seat, low, high, path in (
        (rig.front, 0.0, rig.front.length, Path.FRONT_FILM),
        (rig.rear, rig.length - rig.rear.length, rig.length, Path.REAR_FILM),
    ):
        if seat.film is not None:
            on_seat = covered_share(low, high, edges) * lengths
            bare = bare - on_seat
            total += conductances.get(path, 0.0) * on_seat * girth
    return total + conductances.get(Path.SCREW_FILM, 0.0) * np.clip(bare, 0, None) * girth


def _segment_edges(rig: Rig, segments: int) -> FloatArray:
    """Boundaries at the ends of the swept zone, the rest as even as can be, (segments + 1,) [m]."""
    refuse_unless(segments >= 3, f"{segments} segments are too few", "segments", "write at least 3")
    ends = _swept(rig, rig.travel)
    if len(ends) == 2:
        return np.linspace(0.0, rig.length, segments + 1)
    spans = np.diff(ends)
    counts = np.maximum(np.round(segments * spans / rig.length).astype(int), 1)
    while counts.sum() < segments:
        counts[np.argmax(spans / counts)] += 1
    while counts.sum() > segments:
        counts[np.argmin(np.where(counts > 1, spans / counts, np.inf))] -= 1
    pieces = [np.linspace(a, b, count, endpoint=False) for a, b, count in zip(ends[:-1], ends[1:], counts, strict=True)]
    return np.concatenate([*pieces, [rig.length]])


def _swept(rig: Rig, travel: Travel) -> FloatArray:
    half = rig.nut.length / 2
    inner = [x for x in (travel.low - half, travel.high + half) if 1e-9 < x < rig.length - 1e-9]
    return np.array([0.0, *inner, rig.length])
