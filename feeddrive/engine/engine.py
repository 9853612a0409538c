"""Runs a program over samples: compiled where a compiler is found, in CasADi's virtual machine elsewhere.

Constants of finer steps are made when the first step asks for them, so that a run without jumps pays for none.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Protocol

import numpy as np

from feeddrive.engine.compiled import compiled_run
from feeddrive.engine.interpreted import interpreted_run
from feeddrive.engine.program import (
    CELL,
    DEEPEST,
    REPORTS,
    TOLERANCE,
    Position,
    Program,
    Run,
    Status,
    StepReport,
    Stop,
    Tangents,
    Task,
)
from feeddrive.engine.step.linear_part import Linear, SimulationError, linear_part
from feeddrive.engine.step.step_constants import step_constants
from feeddrive.plant.plant import Plant
from feeddrive.plant.structure import parameter_values
from feeddrive.typing import FloatArray


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


class Along(Protocol):
    """What is carried along with a run."""

    def begun(self, task: Task) -> Tangents:
        """How the run changes at its start, with room for the rest."""

    def make_constants(self, task: Task, stop: Stop) -> None:
        """Fill in how the constants change that the driver has asked for."""


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
    made = compiled_run(program)
    return Machine(program, made if made is not None else interpreted_run(program))


def rested(machine: Machine, states: FloatArray, own: FloatArray) -> Position:
    """A start from states of the chain, coordinates first, (k,), bristles unloaded, and those of commands, (o,)."""
    memory = np.zeros(machine.program.step.layout.memory)
    memory[: len(states)] = states
    return Position(memory, np.asarray(own, dtype=float))


def run_machine(
    machine: Machine,
    plant: Plant,
    feed: Feed,
    start: Position,
    tolerance: float = TOLERANCE,
    along: Along | None = None,
) -> Outcome:
    """All samples of a feed.

    Args:
        machine: of the plant's structure.
        plant: with its values.
        feed: inputs and settings.
        start: from `rested`, or where another run ended.
        tolerance: error of the table position that a step may make [m]; infinite for steps of fixed length.
        along: what is carried along, for a program with tangents.

    Returns:
        What was seen, where it ended, how the steps went.

    Raises:
        SimulationError: the step cannot be solved even at the finest level, or the motion does not stay finite.
        InputError: the nut would leave the screw.
    """
    program = machine.program
    source = _Source(plant, program, feed.torque_lag, tolerance)
    table = _table(source, tuple(feed.spans.tolist())) if along is None else _Table(source, len(feed.spans))
    task = _task(program, plant, feed, table)
    if along is not None:
        task = replace(task, tangents=along.begun(task))
    seen, report = np.empty((len(feed.fed), program.sizes["N_BEFORE"] + program.sizes["N_AFTER"])), np.zeros(REPORTS)
    stop = machine.run(task, start, 0, seen, report)
    while stop.status == Status.NEEDS_CONSTANTS:
        _make_constants(task, source, feed, stop)
        if along is not None:
            along.make_constants(task, stop)
        stop = machine.run(task, stop.position, stop.sample, seen, report)
    _refuse_failure(plant, feed, stop, seen, report)
    return Outcome(seen, stop.position, _told(report, len(seen), tolerance))


def _task(program: Program, plant: Plant, feed: Feed, table: _Table) -> Task:
    fed, spans, settings, values = (
        np.ascontiguousarray(given) for given in (feed.fed, feed.spans, feed.settings, parameter_values(plant))
    )
    return Task(fed, spans, settings, values, table.fixed, table.made, table.first)


def _cells(plant: Plant) -> tuple[int, int]:
    """First cell and number of cells of the positions that the chain allows; one where it does not vary."""
    chain = plant.chain.without_modes
    if not chain.varies:
        return 0, 1
    least, greatest = chain.positions_on_screw()
    first, last = math.floor(least / CELL) + 1, math.ceil(greatest / CELL) - 1  # references inside, where masses are
    return first, last - first + 1


class _Source:
    """All that the constants of steps depend on, as the key under which they are kept."""

    def __init__(self, plant: Plant, program: Program, torque_lag: float, tolerance: float) -> None:
        self.plant, self.layout, self.size = plant, program.step.layout, program.sizes["N_FIXED"]
        self.varies, self.torque_lag, self.tolerance = program.varies, torque_lag, tolerance
        chain = (type(plant.chain), plant.chain.key, tuple(plant.chain_values().items()))
        self._key = (chain, self.layout, torque_lag, tolerance)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Source) and self._key == other._key

    def __hash__(self) -> int:
        return hash(self._key)


class _Table:
    """The constants of a run by part, cell and level, and which of them are made."""

    def __init__(self, source: _Source, parts: int) -> None:
        self.first, count = _cells(source.plant)
        self.fixed = np.zeros((parts, count, DEEPEST + 1, source.size))
        self.made = np.zeros((count, DEEPEST + 1), dtype=np.uint8)


@lru_cache(maxsize=16)
def _table(source: _Source, spans: tuple[float, ...]) -> _Table:
    """The table of earlier runs of the same plant: a fit that moves friction alone makes no constants again."""
    return _Table(source, len(spans))


def _make_constants(task: Task, source: _Source, feed: Feed, stop: Stop) -> None:
    """Fill in what the driver has asked for."""
    cell = task.first_cell + stop.cell
    for part, span in enumerate(feed.spans):
        task.fixed[part, stop.cell, stop.level] = _constants(source, cell, float(span), stop.level)
    task.made[stop.cell, stop.level] = 1


@lru_cache(maxsize=2048)  # of some thousand numbers each; a fit asks for the same ones again and again
def _constants(source: _Source, cell: int, span: float, level: int) -> FloatArray:
    linear = _linear(source, cell)
    return step_constants(linear, source.layout, span / 2**level, 0.5**level, source.tolerance)


@lru_cache(maxsize=256)
def _linear(source: _Source, cell: int) -> Linear:
    return linear_part(source.plant, source.layout, source.torque_lag, CELL * cell if source.varies else 0.0)


def forget_constants() -> None:
    """Make all constants of steps anew."""
    _table.cache_clear()
    _constants.cache_clear()
    _linear.cache_clear()


def _refuse_failure(plant: Plant, feed: Feed, stop: Stop, seen: FloatArray, report: FloatArray) -> None:
    at = stop.sample
    if stop.status == Status.DONE:
        if np.isfinite(report[-1]):
            return
        at = int(np.argmin(np.isfinite(seen).all(axis=1)))
    time = feed.fed[min(at, len(feed.fed) - 1), -1]
    if stop.status == Status.OFF_GRID:
        table = float(stop.position.memory[len(plant.chain.coordinates) - 1])
        raise SimulationError(
            f"after {time:.6g} s the nut leaves the screw, at {1e3 * table:.4g} mm", plant.name, "shorten the motion"
        )
    shortest = float(feed.spans.min()) / 2**DEEPEST
    raise SimulationError(
        f"the motion cannot be followed after {time:.6g} s, not even with steps of {shortest:.2g} s",
        plant.name,
        f"check the values of {_steepest(plant)}",
    )


def _steepest(plant: Plant) -> str:
    """The effect that is most likely the cause: a bristle, a free play, else the friction."""
    for name in ("presliding", "backlash", "preload_loss", "stribeck"):
        if any(effect.name == name for effect in plant.effects):
            return name
    return plant.effects[0].name if plant.effects else "the chain"


def _told(report: FloatArray, samples: int, tolerance: float) -> StepReport:
    steps, refused, sweeps, over, _, excess, finest, last, _ = report
    return StepReport(
        samples,
        int(steps),
        int(refused),
        int(sweeps),
        int(finest),
        float(last),
        int(over),
        float(excess * tolerance) if over else 0.0,
        tolerance,
    )
