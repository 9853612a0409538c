"""Runs a program over samples: compiled where a compiler is found, in CasADi's virtual machine elsewhere.

Constants of finer steps are made when the first step asks for them, so that a run without jumps pays for none.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from feeddrive.plant.equations import parameter_values
from feeddrive.plant.plant import Plant
from feeddrive.simulate.compiled import compiled_run, find_compiler
from feeddrive.simulate.interpreted import Run, interpreted_run
from feeddrive.simulate.program import (
    DEEPEST,
    REPORTS,
    TOLERANCE,
    Position,
    Program,
    Status,
    StepReport,
    Task,
)
from feeddrive.simulate.step_constants import SimulationError, linear_part
from feeddrive.typing import FloatArray

LEVELS_AT_ONCE = 3
"""Levels added when one is missing."""


@dataclass(frozen=True)
class Machine:
    """A program and what runs it."""

    program: Program
    run: Run


@dataclass(frozen=True)
class Feed:
    """What a run is given.

    Attributes:
        fed: per sample, shape (n, f), the time from the start [s] last.
        spans: length of each part of a sample [s], shape (p,).
        settings: of the commands, shape (s,).
        torque_lag: time constant of the torque loop [s], where the program has one.
    """

    fed: FloatArray
    spans: FloatArray
    settings: FloatArray
    torque_lag: float = 0.0


@dataclass(frozen=True)
class Outcome:
    """Samples of a run.

    Attributes:
        seen: what the program shows at each sample, shape (n, s).
        position: where it ended; a run given this goes on as if there had been one.
        report: how the steps went.
    """

    seen: FloatArray
    position: Position
    report: StepReport


def machine_of(program: Program) -> Machine:
    """The fastest that this computer offers."""
    compiler = find_compiler()
    made = compiled_run(program, compiler) if compiler is not None else None
    return Machine(program, made if made is not None else interpreted_run(program))


def rested(machine: Machine, plant: Plant, states: FloatArray, own: FloatArray, time: float = 0.0) -> Position:
    """A start from states of the chain (and bristles, else 0), the effects' forces as they belong to them.

    Args:
        machine: that will run.
        plant: with its values.
        states: of the step, coordinates first, shape (k,); the others are 0.
        own: of the commands, shape (o,).
        time: [s].
    """
    return watched(machine, plant, states, own, (0.0, 0.0), time)


def watched(
    machine: Machine, plant: Plant, states: FloatArray, own: FloatArray, motor: tuple[float, float], time: float
) -> Position:
    """As `rested`, with angle [rad] and speed [rad/s] of a motor that is driven."""
    memory = np.zeros(machine.program.step.layout.memory)
    memory[: len(states)] = states
    after = machine.program.step.watch(memory, *motor, time, parameter_values(plant))
    return Position(np.array(after).ravel(), np.asarray(own, dtype=float))


def run_machine(machine: Machine, plant: Plant, feed: Feed, start: Position, tolerance: float = TOLERANCE) -> Outcome:
    """All samples of a feed.

    Args:
        machine: of the plant's structure.
        plant: with its values.
        feed: inputs and settings.
        start: from `rested`, or where another run ended.
        tolerance: error of the table position that a step may make [m]; infinite for steps of fixed length.

    Returns:
        What was seen, where it ended, how the steps went.

    Raises:
        SimulationError: the step cannot be solved even at the finest level, or the motion does not stay finite.
    """
    program = machine.program
    linear = linear_part(plant, program.step.layout, feed.torque_lag)
    values = np.array(parameter_values(plant))
    table = np.empty((len(feed.spans), 0, program.sizes["N_FIXED"]))
    task = Task(feed.fed, feed.spans, feed.settings, values, table, tolerance)
    task = task.deeper(program, linear, start.level + 1)
    seen, report = np.empty((len(feed.fed), program.sizes["N_BEFORE"] + program.sizes["N_AFTER"])), np.zeros(REPORTS)
    at, position, status = 0, start, Status.NEEDS_LEVEL
    while status == Status.NEEDS_LEVEL:
        status, at, position = machine.run(task, position, at, seen, report)
        if status == Status.NEEDS_LEVEL:
            task = task.deeper(program, linear, min(task.table.shape[1] + LEVELS_AT_ONCE, DEEPEST + 1))
    _refuse_failure(plant, feed, status, at, seen)
    return Outcome(seen, position, _told(report, len(seen), tolerance))


def _refuse_failure(plant: Plant, feed: Feed, status: Status, at: int, seen: FloatArray) -> None:
    if status == Status.DONE and np.isfinite(seen).all():
        return
    if status == Status.DONE:
        at = int(np.argmin(np.isfinite(seen).all(axis=1)))
    shortest = float(feed.spans.min()) / 2**DEEPEST
    stiff = _steepest(plant)
    mend = f"check the values of {stiff}" if stiff else "check the values of the chain"
    time = feed.fed[min(at, len(feed.fed) - 1), -1]
    raise SimulationError(
        f"the motion cannot be followed after {time:.6g} s, not even with steps of {shortest:.2g} s", plant.name, mend
    )


def _steepest(plant: Plant) -> str:
    """The effect that is most likely the cause: a bristle, a free play, else the friction."""
    for name in ("presliding", "backlash", "stribeck"):
        if any(effect.name == name for effect in plant.effects):
            return name
    return plant.effects[0].name if plant.effects else ""


def _told(report: FloatArray, samples: int, tolerance: float) -> StepReport:
    steps, refused, sweeps, over, _, excess, finest, last = report
    return StepReport(
        samples, int(steps), int(refused), int(sweeps), int(finest), float(last), int(over),
        float(excess * tolerance) if over else 0.0, tolerance,
    )  # fmt: skip
