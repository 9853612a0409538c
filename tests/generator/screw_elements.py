"""A drive of parts as finite elements, at rest (matrices) and in motion (recordings): the truth for chains of parts.

It shares no code with feeddrive and reads the numbers of the parts themselves from the plant file. The screw is 60
elements of a bar and a torsion rod with consistent mass, fixed to the screw: the nut travels over them. Between two
nodes it stands on the line between them and on a spring in series, c = s (1 - s) h / R, which is what a rod gives way
there beyond that line, so that the static stiffness is that of the rod at every place. The drag of the screw twists it
there as well: by T s (1 - s) h / GJ, which without it would be missing at every place but the nodes.

    order of the rotations: motor / ratio, hubs and wheels between motor and screw, nodes of the screw

Motion: midpoint rule of fixed step, exact in energy for the linear part; the screw's two chains are tridiagonal, nut
force and frictions (tanh, lubricant) are solved together by Newton at the middle of the step. The motor torque is held
over a sample by a cascade of a position and a velocity controller on the quantised encoder.
"""

from __future__ import annotations

import math
import re
import tomllib
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray
from scipy.linalg import eigh

Array = NDArray[np.float64]

_UNITS = {
    "": 1.0, "mm": 1e-3, "m": 1.0, "N/µm": 1e6, "N m/rad": 1.0, "kg m^2": 1.0, "kg": 1.0, "N": 1.0, "kN": 1e3,
    "GPa": 1e9, "kg/m^3": 1.0, "deg": math.pi / 180, "N m": 1.0, "N s/m": 1.0, "mm/s": 1e-3, "rad/s": 1.0,
    "N m/(rad/s)^(2/3)": 1.0,
}  # fmt: skip
GRAVITY = 9.80665
ELEMENTS = 60


@dataclass(frozen=True)
class Drive:
    """A drive in SI.

    rotor: inertia [kg m^2]. springs: (stiffness [N m/rad], inertia of the hub behind it), at the screw, from motor
    to screw; a stiffness of infinity is rigid. ratio: motor turns per screw turn. length, stub: of the
    screw from the near bearing to its end, and out to the coupling [m]. axial, torsional: rigidity EA, GJ [N, N m^2].
    mass, inertia: per length [kg/m, kg m]. near, far, nut: axial stiffness [N/m]. table: [kg]. first: nut where the
    table is at 0 [m]. fall: acceleration of fall against + [m/s^2]. held: counterbalance, along + [N].
    tau: C = tau K [s].
    """

    lead: float
    rotor: float
    springs: tuple[tuple[float, float], ...]
    ratio: float
    length: float
    stub: float
    axial: float
    torsional: float
    mass: float
    inertia: float
    near: float
    far: float
    nut: float
    table: float
    first: float
    fall: float = 0.0
    held: float = 0.0
    tau: float = 0.0
    elements: int = ELEMENTS

    @property
    def radius(self) -> float:
        """Table travel per screw angle [m/rad]."""
        return self.lead / (2 * math.pi)


def quantity(text: Any) -> float:
    """A value of a plant file in SI, by a table of the units that the shipped machines use."""
    if isinstance(text, dict):
        text = text["value"]
    if isinstance(text, int | float):
        return float(text)
    number, unit = re.fullmatch(r"([-+.\deE]+)\s*(.*)", text).groups()  # type: ignore[union-attr]
    return float(number) * _UNITS[unit]


def drive_of(path: Path) -> Drive:
    """The drive of a plant file that describes a machine by its parts."""
    entries = tomllib.loads(path.read_text(encoding="utf-8"))
    screw, motor, nut, table = (entries[name] for name in ("ball_screw", "motor", "nut", "table"))
    coupling, belt = entries.get("coupling"), entries.get("belt") or entries.get("gear")
    ratio = quantity(belt["ratio"]) if belt else 1.0
    hub = 0.5 * quantity(coupling.get("inertia", 0.0)) if coupling else 0.0
    shaft = quantity(motor["shaft_stiffness"]) * ratio**2 if "shaft_stiffness" in motor else math.inf
    springs = [(shaft, quantity(belt.get("motor_wheel_inertia", 0.0)) * ratio**2 if belt else hub)]
    if belt:
        springs.append((quantity(belt["torsional_stiffness"]), quantity(belt.get("screw_wheel_inertia", 0.0)) + hub))
    if coupling:
        springs.append((quantity(coupling["torsional_stiffness"]), hub))
    diameter = quantity(screw["diameter"])
    root = quantity(screw.get("root_diameter", screw["diameter"]))
    young, shear = quantity(screw.get("young", 206e9)), quantity(screw.get("shear", 79.3e9))
    density = quantity(screw.get("density", 7850.0))
    if "catalogue_stiffness" in nut:
        keys = ("catalogue_stiffness", "catalogue_preload", "preload", "accuracy_factor")
        stated, at, preload, factor = (quantity(nut[key]) for key in keys)
        stiffness = factor * stated * (preload / at) ** (1 / 3)
    else:
        stiffness = quantity(nut["axial_stiffness"])
    near = quantity(entries["bearing"]["near"]["axial_stiffness"])
    far = quantity(entries["bearing"]["far"]["axial_stiffness"]) if "far" in entries["bearing"] else 0.0
    area = math.pi * diameter**2 / 4
    inclined = quantity(table.get("inclination", 0.0))
    drive = Drive(
        lead=quantity(screw["lead"]),
        rotor=quantity(motor["rotor_inertia"]),
        springs=tuple(springs),
        ratio=ratio,
        length=quantity(screw["length"]),
        stub=quantity(screw.get("stub", 0.0)),
        axial=young * math.pi * root**2 / 4,
        torsional=shear * math.pi * root**4 / 32,
        mass=density * area,
        inertia=density * math.pi * diameter**4 / 32,
        near=near,
        far=far if entries["support"]["kind"] == "fixed-fixed" else 0.0,
        nut=stiffness,
        table=quantity(table["mass"]),
        first=quantity(table.get("first_nut_position", 0.0)),
        fall=GRAVITY * math.sin(inclined),
        held=math.copysign(quantity(table.get("counterbalance", 0.0)), inclined),
    )
    ends = table["stroke"]["value"] if isinstance(table["stroke"], dict) else table["stroke"]
    low, high = (quantity(end) for end in ends)
    frequency = frequencies(drive, 0.5 * (low + high), held=False, count=1)[0]
    return replace(drive, tau=quantity(entries["damping"]["ratio"]) / (math.pi * frequency))


@dataclass(frozen=True)
class Chains:
    """The drive without nut and table: tridiagonal chains as (diagonal, off-diagonal) of M and K, places of nodes."""

    places: Array
    first_node: int
    turning: tuple[Array, Array, Array, Array]
    along: tuple[Array, Array, Array, Array]


def chains(drive: Drive) -> Chains:
    """The two chains of the screw."""
    whole = drive.stub + drive.length
    near = max(1, round(drive.elements * drive.stub / whole)) if drive.stub else 0
    out = np.linspace(-drive.stub, 0.0, near + 1)[:-1] if near else np.zeros(0)
    z = np.concatenate([out, np.linspace(0.0, drive.length, drive.elements + 1)])
    before = [drive.rotor * drive.ratio**2]
    between: list[float] = []
    for stiffness, inertia in drive.springs:
        if math.isinf(stiffness):
            before[-1] += inertia
        else:
            before.append(inertia)
            between.append(stiffness)
    start = len(before) - 1
    count = start + z.size
    m, mo, k, ko = np.zeros(count), np.zeros(count - 1), np.zeros(count), np.zeros(count - 1)
    for i, inertia in enumerate(before):
        m[i] += inertia
    for i, stiffness in enumerate(between):
        k[i] += stiffness
        k[i + 1] += stiffness
        ko[i] -= stiffness
    a, ao, s, so = np.zeros(z.size), np.zeros(z.size - 1), np.zeros(z.size), np.zeros(z.size - 1)
    for i, h in enumerate(np.diff(z)):
        for one, off, at, value in ((m, mo, start + i, drive.inertia * h), (a, ao, i, drive.mass * h)):
            one[at] += value / 3
            one[at + 1] += value / 3
            off[at] += value / 6
        for one, off, at, value in ((k, ko, start + i, drive.torsional / h), (s, so, i, drive.axial / h)):
            one[at] += value
            one[at + 1] += value
            off[at] -= value
    s[near] += drive.near
    s[-1] += drive.far
    return Chains(z, start, (m, mo, k, ko), (a, ao, s, so))


def matrices(drive: Drive, position: float) -> tuple[Array, Array]:
    """M and K of rotations, axial nodes and table, with the table at `position` [m]."""
    made = chains(drive)
    (m, mo, k, ko), (a, ao, s, so) = made.turning, made.along
    size = m.size + a.size + 1
    M, K = np.zeros((size, size)), np.zeros((size, size))
    for matrix, diagonal, off, at in ((M, m, mo, 0), (K, k, ko, 0), (M, a, ao, m.size), (K, s, so, m.size)):
        span = np.arange(at, at + diagonal.size)
        matrix[span, span] = diagonal
        matrix[span[:-1], span[1:]] = matrix[span[1:], span[:-1]] = off
    M[-1, -1] = drive.table
    node, share, soft = at_nut(made.places, drive.first + position, drive.axial, drive.torsional, drive.radius)
    row = np.zeros(size)
    for i, weight in ((node, 1 - share), (node + 1, share)):
        row[made.first_node + i] = drive.radius * weight
        row[m.size + i] = weight
    row[-1] = -1.0
    K += drive.nut / (1 + drive.nut * soft) * np.outer(row, row)
    return M, K


def frequencies(drive: Drive, position: float, held: bool = True, count: int = 3) -> Array:
    """The lowest natural frequencies, motor held ideally or free, without the motion of the whole axis [Hz]."""
    M, K = matrices(drive, position)
    first = 1 if held else 0
    squared = eigh(K[first:, first:], M[first:, first:], eigvals_only=True)
    return np.asarray(np.sqrt(np.abs(squared[1 - first : 1 - first + count])) / (2 * math.pi))


def motor_response(drive: Drive, position: float, frequency: Array) -> Array:
    """Motor speed over motor torque without friction, (rad/s)/(N m), complex, shape (n,)."""
    M, K = matrices(drive, position)
    load = np.zeros(len(M))
    load[0] = drive.ratio**2  # motor angle / ratio under torque * ratio
    found = []
    for f in frequency:
        s = 2j * math.pi * f
        found.append(s * np.linalg.solve(M * s**2 + (1 + drive.tau * s) * K, load)[0])
    return np.array(found)


@njit(cache=True)
def at_nut(z, place, axial, torsional, radius):  # type: ignore[no-untyped-def]
    """Element of the nut, share of its length, and what the rods give way beyond the line there [m/N]."""
    node = min(max(np.searchsorted(z, place) - 1, 0), z.size - 2)
    h = z[node + 1] - z[node]
    share = (place - z[node]) / h
    return node, share, share * (1 - share) * h * (1 / axial + radius * radius / torsional)


@dataclass(frozen=True)
class Friction:
    """Friction of a drive in SI, and what is planted beside it.

    table: Coulomb level, smoothing velocity, viscous, film force, film exponent. screw: smoothing speed, viscous.
    level: rows of transmitted force [N], Coulomb torque of the screw forward and backward [N m].
    force: that resists + motion.
    """

    table: tuple[float, float, float, float, float]
    screw: tuple[float, float]
    level: Array
    force: float = 0.0
    stribeck: tuple[float, float] = (0.0, 1.0)
    bump: tuple[float, float, float] = (0.0, 0.0, 1.0)


@dataclass(frozen=True)
class Recorder:
    """How a recording is made: controller, sensors, steps a sample."""

    sample_time: float = 5e-4
    steps: int = 20
    position_gain: float = 60.0
    bandwidth: float = 2 * math.pi * 40.0
    integral_time: float = 0.02
    torque_limit: float = 40.0
    encoder: float = 2 * math.pi / 2**22
    torque_noise: float = 0.04
    scale_noise: float = 15e-9
    scale_step: float = 10e-9
    delay: float = 0.0


@dataclass(frozen=True)
class Planted:
    """What the transmission does beside the declared: backlash [m], lead error (amplitude [m], order, phase)."""

    backlash: float = 0.0
    lead_error: tuple[float, float, float] = (0.0, 1.0, 0.0)
    others: dict[str, float] = field(default_factory=dict)


def record(
    drive: Drive, friction: Friction, setpoint: Array, chirp: Array, seed: int,
    planted: Planted | None = None, recorder: Recorder | None = None,
) -> dict[str, Array]:  # fmt: skip
    """A recording of the drive that follows a set-point [m] with a torque [N m] injected; channels in SI."""
    how, what = recorder or Recorder(), planted or Planted()
    made = chains(drive)
    inertia = (float(np.sum(matrices(drive, 0.0)[0][: made.turning[0].size, : made.turning[0].size]))
               + drive.table * drive.radius**2) / drive.ratio**2  # fmt: skip
    gains = np.array([how.position_gain, how.bandwidth * inertia, 1 / how.integral_time, how.torque_limit, how.encoder])
    numbers = np.array([
        drive.radius, drive.ratio, drive.axial, drive.torsional, drive.nut, drive.table, drive.first, drive.tau,
        *friction.table, *friction.screw, friction.force + drive.fall * drive.table - drive.held,
        *friction.stribeck, *friction.bump,
        what.backlash, *what.lead_error,
    ])  # fmt: skip
    torque, angle, position = _run(
        made.places, made.first_node, made.turning, made.along, numbers, friction.level, setpoint, chirp, gains,
        how.sample_time, how.steps,
    )  # fmt: skip
    if not np.all(np.isfinite(position)):
        raise FloatingPointError("the simulated drive diverged")
    random = np.random.default_rng(seed)
    noisy = position + how.scale_noise * random.standard_normal(position.size)
    return {
        "time": np.arange(position.size) * how.sample_time,
        "setpoint": setpoint,
        "motor_torque": torque + how.torque_noise * random.standard_normal(torque.size),
        "motor_angle": np.round(angle / how.encoder) * how.encoder,
        "table_position": np.round(noisy / how.scale_step) * how.scale_step,
    }


@njit(cache=True)
def _factor(diagonal, off):  # type: ignore[no-untyped-def]
    """Factors of a symmetric tridiagonal matrix: L D L'."""
    d, low = diagonal.copy(), off.copy()
    for i in range(off.size):
        low[i] = off[i] / d[i]
        d[i + 1] -= low[i] * off[i]
    return d, low


@njit(cache=True)
def _solve(d, low, b):  # type: ignore[no-untyped-def]
    """Solve L D L' x = b in place."""
    for i in range(low.size):
        b[i + 1] -= low[i] * b[i]
    for i in range(d.size):
        b[i] /= d[i]
    for i in range(low.size - 1, -1, -1):
        b[i] -= low[i] * b[i + 1]


@njit(cache=True)
def _times(diagonal, off, x, out):  # type: ignore[no-untyped-def]
    for i in range(diagonal.size):
        out[i] = diagonal[i] * x[i]
    for i in range(off.size):
        out[i] += off[i] * x[i + 1]
        out[i + 1] += off[i] * x[i]


@njit(cache=True)
def _guide(p, x, v):  # type: ignore[no-untyped-def]
    """Friction of the guide, and its slope with the velocity."""
    coulomb, smooth, viscous, film, exponent = p[8], p[9], p[10], p[11], p[12]
    drop, at, peak, centre, width = p[16], p[17], p[18], p[19], p[20]
    fall = drop * math.exp(-((v / at) ** 2))
    level = coulomb + fall + peak * math.exp(-(((x - centre) / width) ** 2))
    shape = math.tanh(v / smooth)
    squared = v * v + 1e-10
    power = film * squared ** ((exponent - 1) / 2)
    force = level * shape + viscous * v + power * v
    slope = (level * (1 - shape * shape) / smooth + viscous + power * (1 + (exponent - 1) * v * v / squared)
             - 2 * v / (at * at) * fall * shape)  # fmt: skip
    return force, slope


@njit(cache=True)
def _drag(p, level, force, w):  # type: ignore[no-untyped-def]
    """Drag of the screw, and its slope with the speed."""
    smooth, viscous = p[13], p[14]
    torque = np.interp(force, level[:, 0], level[:, 1] if w > 0 else level[:, 2])
    shape = math.tanh(w / smooth)
    power = viscous * (w * w + 1e-4) ** (-1 / 6)
    return torque * shape + power * w, torque * (1 - shape * shape) / smooth + power * (
        1 - w * w / (3 * (w * w + 1e-4))
    )


@njit(cache=True)
def _spring(k, tau, gap, e, rate):  # type: ignore[no-untyped-def]
    """Force of the nut, and its slopes with stretch and rate."""
    if gap == 0.0:
        return k * (e + tau * rate), k, k * tau
    beyond = abs(e) - 0.5 * gap
    if beyond <= 0.0:
        return 0.0, 0.0, 0.0
    return k * (math.copysign(beyond, e) + tau * rate), k, k * tau


@njit(cache=True)
def _run(z, start, turning, along, p, level, setpoint, chirp, gains, sample, steps):  # type: ignore[no-untyped-def]
    m, mo, k, ko = turning
    a, ao, s, so = along
    radius, ratio, axial, torsional, nut, table, first, tau = p[0], p[1], p[2], p[3], p[4], p[5], p[6], p[7]
    gap, amplitude, order, phase = p[21], p[22], p[23], p[24]
    h = sample / steps
    td, tl = _factor(2 / h * m + (tau + h / 2) * k, 2 / h * mo + (tau + h / 2) * ko)
    ad, al = _factor(2 / h * a + (tau + h / 2) * s, 2 / h * ao + (tau + h / 2) * so)
    phi, phi_rate = np.full(m.size, setpoint[0] / radius), np.zeros(m.size)
    u, u_rate = np.zeros(a.size), np.zeros(a.size)
    x, v = setpoint[0] + amplitude * math.sin(order * phi[0] + phase), 0.0
    turned, moved, scratch = np.zeros(m.size), np.zeros(a.size), np.zeros(m.size)
    by_t, by_a, scratch_a = np.zeros(m.size), np.zeros(a.size), np.zeros(a.size)
    n = setpoint.size
    torque, angle, position = np.zeros(n), np.zeros(n), np.zeros(n)
    integral, before = p[15] * radius / ratio, np.round(phi[0] * ratio / gains[4]) * gains[4]
    force = p[15]
    for i in range(n):
        angle[i], position[i] = phi[0] * ratio, x
        read = np.round(angle[i] / gains[4]) * gains[4]
        speed = (read - before) / sample
        before = read
        ahead = (setpoint[min(i + 1, n - 1)] - setpoint[i]) / sample * ratio / radius
        wanted = gains[0] * (setpoint[i] * ratio / radius - read) + ahead
        error = wanted - speed
        integral += gains[1] * gains[2] * sample * error
        integral = min(max(integral, -gains[3]), gains[3])
        given = min(max(gains[1] * error + integral, -gains[3]), gains[3]) + chirp[i]
        torque[i] = given
        for _ in range(steps):
            node, share, soft = at_nut(z, first + x + 0.5 * h * v, axial, torsional, radius)
            stiffness = nut / (1 + nut * soft)
            by_drag = radius * share * (1 - share) * (z[node + 1] - z[node]) / torsional  # stretch by the twist there
            one, two = start + node, start + node + 1
            _times(m, mo, phi_rate, turned)
            _times(k, ko, phi, scratch)
            for j in range(m.size):
                turned[j] = 2 / h * turned[j] - scratch[j]
                by_t[j] = 0.0
            turned[0] += ratio * given
            by_t[one], by_t[two] = 1 - share, share
            _times(a, ao, u_rate, moved)
            _times(s, so, u, scratch_a)
            for j in range(a.size):
                moved[j] = 2 / h * moved[j] - scratch_a[j]
                by_a[j] = 0.0
            by_a[node], by_a[node + 1] = 1 - share, share
            _solve(td, tl, turned)
            _solve(td, tl, by_t)
            _solve(ad, al, moved)
            _solve(ad, al, by_a)
            g_t = (1 - share) * by_t[one] + share * by_t[two]
            g_a = (1 - share) * by_a[node] + share * by_a[node + 1]
            w_free = (1 - share) * turned[one] + share * turned[two]
            u_free = (1 - share) * moved[node] + share * moved[node + 1]
            nut_angle = (1 - share) * phi[one] + share * phi[two]
            stretch = radius * nut_angle + (1 - share) * u[node] + share * u[node + 1] - x
            inverse = 0.5 * h / table
            drag, hold = 0.0, 0.0
            for _ in range(30):
                turn = nut_angle + 0.5 * h * w_free
                arm = radius + amplitude * order * math.cos(order * turn + phase)
                w = w_free - (arm * force + drag) * g_t
                rate = v + inverse * (force - hold)
                e_rate = arm * w + u_free - force * g_a - rate
                e = (
                    stretch
                    + amplitude * math.sin(order * turn + phase)
                    + 0.5 * h * (radius * w + u_free - force * g_a - rate)
                    - by_drag * drag
                )
                f, by_e, by_rate = _spring(stiffness, tau, gap, e, e_rate)
                t, t_w = _drag(p, level, force, w)
                b, b_v = _guide(p, x + 0.5 * h * v, rate)
                b += p[15]
                r1, r2, r3 = force - f, drag - t, hold - b
                through = by_rate + 0.5 * h * by_e
                j11 = 1 + through * (arm * arm * g_t + g_a + inverse)
                j12, j13 = through * arm * g_t + by_e * by_drag, -through * inverse
                j21, j22 = t_w * arm * g_t, 1 + t_w * g_t
                j31, j33 = -b_v * inverse, 1 + b_v * inverse
                # eliminate drag and hold: d2 = (-r2 - j21 d1) / j22, d3 = (-r3 - j31 d1) / j33
                pivot = j11 - j12 * j21 / j22 - j13 * j31 / j33
                d1 = (-r1 + j12 * r2 / j22 + j13 * r3 / j33) / pivot
                d2, d3 = (-r2 - j21 * d1) / j22, (-r3 - j31 * d1) / j33
                force, drag, hold = force + d1, drag + d2, hold + d3
                if abs(d1) < 1e-7 and abs(d3) < 1e-7 and abs(d2) < 1e-9:
                    break
            for j in range(m.size):
                mean = turned[j] - (arm * force + drag) * by_t[j]
                phi[j] += h * mean
                phi_rate[j] = 2 * mean - phi_rate[j]
            for j in range(a.size):
                mean = moved[j] - force * by_a[j]
                u[j] += h * mean
                u_rate[j] = 2 * mean - u_rate[j]
            rate = v + inverse * (force - hold)
            x += h * rate
            v = 2 * rate - v
    return torque, angle, position
