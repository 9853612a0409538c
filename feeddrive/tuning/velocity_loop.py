"""Gains and filters of the velocity loop from margins: the most integral gain that holds in every case.

    maximise K_p / T_n   over K_p, T_n and the filters, subject in every case to the margins of
                         L = K_p (1 + T / (T_n (z - 1))) F_t(z) G(z)

| symbol | meaning | unit |
|---|---|---|
| K_p, T_n, T | gain, reset time, tick | N m s/rad, s, s |
| F_t | filters of the torque command | 1 |
| G | plant, current loop, dead time and speed from the encoder, sampled | rad/s per N m |

1 / (K_p / T_n) is how far a constant load drives the integrated error of the speed, so its largest value rejects most.
For given T_n and filters the largest K_p follows in one pass (`tuning.largest_gain`); over T_n it is searched on a grid
that is refined. Filters come one at a time, at the resonance that limits or as a low-pass, and are then moved in
frequency, width and depth as long as that brings more. How the position loop does around it is not in the measure: the
margins and the magnification that are asked of it are met by K_v (`tuning.position_loop`).
Source: Åström, Hägglund, Advanced PID Control (2006), section 6.8: integral gain maximised under robustness
constraints, with margins in the place of the largest sensitivity. The gains found are checked with the loop itself.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from feeddrive.errors import InputError
from feeddrive.plant.plant import Plant
from feeddrive.servo.cascade import Cascade
from feeddrive.servo.filters import Filter
from feeddrive.servo.linear_loop import open_velocity_loop
from feeddrive.servo.margins import frequency_response
from feeddrive.servo.mechanics_response import Case, Friction, grid, transfer
from feeddrive.servo.resonances import Kind, Resonance, resonances
from feeddrive.tuning.demand import Demand
from feeddrive.tuning.filter_choice import NO_LIMITS, FilterChoice, FilterLimits, low_pass, notches_about
from feeddrive.tuning.largest_gain import GainLimit, largest_gain
from feeddrive.typing import ComplexArray, FloatArray

LOWEST = 0.5
"""Lowest frequency looked at [Hz]."""

WORTH = 1.2
"""Factor of integral gain that a further filter must bring: one that brings less costs K_v by its lag and asks to be
kept up where the machine differs from the plant file."""

_RESET_TIMES = np.geomspace(3e-4, 2.0, 40)
_NEAR = 0.25
"""Share of frequency within which a limit is put down to a resonance."""
_STEPS = (0.15, 0.05)
"""Relative steps by which a filter is moved; natural frequencies of a plant file are not better than the last."""
_PROMISING = 1.05
"""Factor that a filter must bring before it is moved; moving a filter brings some tenths, not a hopeless one."""


@dataclass(frozen=True)
class VelocityGains:
    """Settings of the velocity loop.

    Attributes:
        gain: K_p [N m s/rad].
        reset_time: T_n [s].
        filters: of the torque command.
        limit: what holds the gain back.
    """

    gain: float
    reset_time: float
    filters: tuple[FilterChoice, ...]
    limit: GainLimit

    @property
    def integral(self) -> float:
        """K_p / T_n [N m/rad]."""
        return self.gain / self.reset_time


@dataclass(frozen=True)
class _Task:
    """Grid [Hz], loops at K_p = 1 without integrator (cases, n), resonances by case, what filters may be.

    `alike` tells cases of the same motion and friction: a table that is held has other resonances than one that moves.
    """

    tick: float
    frequency: FloatArray
    loops: ComplexArray
    resonances: tuple[tuple[Resonance, ...], ...]
    alike: tuple[tuple[float, Friction], ...]
    demand: Demand
    limits: FilterLimits


def velocity_gains(
    plant: Plant, drive: Cascade, cases: Sequence[Case], demand: Demand, limits: FilterLimits = NO_LIMITS
) -> VelocityGains:
    """The most integral gain whose margins hold in every case, with as few filters as are worth it.

    Args:
        plant: the machine.
        drive: rates, current loop, dead time and filters that stay; its gains are not looked at.
        cases: in which the margins must hold.
        demand: the margins.
        limits: what filters the drive has.

    Raises:
        InputError: no gain holds; says what would.
    """
    task = _task(plant, drive, cases, demand, limits)
    found = _best(task, (), _RESET_TIMES)
    if not found.gain:
        raise InputError(
            f"no gain of the velocity loop keeps {demand.phase:g}° and {demand.gain:g} dB in every case",
            plant.name,
            _hint(task),
        )
    while len(found.filters) < limits.most:
        better = _with_filter(task, found)
        if better is None:
            break
        found = better
    return _refined(task, found)


def _task(plant: Plant, drive: Cascade, cases: Sequence[Case], demand: Demand, limits: FilterLimits) -> _Task:
    highest = 0.5 / drive.sample_time
    systems = [transfer(plant, "motor_torque", "motor_speed", case) for case in cases]
    roots = tuple(resonances(system, LOWEST, highest) for system in systems)
    bare = replace(drive, velocity_gain=1.0, reset_time=math.inf, tracking_time=1.0)
    frequency = grid(LOWEST, highest * (1 - 1e-9), tuple(root for some in roots for root in some))
    loops = [
        frequency_response(open_velocity_loop(case.on(plant), bare, case.velocity, case.position), frequency)
        for case in cases
    ]
    alike = tuple((case.velocity, case.friction) for case in cases)
    return _Task(drive.sample_time, frequency, np.array(loops), roots, alike, demand, limits)


def _best(task: _Task, filters: tuple[FilterChoice, ...], reset_times: FloatArray) -> VelocityGains:
    """The reset time of most integral gain, for given filters."""
    filtered = task.loops * _through([choice.filter for choice in filters], task)
    z = np.exp(2j * math.pi * task.frequency * task.tick)
    found = []
    for reset in reset_times:
        loops = filtered * (1 + task.tick / reset / (z - 1))
        limit = largest_gain(task.frequency, loops, 1 / (2 * math.pi * reset), task.demand)
        found.append(VelocityGains(limit.gain, float(reset), filters, limit))
    return max(found, key=lambda one: one.integral)


def _refined(task: _Task, found: VelocityGains) -> VelocityGains:
    """Gains with the filters that were found and the reset time to half a percent."""
    for width in (0.2, 0.03):
        times = found.reset_time * np.geomspace(1 - width, 1 + width, 13)
        found = max(found, _best(task, found.filters, times), key=lambda one: one.integral)
    return found


def _through(filters: Sequence[Filter], task: _Task) -> ComplexArray:
    """Response of sampled filters in series, shape (n,)."""
    late = np.exp(-2j * math.pi * task.frequency * task.tick)
    response: ComplexArray = np.ones_like(late)
    for one in filters:
        c = one.discrete(task.tick)
        response = response * (c[0] + c[1] * late + c[2] * late**2) / (1 + c[3] * late + c[4] * late**2)
    return response


def _with_filter(task: _Task, found: VelocityGains) -> VelocityGains | None:
    """One filter more where it brings most, moved to where it brings most; None where it is not worth it."""
    offered = _offered(task, found)
    if not offered:
        return None
    coarse = found.reset_time * np.geomspace(0.2, 1.3, 10)
    tried = [_best(task, (*found.filters, choice), coarse) for choice in offered]
    first = max(tried, key=lambda one: one.integral)
    if first.integral < _PROMISING * found.integral:
        return None
    best = _moved(task, first)
    if best.integral < WORTH * found.integral:
        return None
    brings = replace(best.filters[-1], brings=best.integral / found.integral)
    return replace(best, filters=(*best.filters[:-1], brings))


def _offered(task: _Task, found: VelocityGains) -> list[FilterChoice]:
    """Filters about the resonance that limits, and a low-pass, as far as the drive has them."""
    spread, highest = _limiting_resonance(task, found), 0.4 / task.tick
    notches = [] if spread is None else notches_about(spread, task.limits)
    passes = (
        []
        if any(choice.kind == "PT2" for choice in found.filters)
        else [low_pass(factor * found.limit.frequency, task.limits) for factor in (0.7, 1.5, 3.0)]
    )
    return [one for one in (*notches, *passes) if one is not None and one.frequency < highest]


def _moved(task: _Task, found: VelocityGains) -> VelocityGains:
    """All filters moved, each value by itself and up and down, as long as it brings more."""
    highest = 0.4 / task.tick
    for step in _STEPS:
        better = True
        while better:
            better = False
            for place, choice in enumerate(found.filters):
                for changed in choice.varied(step, task.limits):
                    if changed.frequency >= highest:
                        continue
                    filters = (*found.filters[:place], changed, *found.filters[place + 1 :])
                    tried = _best(task, filters, found.reset_time * np.array([0.88, 1.0, 1.14]))
                    if tried.integral > (1 + 0.1 * step) * found.integral:
                        found, better = tried, True
                        break
    return found


def _limiting_resonance(task: _Task, found: VelocityGains) -> tuple[float, float] | None:
    """Least and greatest natural frequency over the cases of the resonance that limits; None where none does."""
    every = [[root.frequency for root in some if root.kind is Kind.RESONANCE] for some in task.resonances]
    own, motion = every[found.limit.case], task.alike[found.limit.case]
    poles = [some for some, other in zip(every, task.alike, strict=True) if other == motion]
    near = [f for f in own if abs(f / found.limit.frequency - 1) < _NEAR]
    if not near:
        return None
    number = own.index(min(near, key=lambda f: abs(f - found.limit.frequency)))
    over = [some[number] for some in poles if len(some) > number]
    return min(over), max(over)


def _hint(task: _Task) -> str:
    """What phase margin a loop could have at best."""
    for phase in range(int(task.demand.phase), 0, -1):
        easier = replace(task, demand=replace(task.demand, phase=float(phase)))
        if _best(easier, (), _RESET_TIMES).gain:
            return f"{phase}° can be kept; ask for that, or make the drive faster (rates, dead time)"
    return "the drive is too slow for this machine: raise its rates, lower its dead time"
