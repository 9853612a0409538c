"""A cycling axis that warms up for hours, logged once a second: motion and heat of one machine, effects planted.

It shares no code with the package. Numbers are those of plants/warm_axis.toml, laws written out again: friction of nut
(slipping balls), bearings and guide, Walther's oil, a nut whose preload follows its temperature over the shaft's, and
the finite volumes of `tests/generator/thermal.py` on this axis. The motion is trapezoidal, followed in closed form.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from tests.generator.thermal import Mesh, _advance, mean_overlap, mesh
from tests.generator.thermal_effects import CURVES, Planted

RADIUS, LENGTH, NUT_RADIUS, NUT_LENGTH = 0.01675, 0.900, 0.032, 0.130
LOW, HIGH, AT_ZERO = 0.250, 0.650, 0.250
CONDUCTIVITY, CAPACITY, EXPANSION, CONTACT, AMBIENT = 45.0, 3.7e6, 11.7e-6, 1200.0, 20.0
SEATS = (0.040, 0.020)
SHAFT_CELLS, SHAFT_RINGS, NUT_CELLS, NUT_RINGS = 225, 6, 13, 8
R = 0.010 / (2 * math.pi)
PRELOAD, PITCH = 2200.0, 0.0335
BODIES = {"table": ("nut", 115e3, 2.5, 8.0), "motor": ("front", 4.2e3, 0.25, 3.5),
          "front_housing": ("front", 3.2e3, 6.0, 1.5), "rear_housing": ("rear", 1.4e3, 2.5, 0.8)}  # fmt: skip
"""Name to port, capacity [J/K], conductance to the port and to the air [W/K]."""

STROKE, ACCELERATION = 0.4, 3.0
INERTIA = 3.1e-3 + 0.5e-3 + 7.9e-4
"""Of rotor, coupling and screw [kg m²]."""

PROGRAMME = ((9.0, 2700), (0.0, 900), (4.0, 1800), (9.0, 2700), (4.0, 1500), (9.0, 1200))
"""Speeds [m/min] and for how long [s]; the last quarter judges."""

DWELL = 1.31
NOISE = {"motor_torque": 0.01, "table_position": 0.1e-6, "temperature": 0.03}
INNER = 20
"""Explicit steps of the volumes in a second: the stiffest cell allows 0.07 s."""


@dataclass(frozen=True)
class Truth:
    """What is planted, as `Planted`; beside the thermal effects `lead_error_cumulative` and `viscous_factor`."""

    planted: Planted = field(default_factory=dict)

    def of(self, name: str, key: str, default: float = 0.0) -> float:
        """A planted value."""
        return float(self.planted.get(name, {}).get(key, default))


def viscosity(celsius: float, at_40: float, at_100: float) -> float:
    """Walther's law through two points [mm²/s]."""

    def double(nu: float) -> float:
        return math.log10(math.log10(nu + 0.7))

    slope = (double(at_40) - double(at_100)) / math.log10(373.15 / 313.15)
    return 10 ** (10 ** (double(at_40) - slope * math.log10((celsius + 273.15) / 313.15))) - 0.7


def oil_share(celsius: float, at_40: float, at_100: float) -> float:
    """Viscous torque over that at 20 degC."""
    return (viscosity(celsius, at_40, at_100) / viscosity(20.0, at_40, at_100)) ** (2 / 3)


def guide(v: float) -> float:
    """Force of the guide [N]."""
    return 55.0 * math.copysign(1, v) + 180.0 * v


def nut_torque(ω: float, force: float, preload: float, oil: float) -> float:
    """Friction torque of the nut [N m], positive while ω is."""
    tangent, f, s = 2 * R / PITCH, 0.025, math.sin(math.pi / 4)
    root = math.sqrt(math.cos(math.pi / 4) ** 2 + tangent**2)
    cos2 = 1 / (1 + tangent**2)
    a, b = cos2 * s * root, cos2 * root**2
    ahead, back = f / (a - f * b), f / (a + f * b)
    # half the load on each contact while both bear: F = F_A - F_B with F^(2/3) linear in the deflection
    d = 2 * math.sqrt(2) * math.sin(math.asin(force / (2 * math.sqrt(2) * preload)) / 3)
    total = math.sqrt(4 - d * d)
    first, second = preload * ((total + d) / 2) ** 3, preload * ((total - d) / 2) ** 3
    if ω < 0:
        first, second = second, first
    return math.copysign(R * (first * ahead + second * back) + 8.23e-3 * oil * abs(ω) ** (2 / 3), ω)


def bearing_torque(ω: float, oil: float) -> float:
    """Friction torque of both bearings [N m]."""
    return math.copysign(0.12 + 2.70e-3 * oil * abs(ω) ** (2 / 3), ω)


@dataclass(frozen=True)
class Cycle:
    """To and fro at a speed: period [s] and, at a phase, position [m], speed, acceleration."""

    speed: float

    @property
    def leg(self) -> float:
        """Duration of a stroke [s]."""
        return STROKE / self.speed + self.speed / ACCELERATION

    @property
    def period(self) -> float:
        """Of both strokes with their dwells [s]."""
        return 2 * (self.leg + DWELL)

    def at(self, time: float) -> tuple[float, float, float]:
        """Position, velocity, acceleration of the table."""
        phase = time % self.period
        back = phase >= self.period / 2
        t = phase - self.period / 2 * back
        ramp = self.speed / ACCELERATION
        if t < ramp:
            x, v, a = ACCELERATION * t * t / 2, ACCELERATION * t, ACCELERATION
        elif t < self.leg - ramp:
            x, v, a = self.speed * (t - ramp / 2), self.speed, 0.0
        elif t < self.leg:
            rest = self.leg - t
            x, v, a = STROKE - ACCELERATION * rest * rest / 2, ACCELERATION * rest, -ACCELERATION
        else:
            x, v, a = STROKE, 0.0, 0.0
        return (STROKE - x, -v, -a) if back else (x, v, a)


def simulate(truth: Truth, seed: int) -> dict[str, np.ndarray]:
    """Channels of the log with noise, SI and degC, once a second."""
    random = np.random.default_rng(seed)
    shaft_mesh, nut_mesh = (
        mesh(0, RADIUS, SHAFT_RINGS, LENGTH, SHAFT_CELLS, CONDUCTIVITY),
        mesh(RADIUS, NUT_RADIUS, NUT_RINGS, NUT_LENGTH, NUT_CELLS, CONDUCTIVITY),
    )
    nut_edges = np.linspace(-NUT_LENGTH / 2, NUT_LENGTH / 2, NUT_CELLS + 1)
    world = _World(
        truth, shaft_mesh, nut_mesh, mean_overlap(np.linspace(0, LENGTH, SHAFT_CELLS + 1), nut_edges, (LOW, HIGH))
    )
    rows: list[list[float]] = []
    begun = 0.0
    for metres, seconds in PROGRAMME:
        cycle = Cycle(metres / 60) if metres else None
        whole = math.floor(seconds / cycle.period) * cycle.period if cycle else seconds  # it ends where it began
        for k in range(int(seconds)):
            inside = cycle is not None and k + 1 <= whole
            x, v, a = cycle.at(k) if cycle is not None and k < whole else (0.0, 0.0, 0.0)
            rows.append(world.row(begun + k, x, v, a))
            world.second(cycle if inside else None, float(k), begun + k)
        begun += seconds
    found = dict(zip(("time", "motor_angle", "table_position", "motor_torque", "nut_temperature",
                      "front_bearing_temperature"), np.array(rows).T, strict=True))  # fmt: skip
    for name, values in found.items():
        noise = NOISE.get(name, NOISE["temperature"] if name.endswith("temperature") else 0.0)
        found[name] = values + noise * random.standard_normal(len(values))
    found["ambient_temperature"] = np.full(len(rows), AMBIENT)
    return found


class _World:
    """Temperatures of all volumes and bodies, and what the drive is at them."""

    def __init__(self, truth: Truth, shaft: Mesh, nut: Mesh, overlap: np.ndarray) -> None:
        self.truth, self.shaft_mesh, self.nut_mesh, self.overlap = truth, shaft, nut, overlap
        self.shaft, self.nut = np.zeros((SHAFT_RINGS, SHAFT_CELLS)), np.zeros((NUT_RINGS, NUT_CELLS))
        self.bodies = dict.fromkeys(BODIES, 0.0)
        self.covered = overlap.sum(axis=0) / overlap.sum()
        self.ends = [round(length / shaft.spacing) for length in SEATS]
        self.fluxes = [0.0, 0.0]

    def rises(self) -> tuple[float, float, float, float]:
        """Nut's outside, shaft's skin on the travel, front and rear seat, all at the surface [K]."""
        mean = (self.shaft_mesh.volume @ self.shaft) / self.shaft_mesh.volume.sum()
        edges = (np.arange(SHAFT_CELLS) + 0.5) * self.shaft_mesh.spacing
        under = float(mean[(edges > LOW) & (edges < HIGH)].mean())
        skin = self.shaft[-1]
        seats = skin[: self.ends[0]].mean(), skin[-self.ends[1] :].mean()
        front, rear = (
            float(seat) + flux * self.shaft_mesh.half / CONDUCTIVITY
            for seat, flux in zip(seats, self.fluxes, strict=True)
        )
        return float(self.nut[-1].mean()) + self.out * self.nut_mesh.half / CONDUCTIVITY, under, front, rear

    out = 0.0
    """Flux into the outside of the nut [W/m²]."""

    def drive(self) -> tuple[float, float, float]:
        """Preload [N], shares of the viscous torques of nut and bearings."""
        nut, shaft, front, rear = self.rises()
        gained = 280e6 * EXPANSION * (nut - shaft) * (0.070 / 2 - PITCH / 2)
        share = (1 + gained / PRELOAD) * (1 + self.truth.of("preload_growth", "coefficient") * nut)
        oil = oil_share(AMBIENT + nut, 100.0, 11.2) * math.exp(
            -self.truth.of("viscosity_temperature", "coefficient") * nut
        )
        oil *= self.truth.of("friction_deviation", "viscous_factor", 1.0)
        bearings = oil_share(AMBIENT + 0.75 * front + 0.25 * rear, 32.0, 5.3)
        return PRELOAD * share, oil, bearings * self.truth.of("friction_deviation", "viscous_factor", 1.0)

    def row(self, time: float, x: float, v: float, a: float) -> list[float]:
        """Time, motor angle, table position, torque, temperatures at this instant, without noise."""
        preload, oil, bearings = self.drive()
        ω = v / R
        force = (guide(v) if v else 0.0) + 250.0 * a
        friction = nut_torque(ω, force, preload, oil) + bearing_torque(ω, bearings) if v else 0.0
        torque = R * force + friction + INERTIA * a / R
        angle = x / R
        # springs with the nut in the middle of its stroke, as the file's structure has them
        axial = 1 / (1 / 600e6 + 1 / 560e6 + (AT_ZERO + STROKE / 2) / (206e9 * math.pi / 4 * 0.0284**2))
        screw = 79.3e9 * math.pi / 32 * 0.0284**4 / (AT_ZERO + STROKE / 2 + 0.08)
        twist = (R * force + friction) * (1 / 45e3 + 1 / 21e3 + 1 / screw)
        mean = (self.shaft_mesh.volume @ self.shaft) / self.shaft_mesh.volume.sum()
        grown = np.concatenate([[0.0], np.cumsum(mean) * self.shaft_mesh.spacing * EXPANSION])
        growth = float(np.interp(AT_ZERO + x, np.linspace(0, LENGTH, SHAFT_CELLS + 1), grown))
        slope = self.truth.of("lead_error_cumulative", "slope")
        table = R * (angle - twist) - force / axial + growth + slope * x
        nut, _, front, _ = self.rises()
        return [time, angle, table, torque, AMBIENT + nut, AMBIENT + front]

    def second(self, cycle: Cycle | None, phase: float, time: float) -> None:
        """A second: heats of the motion within it, then the volumes."""
        heat = {"nut": 0.0, "front": 0.0, "rear": 0.0, "table": 0.0, "motor": 0.0}
        parts = 25
        films = [0.0, 0.0]
        preload, oil, bearings = self.drive()
        for i in range(parts):
            _, v, a = cycle.at(phase + (i + 0.5) / parts) if cycle is not None else (0.0, 0.0, 0.0)
            ω, force = v / R, (guide(v) if v else 0.0) + 250.0 * a
            rpm = abs(ω) * 30 / math.pi
            films[0] += max(14.1 * (rpm / 250) ** (2 / 3), 5.0) / parts
            films[1] += (5.0**4 + 5.0**4 * (rpm / 250) ** 2) ** 0.25 / parts
            if not v:
                continue
            at_nut, at_ends = nut_torque(ω, force, preload, oil), bearing_torque(ω, bearings)
            heat["nut"] += ω * at_nut / parts
            heat["front"] += 0.75 * ω * at_ends / parts
            heat["rear"] += 0.25 * ω * at_ends / parts
            heat["table"] += v * guide(v) / parts
            torque = R * force + at_nut + at_ends + INERTIA * a / R
            heat["motor"] += torque**2 / 1.4**2 / parts
            if "motor_heat" in self.truth.planted:
                power, at, share = (self.truth.of("motor_heat", key) for key in ("power", "at_speed", "share_at_rest"))
                heat["front"] += power * (share + (1 - share) * abs(ω) / at) / parts
        self._conduct(heat, films, time)

    def _conduct(self, heat: dict[str, float], films: list[float], time: float) -> None:
        mesh, nut = self.shaft_mesh, self.nut_mesh
        surface = dict(zip(("nut", "shaft", "front", "rear"), self.rises(), strict=True))
        into = {"nut": 0.0, "front": heat["front"], "rear": heat["rear"]}
        for name, (port, capacity, conductance, to_air) in BODIES.items():
            flow = conductance * (surface[port] - self.bodies[name])
            into[port] -= flow
            self.bodies[name] += (flow - to_air * self.bodies[name] + heat.get(name, 0.0)) / capacity
        drift = self.truth.planted.get("ambient_drift")
        air = float(drift["amplitude"]) * CURVES[drift["curve"]](time, float(drift["period"])) if drift else 0.0
        # below its skin the shaft conducts the mean of what the passing nut gives
        share = self.overlap.sum(axis=0) / mesh.spacing
        link = 2 * math.pi * RADIUS * self.overlap * CONTACT / (1 + CONTACT * share * mesh.half / CONDUCTIVITY)
        to_bore = 2 * math.pi * RADIUS * nut.spacing * CONDUCTIVITY / nut.half
        faced = self.overlap > 0
        first, last = faced.argmax(axis=1), SHAFT_CELLS - faced[:, ::-1].argmax(axis=1)
        bare = (
            2 * math.pi * RADIUS * (mesh.spacing - self.overlap.sum(axis=0)) / (1 / films[0] + mesh.half / CONDUCTIVITY)
        )
        on_nut = 2 * math.pi * NUT_RADIUS * nut.spacing / (1 / films[1] + nut.half / CONDUCTIVITY)
        # seats of two lengths: what differs of the rear one is spread by hand
        seats, rear_seats = self.ends
        self.shaft[-1, -rear_seats:] += into["rear"] / rear_seats / (CAPACITY * mesh.volume[-1])
        self.nut[-1] += into["nut"] / NUT_CELLS / (CAPACITY * nut.volume[-1])
        _advance(
            self.shaft, self.nut, 0.0, INNER, 1.0 / INNER, CAPACITY, mesh.along, mesh.across, mesh.volume,
            nut.along, nut.across, nut.volume, link, link.sum(axis=1), to_bore, first, last, bare, on_nut,
            heat["nut"], into["front"], 0.0, seats, air, 0.0, 0.0, 0.0,
        )  # fmt: skip
        girth = 2 * math.pi * RADIUS
        # thermometers and oil feel the mean of some strokes, not each of them
        now = into["front"] / (girth * SEATS[0]), into["rear"] / (girth * SEATS[1])
        self.fluxes = [old + (new - old) / 20.0 for old, new in zip(self.fluxes, now, strict=True)]
        self.out = (into["nut"] - films[1] * 2 * math.pi * NUT_RADIUS * NUT_LENGTH * (surface["nut"] - air)) / (
            2 * math.pi * NUT_RADIUS * NUT_LENGTH
        )


def write_csv(channels: dict[str, np.ndarray], path: Path) -> None:
    """Write a log: s, rad, m, N m, degC."""
    units = {"time": "s", "motor_angle": "rad", "table_position": "m", "motor_torque": "N m"}
    heads = [f"{name} [{units.get(name, 'degC')}]" for name in channels]
    formats = ["%.9f" if name in ("motor_angle", "table_position") else "%.4f" for name in channels]
    np.savetxt(
        path, np.column_stack(list(channels.values())), fmt=formats, delimiter=",", header=",".join(heads), comments=""
    )
