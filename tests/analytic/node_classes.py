"""The paper's 17 node classes and how much of its own temperature each keeps in a step (equations (13), (14)).

The scheme itself is assembled as finite volumes (`grid`, `full_model`); the classes serve to compare it, node by node,
with what is printed, and to say which class limits the step. 4 to 8 and 14 are elided in the paper and derived from
their neighbours; 17 = 1, 15 = 2, 14 = 5. No class describes the shaft's free end: 0 here.

| symbol | meaning | unit |
|---|---|---|
| n | r/Δr, the radial number of the node | 1 |
| k3..k6 | radial difference coefficients | 1 |
| f_r, f_z | α/Δr², α/Δz²: Fourier numbers over Δt | 1/s |
| b_r, b_z | h Δr/λ, h Δz/λ: Biot numbers | 1 |
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from feeddrive.thermal.full.full_model import Discretisation
from feeddrive.thermal.full.grid import Cylinder
from feeddrive.thermal.reduced.parametric_model import Path
from feeddrive.typing import FloatArray, IntegerArray


def node_classes(parts: Discretisation, place: float) -> IntegerArray:
    """Class of each node with the nut's centre at `place` [m], (nodes,); a bearing where a seat has its own film."""
    rig, shaft, nut = parts.rig, parts.shaft, parts.nut
    on_shaft = _body(shaft, surface=3, inside=2, axis=1)
    middle = (shaft.edges[1:] + shaft.edges[:-1]) / 2
    on_shaft[-1, np.abs(middle - place) < rig.nut.length / 2] = 9
    on_shaft[:, [0, -1]] = 0
    for seat, inside, end in (
        (rig.front, middle < rig.front.length, 0),
        (rig.rear, middle > rig.length - rig.rear.length, -1),
    ):
        if seat.film is not None:
            on_shaft[:, inside] = np.array([17, *[15] * (len(shaft.radii) - 2), 13])[:, None]
            on_shaft[:, end] = np.array([16, *[14] * (len(shaft.radii) - 2), 12])
    on_nut = _body(nut, surface=3, inside=2, axis=8)
    on_nut[:, 0] = np.array([6, *[4] * (len(nut.radii) - 2), 10])
    on_nut[:, -1] = np.array([7, *[5] * (len(nut.radii) - 2), 11])
    return np.concatenate([on_shaft.ravel(), on_nut.ravel()])


def printed_rate(kind: int, n: float, cylinder: Cylinder, film: float, contact: float) -> float:
    """What a node gives away per second; it keeps 1 - Δt times that, which (14) wants non-negative [1/s].

    Args:
        kind: class, 1 to 17.
        n: r/Δr.
        cylinder: body that it lies in.
        film: h of its surface [W/(m² K)].
        contact: C between nut and shaft [W/(m² K)].
    """
    Δr, Δz = float(cylinder.radii[1] - cylinder.radii[0]), cylinder.spacing
    α, λ = cylinder.steel.diffusivity, cylinder.steel.conductivity
    f_r, f_z, b_r, b_z = α / Δr**2, α / Δz**2, film * Δr / λ, film * Δz / λ
    k3, k4 = 4 * (2 * n - 1) / (4 * n - 1), 8 * n / (4 * n - 1)
    k5, k6 = 4 * (2 * n + 1) / (4 * n + 1), 8 * n / (4 * n + 1)
    crossing = contact / (cylinder.steel.heat_capacity * Δr)
    end = f_z + f_z * b_z
    if kind in (1, 17):
        return 2 * f_z + 4 * f_r
    if kind in (2, 15):
        return 2 * f_z + 2 * f_r
    if kind in (3, 13):
        return 2 * f_z + f_r * k3 + f_r * b_r * k4
    if kind in (4, 5, 14):
        return end + 2 * f_r
    if kind in (6, 7):
        return end + f_r * k5 + crossing * k6
    if kind == 8:
        return 2 * f_z + f_r * k5 + crossing * k6
    if kind == 9:
        return 2 * f_z + f_r * k3 + crossing * k4
    if kind in (10, 11, 12):
        return end + f_r * k3 + f_r * b_r * k4
    if kind == 16:
        return end + 4 * f_r
    raise ValueError(f"no class {kind}")


def stability_by_class(parts: Discretisation, place: float, conductances: Mapping[Path, float]) -> dict[int, float]:
    """Longest stable step of each class that occurs, from the printed conditions [s]."""
    found: dict[int, float] = {}
    for kind, rate in zip(node_classes(parts, place), printed_rates(parts, place, conductances), strict=True):
        if kind:
            found[int(kind)] = min(found.get(int(kind), np.inf), 1 / float(rate))
    return found


def printed_rates(parts: Discretisation, place: float, conductances: Mapping[Path, float]) -> FloatArray:
    """`printed_rate` of each node, (nodes,); NaN for class 0."""
    kinds = node_classes(parts, place)
    rates = np.full(parts.nodes, np.nan)
    for i, kind in enumerate(kinds):
        if kind == 0:
            continue
        in_shaft = i < parts.shaft.nodes
        body = parts.shaft if in_shaft else parts.nut
        radius = body.radii[(i if in_shaft else i - parts.shaft.nodes) // body.axial]
        film = conductances.get(_film_path(parts, i, int(kind)), 0.0)
        n = radius / (body.radii[1] - body.radii[0])
        rates[i] = printed_rate(int(kind), float(n), body, film, conductances.get(Path.CONTACT, 0.0))
    return rates


def _film_path(parts: Discretisation, node: int, kind: int) -> Path:
    if node >= parts.shaft.nodes:
        return Path.NUT_FILM
    if kind in (12, 13, 14, 16):
        return Path.FRONT_FILM if node % parts.shaft.axial < parts.shaft.axial // 2 else Path.REAR_FILM
    return Path.SCREW_FILM


def _body(cylinder: Cylinder, surface: int, inside: int, axis: int) -> IntegerArray:
    kinds = np.full((len(cylinder.radii), cylinder.axial), inside, dtype=np.int64)
    kinds[-1], kinds[0] = surface, axis
    return kinds
