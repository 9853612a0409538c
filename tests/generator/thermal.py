"""An independent warm-up simulator: explicit finite volumes of screw and averaged nut, with planted thermal effects.

It shares no code with the package: cell-centred volumes over the radius (the package's lie on the vertices), another
axial grid, explicit Euler steps. Laws and numbers are those of the README of the warm-up data, written out again here.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path

import numba
import numpy as np

from tests.generator.thermal_effects import ThermalTruth

RADIUS, LENGTH = 0.008, 0.5
NUT_RADIUS, NUT_LENGTH, LOW, HIGH = 0.020, 0.100, 0.200, 0.300
CONDUCTIVITY, HEAT_CAPACITY, EXPANSION = 50.0, 3.926e6, 11.7e-6
CONTACT, AMBIENT, SEAT = 1250.0, 23.0, 0.010
POSITIONS = (0.200, 0.250, 0.300)
STEP, INNER = 30.0, 750
"""Length of a row [s], and explicit steps in it (0.04 s: the stiffest cell allows 0.05 s)."""

SHAFT_CELLS, SHAFT_RINGS, NUT_CELLS, NUT_RINGS = 250, 4, 16, 5
NOISE_KELVIN, NOISE_METRE = 0.03, 0.15e-6
RESOLUTION_KELVIN, RESOLUTION_METRE = 0.01, 0.01e-6

TRAIN = ((500, 180), (0, 120), (750, 180), (250, 60), (0, 180))
VALIDATE = ((750, 120), (250, 90), (0, 60), (600, 210), (0, 120))
"""Speeds [rev/min] and their numbers of rows."""


@dataclass(frozen=True)
class Mesh:
    """Volumes, areas and links; index 0 is the axis or the bore.

    Attributes:
        along, across: conductances between neighbours along the axis, over the radius [W/K], per ring.
        volume: of a cell of each ring [m³].
        spacing: length of a cell [m].
        half: depth at which the mean of the ring at a surface is found [m].
    """

    along: np.ndarray
    across: np.ndarray
    volume: np.ndarray
    spacing: float
    half: float


def mesh(inner: float, outer: float, rings: int, length: float, cells: int, conductivity: float) -> Mesh:
    """Volumes and links of a shaft or nut [m], [W/(m K)]."""
    faces = np.linspace(inner, outer, rings + 1)
    spacing, width = length / cells, (outer - inner) / rings
    area = math.pi * np.diff(faces**2)
    across = conductivity * 2 * math.pi * faces[1:-1] * spacing / width
    # A shaft that warms evenly has a parabola over its radius: there the mean of the last ring lies this deep.
    half = (outer**2 - faces[-2] ** 2) / (4 * outer) if inner == 0 else width / 2
    return Mesh(conductivity * area / spacing, across, area * spacing, spacing, half)


def mean_overlap(shaft: np.ndarray, nut: np.ndarray, travel: tuple[float, float], centres: int = 4000) -> np.ndarray:
    """Mean length on which nut cells face shaft cells, the centre uniform on its travel, (nut, shaft) [m].

    Args:
        shaft, nut: edges of the cells, those of the nut about its centre [m].
        travel: lowest and highest place of the centre [m].
        centres: places that are averaged.
    """
    found = np.zeros((len(nut) - 1, len(shaft) - 1))
    for centre in travel[0] + (travel[1] - travel[0]) * (np.arange(centres) + 0.5) / centres:
        low = np.maximum(shaft[None, :-1], centre + nut[:-1, None])
        high = np.minimum(shaft[None, 1:], centre + nut[1:, None])
        found += np.clip(high - low, 0, None)
    return found / centres


def _overlap() -> np.ndarray:
    nut = np.linspace(-NUT_LENGTH / 2, NUT_LENGTH / 2, NUT_CELLS + 1)
    return mean_overlap(np.linspace(0, LENGTH, SHAFT_CELLS + 1), nut, (LOW, HIGH))


@numba.njit(cache=True)
def _advance(
    shaft, nut, sink, steps, dt, capacity, s_along, s_across, s_volume, n_along, n_across, n_volume,
    link, linked, to_bore, first, last, bare_film, nut_film, nut_heat, front_heat, rear_heat, seats, ambient,
    coolant, sink_link, sink_capacity,
):  # fmt: skip
    """March `steps` explicit steps; temperatures are rises over the start; changes shaft and nut, returns the sink."""
    s_rings, s_cells = shaft.shape
    n_rings, n_cells = nut.shape
    s_flow, n_flow = np.zeros_like(shaft), np.zeros_like(nut)
    for _ in range(steps):
        s_flow[:], n_flow[:] = 0.0, 0.0
        for r in range(s_rings):
            for j in range(s_cells - 1):
                q = s_along[r] * (shaft[r, j + 1] - shaft[r, j])
                s_flow[r, j] += q
                s_flow[r, j + 1] -= q
        for r in range(s_rings - 1):
            for j in range(s_cells):
                q = s_across[r] * (shaft[r + 1, j] - shaft[r, j])
                s_flow[r, j] += q
                s_flow[r + 1, j] -= q
        for r in range(n_rings):
            for i in range(n_cells - 1):
                q = n_along[r] * (nut[r, i + 1] - nut[r, i])
                n_flow[r, i] += q
                n_flow[r, i + 1] -= q
        for r in range(n_rings - 1):
            for i in range(n_cells):
                q = n_across[r] * (nut[r + 1, i] - nut[r, i])
                n_flow[r, i] += q
                n_flow[r + 1, i] -= q
        for i in range(n_cells):
            # The bore's surface holds no heat: what rubs there goes to the nut's first ring and to the shaft.
            given = nut_heat / n_cells + to_bore * nut[0, i]
            for j in range(first[i], last[i]):
                given += link[i, j] * shaft[s_rings - 1, j]
            surface = given / (to_bore + linked[i])
            n_flow[0, i] += to_bore * (surface - nut[0, i])
            for j in range(first[i], last[i]):
                s_flow[s_rings - 1, j] += link[i, j] * (surface - shaft[s_rings - 1, j])
        mean = 0.0
        for i in range(n_cells):
            mean += nut[n_rings - 1, i] / n_cells
        to_sink = sink_link * (mean - sink)
        for i in range(n_cells):
            n_flow[n_rings - 1, i] += nut_film * (ambient - nut[n_rings - 1, i]) - (coolant * mean + to_sink) / n_cells
        for j in range(s_cells):
            s_flow[s_rings - 1, j] += bare_film[j] * (ambient - shaft[s_rings - 1, j])
        for j in range(seats):
            s_flow[s_rings - 1, j] += front_heat / seats
            s_flow[s_rings - 1, s_cells - 1 - j] += rear_heat / seats
        for r in range(s_rings):
            for j in range(s_cells):
                shaft[r, j] += dt * s_flow[r, j] / (capacity * s_volume[r])
        for r in range(n_rings):
            for i in range(n_cells):
                nut[r, i] += dt * n_flow[r, i] / (capacity * n_volume[r])
        if sink_capacity > 0.0:
            sink += dt * to_sink / sink_capacity
    return sink


@dataclass(frozen=True)
class Rig:
    """The declared rig, its mesh made once."""

    shaft: Mesh = field(default_factory=lambda: mesh(0.0, RADIUS, SHAFT_RINGS, LENGTH, SHAFT_CELLS, CONDUCTIVITY))
    nut: Mesh = field(default_factory=lambda: mesh(RADIUS, NUT_RADIUS, NUT_RINGS, NUT_LENGTH, NUT_CELLS, CONDUCTIVITY))
    overlap: np.ndarray = field(default_factory=_overlap)


def torques(rpm: float) -> tuple[float, float]:
    """Load and viscous torque of the nut [N m]."""
    diameter = 16.75
    load = 4.1364e-4 * 1300**1.33 * diameter * 1e-3 / math.cos(math.radians(5.43))
    return load, 1e-10 * 2 * 2 * 2.5 * (170 * rpm) ** (2 / 3) * diameter**3 if rpm > 0 else 0.0


def films(rpm: float) -> tuple[float, float]:
    """Film coefficients of shaft and nut [W/(m² K)]."""
    return max(0.29033 * rpm ** (2 / 3), 5.0), (4.857**4 + 5.024**4 * (rpm / 250) ** 2) ** 0.25


def simulate(
    schedule: tuple[tuple[float, int], ...], truth: ThermalTruth, rig: Rig | None = None
) -> dict[str, np.ndarray]:
    """Noiseless channels of a run that starts cold: time [s], screw_speed [rev/min], [degC] and [m]."""
    rig = rig or Rig()
    speeds = np.repeat([float(rpm) for rpm, _ in schedule], [count for _, count in schedule])
    shaft, nut, sink = np.zeros((SHAFT_RINGS, SHAFT_CELLS)), np.zeros((NUT_RINGS, NUT_CELLS)), 0.0
    rows = [_row(rig, truth, shaft, nut, 0.0, 0.0)]
    for index, rpm in enumerate(speeds):
        sink, front = _march(rig, truth, shaft, nut, sink, float(rpm), index * STEP)
        rows.append(_row(rig, truth, shaft, nut, (index + 1) * STEP, front))
    values = {name: np.array([row[name] for row in rows]) for name in rows[0]}
    for name, time_constant in truth.lags.items():
        values[name] = _lagged(values[name], time_constant)
    time = STEP * np.arange(1, len(speeds) + 1)
    read = {name: series[1:] for name, series in values.items()}
    return {"time": time, "screw_speed": speeds, "ambient_temperature": np.full(len(speeds), AMBIENT), **read}


def _march(
    rig: Rig, truth: ThermalTruth, shaft: np.ndarray, nut: np.ndarray, sink: float, rpm: float, start: float
) -> tuple[float, float]:
    """One row, in three parts so that what follows the nut's temperature follows closely; the sink and the end heat."""
    ω, (load, oil) = rpm * math.pi / 30, torques(rpm)
    on_screw, on_nut = films(rpm)
    parts, seats = 3, round(SEAT / rig.shaft.spacing)
    bare = 2 * math.pi * RADIUS * (rig.shaft.spacing - rig.overlap.sum(axis=0))
    contact = truth.contact_factor * CONTACT
    link = 2 * math.pi * RADIUS * rig.overlap / (1 / contact + rig.shaft.half / CONDUCTIVITY)
    to_bore = 2 * math.pi * RADIUS * rig.nut.spacing * CONDUCTIVITY / rig.nut.half
    faced = rig.overlap > 0
    first, last = faced.argmax(axis=1), SHAFT_CELLS - faced[:, ::-1].argmax(axis=1)
    film = truth.screw_film * on_screw
    bare_film = bare / (1 / film + rig.shaft.half / CONDUCTIVITY)
    nut_area = 2 * math.pi * NUT_RADIUS * rig.nut.spacing
    nut_film = nut_area / (1 / (truth.nut_film * on_nut) + rig.nut.half / CONDUCTIVITY)
    front, rear = truth.end_heats(rpm)
    for part in range(parts):
        middle = start + STEP * (part + 0.5) / parts
        rise = float(nut[-1].mean())
        heat = 0.609 * ω * (load * (1 + truth.preload_growth * rise) + oil * math.exp(-truth.viscosity * rise))
        sink = _advance(
            shaft, nut, sink, INNER // parts, STEP / INNER, HEAT_CAPACITY,
            rig.shaft.along, rig.shaft.across, rig.shaft.volume, rig.nut.along, rig.nut.across, rig.nut.volume,
            link, link.sum(axis=1), to_bore, first, last, bare_film, nut_film, heat, front, rear, seats,
            truth.drift(middle), truth.coolant(middle), truth.sink[0], truth.sink[1],
        )  # fmt: skip
    return sink, front


def _row(
    rig: Rig, truth: ThermalTruth, shaft: np.ndarray, nut: np.ndarray, time: float, front: float
) -> dict[str, float]:
    seats = round(SEAT / rig.shaft.spacing)
    flux = front / (2 * math.pi * RADIUS * SEAT)  # the surface is half a ring outside the last centre
    sections = (rig.shaft.volume @ shaft) / rig.shaft.volume.sum()
    grown = np.concatenate([[0.0], np.cumsum(sections) * rig.shaft.spacing * EXPANSION])
    edges = np.linspace(0, LENGTH, SHAFT_CELLS + 1)
    growth = {
        f"table_growth_{x * 1e3:.0f}mm": float(np.interp(x, edges, grown)) + truth.frame(x, time) for x in POSITIONS
    }
    return {
        "nut_temperature": AMBIENT + float(nut[-1].mean()),
        "front_bearing_temperature": AMBIENT + float(shaft[-1, :seats].mean()) + flux * rig.shaft.half / CONDUCTIVITY,
        **growth,
    }


def _lagged(values: np.ndarray, time_constant: float) -> np.ndarray:
    """First-order lag by fine steps between the rows, the signal straight there."""
    fine, read = 30, [float(values[0])]
    share = 1 - math.exp(-STEP / fine / time_constant)
    state = float(values[0])
    for before, after in pairwise(values):
        for k in range(fine):
            state += share * (before + (after - before) * (k + 0.5) / fine - state)
        read.append(state)
    return np.array(read)


def measured(channels: dict[str, np.ndarray], seed: int) -> dict[str, np.ndarray]:
    """Channels with sensor noise and resolution."""
    random = np.random.default_rng(seed)
    result = {}
    for name, series in channels.items():
        if name.startswith("table_growth"):
            noisy = series + NOISE_METRE * random.standard_normal(len(series))
            series = RESOLUTION_METRE * np.round(noisy / RESOLUTION_METRE)
        elif name in ("nut_temperature", "front_bearing_temperature"):
            noisy = series + NOISE_KELVIN * random.standard_normal(len(series))
            series = RESOLUTION_KELVIN * np.round(noisy / RESOLUTION_KELVIN)
        result[name] = series
    return result


def write_csv(channels: dict[str, np.ndarray], path: Path) -> None:
    """Write channels as the warm-up data have them: s, rev/min, degC, µm."""
    units = {"time": ("s", 1.0, 0), "screw_speed": ("rev/min", 1.0, 2)}
    heads, columns, formats = [], [], []
    for name, series in channels.items():
        unit, factor, digits = units.get(name, ("um", 1e6, 2) if name.startswith("table_growth") else ("degC", 1.0, 2))
        heads.append(f"{name} [{unit}]")
        columns.append(series * factor)
        formats.append(f"%.{digits}f")
    np.savetxt(path, np.column_stack(columns), fmt=formats, delimiter=",", header=",".join(heads), comments="")
