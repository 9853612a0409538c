"""Gains and filters of the velocity loop from margins: the most integral gain that holds in every case.

    maximise K_p / T_n   subject to   T_n >= 4 J / K_p   and, in every case, to the margins of
                                      L = K_p (1 + T / (T_n (z - 1))) F_t(z) G(z)

| symbol | meaning | unit |
|---|---|---|
| K_p, T_n, T | gain, reset time, tick | N m s/rad, s, s |
| J | inertia of everything at the motor, greatest over the cases; K_p / J is the crossover of a rigid axis | kg m^2 |
| F_t | filters of the torque command | 1 |
| G | plant, current loop, dead time and speed from the encoder, sampled | rad/s per N m |

1 / (K_p / T_n) is how far a constant load drives the integrated error of the speed, so its largest value rejects most.
T_n of 4 J / K_p leaves the integrator 14 deg of the phase at the crossover; below it the speed overshoots its set-point
and the position loop pays.
Source: Åström, Hägglund, Advanced PID Control (2006), section 6.8: integral gain maximised under robustness
constraints, with margins in the place of the largest sensitivity. The gains found are checked with the loop itself.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from feeddrive.errors import InputError
from feeddrive.plant.moving_inertia import inertia_at_motor
from feeddrive.plant.plant import Plant
from feeddrive.servo.cascade import Cascade
from feeddrive.servo.filters import Filter, notch
from feeddrive.servo.frequency_response import Case, grid, transfer
from feeddrive.servo.linear_loop import open_velocity_loop
from feeddrive.servo.margins import frequency_response
from feeddrive.servo.resonances import Kind, Resonance, resonances
from feeddrive.tuning.demand import Demand
from feeddrive.tuning.largest_gain import GainLimit, largest_gain
from feeddrive.typing import ComplexArray, FloatArray

LOWEST = 0.5
"""Of the frequencies looked at [Hz]."""

WORTH = 1.2
"""Factor of integral gain that a further filter must bring."""

MOST_FILTERS = 3
SLOWER = 4.0
"""Least T_n K_p / J."""
_RESET_TIMES = np.geomspace(1e-3, 2.0, 34)
_WIDTHS, _DEPTHS = (0.25, 0.5, 1.0), (10.0, 20.0, 30.0)
_NEAR = 0.25
"""Share of frequency within which a limit is put down to a resonance."""


@dataclass(frozen=True)
class NotchChoice:
    """A notch and what it brings.

    Attributes:
        filter: as the cascade takes it.
        frequency, bandwidth, depth: of it [Hz, Hz, dB].
        resonance: least and greatest natural frequency of the resonance over the cases [Hz].
        brings: factor of the integral gain that it allows.
    """

    filter: Filter
    frequency: float
    bandwidth: float
    depth: float
    resonance: tuple[float, float]
    brings: float


@dataclass(frozen=True)
class VelocityGains:
    """Settings of the velocity loop.

    Attributes:
        gain: K_p [N m s/rad].
        reset_time: T_n [s].
        notches: of the torque command.
        limit: what holds the gain back.
    """

    gain: float
    reset_time: float
    notches: tuple[NotchChoice, ...]
    limit: GainLimit

    @property
    def integral(self) -> float:
        """K_p / T_n [N m/rad]."""
        return self.gain / self.reset_time


@dataclass(frozen=True)
class _Task:
    """Grid [Hz], loops at K_p = 1 without integrator (cases, n), resonances by case, greatest inertia [kg m^2].

    `velocities` of the cases [m/s]: a table that friction holds has other resonances than one that moves.
    """

    tick: float
    frequency: FloatArray
    loops: ComplexArray
    resonances: tuple[tuple[Resonance, ...], ...]
    velocities: tuple[float, ...]
    inertia: float
    demand: Demand


def velocity_gains(plant: Plant, drive: Cascade, cases: Sequence[Case], demand: Demand) -> VelocityGains:
    """The most integral gain whose margins hold in every case, with as few notches as are worth it.

    Args:
        plant: the machine.
        drive: rates, current loop, dead time and filters that stay; its gains are not looked at.
        cases: in which the margins must hold.
        demand: the margins.

    Raises:
        InputError: no gain holds; says what would.
    """
    task = _task(plant, drive, cases, demand)
    found = _best(task, (), _RESET_TIMES)
    if not found.gain:
        raise InputError(f"no gain of the velocity loop keeps {demand.phase:g}° and {demand.gain:g} dB in every case",
                         plant.name, _hint(task))  # fmt: skip
    while len(found.notches) < MOST_FILTERS:
        better = _with_notch(task, found)
        if better is None:
            break
        found = better
    return _best(task, found.notches, found.reset_time * np.geomspace(0.75, 1.35, 25))


def _task(plant: Plant, drive: Cascade, cases: Sequence[Case], demand: Demand) -> _Task:
    highest = 0.5 / drive.sample_time
    systems = [transfer(plant, "motor_torque", "motor_speed", case) for case in cases]
    roots = tuple(resonances(system, LOWEST, highest) for system in systems)
    bare = replace(drive, velocity_gain=1.0, reset_time=math.inf, tracking_time=1.0)
    frequency = grid(LOWEST, highest * (1 - 1e-9), tuple(root for some in roots for root in some))
    loops = [
        frequency_response(open_velocity_loop(case.on(plant), bare, case.velocity, case.position), frequency)
        for case in cases
    ]
    inertia = max(inertia_at_motor(case.on(plant)) for case in cases)
    velocities = tuple(case.velocity for case in cases)
    return _Task(drive.sample_time, frequency, np.array(loops), roots, velocities, inertia, demand)


def _best(task: _Task, notches: tuple[NotchChoice, ...], reset_times: FloatArray) -> VelocityGains:
    """The reset time of most integral gain, for given notches."""
    filtered = task.loops * _through([choice.filter for choice in notches], task)
    found = []
    for reset in reset_times:
        z = np.exp(2j * math.pi * task.frequency * task.tick)
        loops = filtered * (1 + task.tick / reset / (z - 1))
        limit = largest_gain(task.frequency, loops, 1 / (2 * math.pi * reset), task.demand)
        slow = reset * limit.gain >= SLOWER * task.inertia
        found.append(VelocityGains(limit.gain if slow else 0.0, float(reset), notches, limit))
    return max(found, key=lambda one: one.integral)


def _through(filters: Sequence[Filter], task: _Task) -> ComplexArray:
    """Response of sampled filters in series, shape (n,)."""
    late = np.exp(-2j * math.pi * task.frequency * task.tick)
    response: ComplexArray = np.ones_like(late)
    for one in filters:
        c = one.discrete(task.tick)
        response = response * (c[0] + c[1] * late + c[2] * late**2) / (1 + c[3] * late + c[4] * late**2)
    return response


def _with_notch(task: _Task, found: VelocityGains) -> VelocityGains | None:
    """One notch more at the resonance that limits, the shallowest and narrowest that brings nearly most; or None."""
    spread = _limiting_resonance(task, found)
    if spread is None or spread[1] * task.tick > 0.4:
        return None
    coarse = found.reset_time * np.geomspace(0.1, 1.2, 16)
    tried = [_best(task, (*found.notches, choice), coarse) for choice in _notches(spread)]
    best = max(one.integral for one in tried)
    if best < WORTH * found.integral:
        return None
    chosen = next(one for one in tried if one.integral > 0.93 * best)
    brings = replace(chosen.notches[-1], brings=chosen.integral / found.integral)
    return replace(chosen, notches=(*found.notches, brings))


def _notches(spread: tuple[float, float]) -> list[NotchChoice]:
    """Notches about a resonance, gentle ones first."""
    centre = float(f"{math.sqrt(spread[0] * spread[1]):.3g}")
    made = []
    for depth in _DEPTHS:
        for width in _WIDTHS:
            bandwidth = float(f"{max(width * centre, 1.5 * (spread[1] - spread[0])):.2g}")
            made.append(NotchChoice(notch(centre, bandwidth, depth), centre, bandwidth, depth, spread, 1.0))
    return made


def _limiting_resonance(task: _Task, found: VelocityGains) -> tuple[float, float] | None:
    """Least and greatest natural frequency over the cases of the resonance that limits; None where none does."""
    every = [[root.frequency for root in some if root.kind is Kind.RESONANCE] for some in task.resonances]
    own, velocity = every[found.limit.case], task.velocities[found.limit.case]
    poles = [some for some, other in zip(every, task.velocities, strict=True) if other == velocity]
    taken = [choice.frequency for choice in found.notches]
    near = [f for f in own if abs(f / found.limit.frequency - 1) < _NEAR]
    if not near:
        return None
    number = own.index(min(near, key=lambda f: abs(f - found.limit.frequency)))
    over = [some[number] for some in poles if len(some) > number]
    if any(min(over) * (1 - _NEAR / 2) < f < max(over) * (1 + _NEAR / 2) for f in taken):
        return None
    return min(over), max(over)


def _hint(task: _Task) -> str:
    """What phase margin a loop could have at best."""
    for phase in range(int(task.demand.phase), 0, -1):
        easier = replace(task, demand=replace(task.demand, phase=float(phase)))
        if _best(easier, (), _RESET_TIMES).gain:
            return f"{phase}° can be kept; ask for that, or make the drive faster (rates, dead time)"
    return "the drive is too slow for this machine: raise its rates, lower its dead time"
