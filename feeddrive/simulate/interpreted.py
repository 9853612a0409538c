"""The driver in CasADi's virtual machine, where no compiler is found: the decisions of `driver.c`, the same numbers.

Stretches that need one step a sample run in chunks inside the virtual machine; where a step is refused, Python takes
that sample and the virtual machine goes on behind it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import casadi as ca
import numpy as np

from feeddrive.simulate.program import CELL, DEEPEST, Position, Program, Run, Status, Stop, Task
from feeddrive.typing import Expression, FloatArray

CHUNKS = (512, 16)
"""Samples per call of the virtual machine: the longest while all goes well, the shorter behind a refused step."""

SWEEPS = 12
COARSER = 0.02
STRETCH_SWEEPS = 2
"""Newton corrections of a step in a stretch; a step that needs more is taken by Python."""


@dataclass
class _Place:
    """Where the run is between steps; it moves on."""

    memory: FloatArray
    own: FloatArray
    level: int
    cell: int

    @property
    def position(self) -> Position:
        return Position(self.memory, self.own, self.level, self.cell)


def interpreted_run(program: Program) -> Run:
    """The driver of a program in the virtual machine."""
    return _Interpreter(program).run


class _Interpreter:
    def __init__(self, program: Program) -> None:
        self.program = program
        self.stretches = [_stretch(program, count) for count in CHUNKS] if program.parts == 1 else []

    def run(self, task: Task, position: Position, first: int, seen: FloatArray, report: FloatArray) -> Stop:
        place = _Place(position.memory, position.own, position.level, position.cell)
        at, trust = first, 0
        while at < len(task.fed):
            if self._may_stretch(task, place):
                done = self._stretch(task, at, place, seen, report, trust)
                trust = 0 if done == CHUNKS[trust] else 1
                at += done
                if done:
                    continue
            before = place.position
            status = self._sample(task, at, place, seen, report)
            if status != Status.DONE:
                cell = self._cell(task, place.memory)
                return Stop(status, at, before, cell - task.first_cell, place.level)
            at += 1
        return Stop(Status.DONE, at, place.position, 0, 0)

    def _cell(self, task: Task, memory: FloatArray) -> int:
        if not self.program.varies:
            return task.first_cell
        return math.floor(float(memory[self.program.step.layout.coordinates - 1]) / CELL + 0.5)

    def _may_stretch(self, task: Task, place: _Place) -> bool:
        return bool(self.stretches) and place.level == 0 and place.cell == self._cell(task, place.memory)

    def _stretch(self, task: Task, at: int, place: _Place, seen: FloatArray, report: FloatArray, size: int) -> int:
        """Samples of one step each; how many of them held."""
        count = CHUNKS[size]
        part = task.fed[at : at + count]
        padded = part if len(part) == count else np.vstack([part, np.repeat(part[-1:], count - len(part), axis=0)])
        fixed = task.fixed[0, place.cell - task.first_cell, 0]
        still = np.concatenate([fixed, task.settings, task.values])
        begin = np.concatenate([place.memory, place.own])
        states, judged = (rows[: len(part)] for rows in _rows(self.stretches[size], begin, padded, still))
        memories, owns = np.split(states, [len(place.memory)], axis=1)
        shown, (change, error) = judged[:, :-2], judged[:, -2:].T
        held = (change < 1.0) & (error <= 1.0)
        if self.program.varies:
            starts = np.vstack([place.memory, memories[:-1]])
            held &= np.array([self._cell(task, memory) == place.cell for memory in starts])
        good = len(part) if held.all() else int(np.argmin(held))
        if good == 0:
            return 0
        seen[at : at + good] = shown[:good]
        report[0] += good
        report[2] += good * STRETCH_SWEEPS
        report[4] = max(report[4], error[:good].max())
        report[7] = max(report[7], change[:good].max())
        place.memory, place.own = memories[good - 1].copy(), owns[good - 1].copy()
        return good

    def _sample(self, task: Task, at: int, place: _Place, seen: FloatArray, report: FloatArray) -> Status:
        program, row = self.program, task.fed[at]
        own_after, held, shown = _called(program.before, place.memory, place.own, row, task.settings, task.values)
        start, inputs = row[-1], held.reshape(program.parts, -1)
        for part in range(program.parts):
            status = self._advance(task, part, place, inputs[part], start, report)
            if status != Status.DONE:
                return status
            start += task.spans[part]
        (after,) = _called(program.after, place.memory, own_after, row, task.settings, task.values)
        place.own, seen[at] = own_after, np.concatenate([shown, after])
        return Status.DONE

    def _advance(
        self, task: Task, part: int, place: _Place, held: FloatArray, start: float, report: FloatArray
    ) -> Status:
        whole, at = 1 << DEEPEST, 0
        while at < whole:
            length, share = whole >> place.level, at / whole
            time, cell = start + share * task.spans[part], self._cell(task, place.memory)
            index = cell - task.first_cell
            if not 0 <= index < len(task.made):
                return Status.OFF_GRID
            if not task.made[index, place.level]:
                return Status.NEEDS_CONSTANTS
            fixed = task.fixed[part, index, place.level]
            if place.cell != cell:
                (place.memory,) = _called(
                    self.program.step.watch, place.memory, held, share, time, fixed, task.values
                )  # fmt: skip
                place.cell = cell
            after, error = self._attempt(place.memory, held, share, time, fixed, task.values, report)
            if not 0.0 <= error <= 1.0 and place.level < DEEPEST:
                place.level += 1
                report[1] += 1
                continue
            if error < 0.0:
                return Status.NO_SOLUTION
            if error > 1.0:
                report[3] += 1
                report[5] += error
            report[4], report[6] = max(report[4], error), max(report[6], place.level)
            report[0] += 1
            place.memory, at = after, at + length
            if place.level > 0 and error < COARSER and at % (2 * length) == 0:
                place.level -= 1
        return Status.DONE

    def _attempt(
        self, memory: FloatArray, held: FloatArray, place: float, time: float, fixed: FloatArray, values: FloatArray,
        report: FloatArray,
    ) -> tuple[FloatArray, float]:  # fmt: skip
        step = self.program.step
        base, guess = step.begin(memory, held, place, time, fixed)
        before = 1e300
        for sweep in range(SWEEPS):
            guess, found = step.iterate(memory, base, guess, time, fixed, values)
            change = float(found)
            report[2] += 1
            if change < 1.0 or not change < 1e290 or (sweep > 3 and change > before):
                break
            before = change
        if not change < 1.0:
            return memory, -1.0
        report[7] = max(report[7], change)
        after, error = _called(step.finish, memory, held, place, guess, fixed)
        return after, float(error[0]) if error[0] < 1e290 else -1.0


def _called(function: ca.Function, *arguments: Expression) -> list[FloatArray]:
    return [np.array(value).ravel() for value in function.call(list(arguments))]


def _rows(function: ca.Function, *arguments: FloatArray) -> list[FloatArray]:
    """Results of a function as one row per column, from arguments given likewise; without CasADi's own conversions."""
    buffer, evaluate = function.buffer()
    given = [np.ascontiguousarray(argument, dtype=float).ravel() for argument in arguments]
    results = [np.zeros(function.numel_out(i)) for i in range(function.n_out())]
    for i, argument in enumerate(given):
        buffer.set_arg(i, argument.data)  # type: ignore[call-arg]  # the stub is that of the C++ method
    for i, result in enumerate(results):
        buffer.set_res(i, result.data)  # type: ignore[call-arg]
    evaluate()
    return [result.reshape(function.size2_out(i), function.size1_out(i)) for i, result in enumerate(results)]


def _stretch(program: Program, count: int) -> ca.Function:
    """So many samples of one step each: (memory and own, fed, constants) -> (the same after, [seen, sweep, error])."""
    step = program.step
    fed_size, own_size = program.before.size1_in(2), program.before.size1_in(1)
    names = {"memory": step.layout.memory, "own": own_size, "fed": fed_size, "fixed": step.begin.size1_in(4)}
    memory, own, fed, fixed = (ca.SX.sym(name, size) for name, size in names.items())
    settings = ca.SX.sym("settings", program.before.size1_in(3))
    values = ca.SX.sym("values", program.before.size1_in(4))
    own_after, held, shown = program.before(memory, own, fed, settings, values)
    time = fed[fed_size - 1]
    base, guess = step.begin(memory, held, 0, time, fixed)
    change = ca.SX(0)
    for _ in range(STRETCH_SWEEPS):
        guess, change = step.iterate(memory, base, guess, time, fixed, values)
    after, error = step.finish(memory, held, 0, guess, fixed)
    seen = ca.vertcat(shown, program.after(after, own_after, fed, settings, values))
    # one column of states and one of constants: mapaccum hands them on without a function around each sample
    state, still = ca.vertcat(memory, own), ca.vertcat(fixed, settings, values)
    one = ca.Function("one", [state, fed, still], [ca.vertcat(after, own_after), ca.vertcat(seen, change, error)])
    chunk = one.mapaccum("chunk", count)
    begin, series = ca.MX.sym("begin", one.size1_in(0)), ca.MX.sym("fed", one.size1_in(1), count)
    constants = ca.MX.sym("still", one.size1_in(2))
    outputs = chunk(begin, series, ca.repmat(constants, 1, count))
    return ca.Function("stretch", [begin, series, constants], [outputs[0], outputs[1]])
