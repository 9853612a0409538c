"""The set-point, excitation and forces of a scenario, read from its tables.

[trajectory] kind =
  hold            position, duration
  moves           start, targets, velocity (one or one per target), acceleration, jerk, dwell, repeat
  staircase       targets, runs, overrun, velocity, acceleration, jerk, dwell      (ISO 230-2)
  position_step   start, height, at, duration
  velocity_steps  start, velocities, durations
  circle          centre, radius, turns, velocity (the feed), acceleration, jerk, dwell
  sine            centre, amplitude, frequency, duration, fade
  wave            start, offset_velocity, amplitude (a velocity), and a waveform
waveform =
  sweep           low, high, duration
  multisine       low, high, period, periods, lines (spread in equal ratios; left out: all)
  prbs            bit, order, periods
[excitation]      at ("speed" or "torque"), amplitude, start, and a waveform
[[force]] kind =
  step            force, start, end
  triangle        amplitude, period, cycles, start
  sine            amplitude, frequency, mean, start
  file            path of a CSV with the columns time [s] and cutting_force [N]
  milling         teeth, spindle_speed, depth, feed_per_tooth, tangential, radial, entry, exit, start, end
"""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path

from feeddrive.errors import InputError
from feeddrive.plant.file.entries import Table
from feeddrive.recording.files.reading import read_recording
from feeddrive.simulate.scenario.scenario import Excitation, Place
from feeddrive.simulate.scenario.scenario_values import optional, positive, quantities, whole
from feeddrive.simulate.setpoints.cutting_force import (
    Force,
    Milling,
    NoForce,
    RecordedForce,
    SineForce,
    StepForce,
    SumOfForces,
    TriangleForce,
)
from feeddrive.simulate.setpoints.jerk_limited import Limits
from feeddrive.simulate.setpoints.setpoint_motion import Pieces, Trajectory, rest
from feeddrive.simulate.setpoints.trajectories import (
    Circle,
    Sine,
    Wave,
    moves,
    position_step,
    staircase,
    velocity_steps,
)
from feeddrive.simulate.setpoints.waveforms import Multisine, Prbs, Sweep, Waveform

MOST_REPEATS = 10_000
"""Repeats of a motion at most: a day of moves of some seconds. Every piece of it is held in memory."""

MOST_TEETH = 1000
"""Teeth of a cutter at most; the largest face mills have some hundred."""


def read_trajectory(table: Table) -> Trajectory:
    """The trajectory of a table [trajectory].

    Raises:
        InputError: unknown kind or key, values missing or impossible.
    """
    kind = table.choice("kind", _TRAJECTORIES)
    table = table.of_kind(kind)
    table.refuse_undeclared()
    return _TRAJECTORIES[kind](table)


def read_excitation(table: Table) -> Excitation:
    """The excitation of a table [excitation].

    Raises:
        InputError: as `read_trajectory`.
    """
    table.refuse_undeclared()
    place = Place(table.choice("at", [str(place) for place in Place]))
    unit = {Place.SPEED: "rad/s", Place.TORQUE: "N m"}[place]
    return Excitation(place, positive(table, "amplitude", unit), _waveform(table), optional(table, "start", "s", 0.0))


def read_forces(tables: list[Table], folder: Path) -> Force:
    """All forces of the tables [[force]]; files are sought from `folder` on.

    Raises:
        InputError: as `read_trajectory`, or a file that cannot be read.
    """
    found: list[Force] = []
    for table in tables:
        kind = table.choice("kind", _FORCES)
        table = table.of_kind(kind)
        table.refuse_undeclared()
        found.append(_FORCES[kind](table, folder))
    return SumOfForces(tuple(found)) if found else NoForce()


def _limits(table: Table, velocity: float | None = None) -> Limits:
    speed = positive(table, "velocity", "m/s") if velocity is None else velocity
    acceleration, jerk = table.quantity("acceleration", "m/s^2", ""), table.quantity("jerk", "m/s^3", "")
    return Limits(speed, acceleration, jerk, table.where)


def _hold(table: Table) -> Trajectory:
    return Pieces((rest(table.quantity("position", "m", ""), positive(table, "duration", "s")),))


def _moves(table: Table) -> Trajectory:
    targets, speeds = quantities(table, "targets", "m"), quantities(table, "velocity", "m/s")
    if len(speeds) not in (1, len(targets)):
        what = f"{len(speeds)} velocities for {len(targets)} targets"
        raise InputError(what, table.place("velocity"), "write one velocity, or one per target")
    each = speeds if len(speeds) > 1 else speeds * len(targets)
    pairs = [(target, _limits(table, speed)) for target, speed in zip(targets, each, strict=True)]
    dwell = optional(table, "dwell", "s", 0.0)
    return moves(table.quantity("start", "m", ""), pairs * whole(table, "repeat", 1, MOST_REPEATS), dwell)


def _staircase(table: Table) -> Trajectory:
    targets, runs = quantities(table, "targets", "m"), whole(table, "runs", None, MOST_REPEATS)
    return staircase(targets, runs, positive(table, "overrun", "m"), _limits(table), positive(table, "dwell", "s"))


def _position_step(table: Table) -> Trajectory:
    height, at = table.quantity("height", "m", ""), positive(table, "at", "s")
    duration = positive(table, "duration", "s")
    if duration <= at:
        raise InputError("ends before the step", table.place("duration"), "write a longer duration")
    return position_step(table.quantity("start", "m", ""), height, at, duration)


def _velocity_steps(table: Table) -> Trajectory:
    speeds, durations = quantities(table, "velocities", "m/s"), quantities(table, "durations", "s")
    if len(speeds) != len(durations) or min(durations) <= 0:
        what = f"{len(speeds)} velocities and {len(durations)} durations"
        raise InputError(what, table.place("durations"), "write one duration above zero per velocity")
    return velocity_steps(table.quantity("start", "m", ""), list(zip(durations, speeds, strict=True)))


def _circle(table: Table) -> Trajectory:
    centre, radius, turns = (
        table.quantity("centre", "m", ""),
        positive(table, "radius", "m"),
        positive(table, "turns", "1"),
    )
    return Circle(centre, radius, turns, _limits(table), optional(table, "dwell", "s", 0.0))


def _sine(table: Table) -> Trajectory:
    centre, amplitude = table.quantity("centre", "m", ""), positive(table, "amplitude", "m")
    times = positive(table, "duration", "s"), positive(table, "fade", "s")
    return Sine(centre, amplitude, positive(table, "frequency", "Hz"), *times)


def _wave(table: Table) -> Trajectory:
    start, offset = table.quantity("start", "m", ""), optional(table, "offset_velocity", "m/s", 0.0)
    return Wave(start, offset, positive(table, "amplitude", "m/s"), _waveform(table))


def _waveform(table: Table) -> Waveform:
    kind = table.choice("waveform", ("sweep", "multisine", "prbs"))
    if kind == "prbs":
        return Prbs(positive(table, "bit", "s"), whole(table, "order"), whole(table, "periods", 1))
    low, high = positive(table, "low", "Hz"), positive(table, "high", "Hz")
    if kind == "sweep":
        return Sweep(low, high, positive(table, "duration", "s"))
    return Multisine(low, high, positive(table, "period", "s"), whole(table, "periods", 1), whole(table, "lines", 0))


_TRAJECTORIES: dict[str, Callable[[Table], Trajectory]] = {
    "hold": _hold,
    "moves": _moves,
    "staircase": _staircase,
    "position_step": _position_step,
    "velocity_steps": _velocity_steps,
    "circle": _circle,
    "sine": _sine,
    "wave": _wave,
}


def _step_force(table: Table, _: Path) -> Force:
    return StepForce(table.quantity("force", "N", ""), optional(table, "start", "s", 0.0), _end(table))


def _end(table: Table) -> float:
    return optional(table, "end", "s", math.inf)


def _triangle_force(table: Table, _: Path) -> Force:
    amplitude, period = positive(table, "amplitude", "N"), positive(table, "period", "s")
    return TriangleForce(amplitude, period, whole(table, "cycles", 1), optional(table, "start", "s", 0.0))


def _sine_force(table: Table, _: Path) -> Force:
    amplitude, frequency = positive(table, "amplitude", "N"), positive(table, "frequency", "Hz")
    return SineForce(amplitude, frequency, optional(table, "mean", "N", 0.0), optional(table, "start", "s", 0.0))


def _recorded_force(table: Table, folder: Path) -> Force:
    recording = read_recording(folder / table.text("path"))
    return RecordedForce(recording.time, recording["cutting_force"])


def _milling(table: Table, _: Path) -> Force:
    return Milling(
        whole(table, "teeth", None, MOST_TEETH),
        positive(table, "spindle_speed", "rad/s"),
        positive(table, "depth", "m"),
        positive(table, "feed_per_tooth", "m"),
        positive(table, "tangential", "Pa"),
        optional(table, "radial", "Pa", 0.0),
        optional(table, "entry", "rad", 0.0),
        optional(table, "exit", "rad", math.pi),
        optional(table, "start", "s", 0.0),
        _end(table),
    )


_FORCES: dict[str, Callable[[Table, Path], Force]] = {
    "step": _step_force,
    "triangle": _triangle_force,
    "sine": _sine_force,
    "file": _recorded_force,
    "milling": _milling,
}
