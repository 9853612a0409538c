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
from feeddrive.recording.files.reading import read_recording
from feeddrive.schema.table import Table
from feeddrive.simulate.scenario.scenario import Excitation, Place
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
from feeddrive.simulate.setpoints.setpoint_motion import Limits, Pieces, Trajectory, rest
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
    return Excitation(place, table.positive("amplitude", unit), _waveform(table), table.optional("start"))


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
    speed = table.positive("velocity") if velocity is None else velocity
    acceleration, jerk = table.quantity("acceleration"), table.quantity("jerk")
    return Limits(speed, acceleration, jerk, table.where)


def _hold(table: Table) -> Trajectory:
    return Pieces((rest(table.quantity("position"), table.positive("duration")),))


def _moves(table: Table) -> Trajectory:
    targets, speeds = table.listed("targets"), table.listed("velocity")
    if len(speeds) not in (1, len(targets)):
        what = f"{len(speeds)} velocities for {len(targets)} targets"
        raise InputError(what, table.place("velocity"), "write one velocity, or one per target")
    each = speeds if len(speeds) > 1 else speeds * len(targets)
    pairs = [(target, _limits(table, speed)) for target, speed in zip(targets, each, strict=True)]
    dwell = table.optional("dwell")
    return moves(table.quantity("start"), pairs * table.whole("repeat"), dwell)


def _staircase(table: Table) -> Trajectory:
    targets, runs = table.listed("targets"), table.whole("runs")
    return staircase(targets, runs, table.positive("overrun"), _limits(table), table.positive("dwell"))


def _position_step(table: Table) -> Trajectory:
    height, at = table.quantity("height"), table.positive("at")
    duration = table.positive("duration")
    if duration <= at:
        raise InputError("ends before the step", table.place("duration"), "write a longer duration")
    return position_step(table.quantity("start"), height, at, duration)


def _velocity_steps(table: Table) -> Trajectory:
    speeds, durations = table.listed("velocities"), table.listed("durations")
    if len(speeds) != len(durations) or min(durations) <= 0:
        what = f"{len(speeds)} velocities and {len(durations)} durations"
        raise InputError(what, table.place("durations"), "write one duration above zero per velocity")
    return velocity_steps(table.quantity("start"), list(zip(durations, speeds, strict=True)))


def _circle(table: Table) -> Trajectory:
    centre, radius, turns = (
        table.quantity("centre"),
        table.positive("radius"),
        table.positive("turns"),
    )
    return Circle(centre, radius, turns, _limits(table), table.optional("dwell"))


def _sine(table: Table) -> Trajectory:
    centre, amplitude = table.quantity("centre"), table.positive("amplitude")
    times = table.positive("duration"), table.positive("fade")
    return Sine(centre, amplitude, table.positive("frequency"), *times)


def _wave(table: Table) -> Trajectory:
    start, offset = table.quantity("start"), table.optional("offset_velocity")
    return Wave(start, offset, table.positive("amplitude"), _waveform(table))


def _waveform(table: Table) -> Waveform:
    kind = table.choice("waveform")
    if kind == "prbs":
        return Prbs(table.positive("bit"), table.whole("order"), table.whole("periods"))
    low, high = table.positive("low"), table.positive("high")
    if kind == "sweep":
        return Sweep(low, high, table.positive("duration"))
    return Multisine(low, high, table.positive("period"), table.whole("periods"), table.whole("lines"))


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
    return StepForce(table.quantity("force"), table.optional("start"), _end(table))


def _end(table: Table) -> float:
    return table.optional("end", math.inf)


def _triangle_force(table: Table, _: Path) -> Force:
    amplitude, period = table.positive("amplitude"), table.positive("period")
    return TriangleForce(amplitude, period, table.whole("cycles"), table.optional("start"))


def _sine_force(table: Table, _: Path) -> Force:
    amplitude, frequency = table.positive("amplitude"), table.positive("frequency")
    return SineForce(amplitude, frequency, table.optional("mean"), table.optional("start"))


def _recorded_force(table: Table, folder: Path) -> Force:
    recording = read_recording(folder / table.text("path"))
    return RecordedForce(recording.time, recording["cutting_force"])


def _milling(table: Table, _: Path) -> Force:
    return Milling(
        table.whole("teeth"),
        table.positive("spindle_speed"),
        table.positive("depth"),
        table.positive("feed_per_tooth"),
        table.positive("tangential"),
        table.optional("radial"),
        table.optional("entry"),
        table.optional("exit"),
        table.optional("start"),
        _end(table),
    )


_FORCES: dict[str, Callable[[Table, Path], Force]] = {
    "step": _step_force,
    "triangle": _triangle_force,
    "sine": _sine_force,
    "file": _recorded_force,
    "milling": _milling,
}
