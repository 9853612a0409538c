"""The driver in CasADi's virtual machine, where no compiler is found: the decisions of `driver.c`, the same numbers.

Stretches that need one step a sample run in chunks inside the virtual machine; where a step is refused, Python takes
that sample and the virtual machine goes on behind it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from feeddrive.engine.interpreted_tangents import CarriedTangents, SampleTangents
from feeddrive.engine.program import CELL, DEEPEST, Position, Program, Run, Status, Stop, Task
from feeddrive.engine.stretch import Stretch
from feeddrive.engine.virtual_machine import Called
from feeddrive.symbolic_turn import SYMBOLS
from feeddrive.typing import FloatArray

LONG, SHORT = 8, 1
"""Blocks per stretch: the longer while all goes well, the shorter behind a refused step."""

SWEEPS = 12
COARSER = 0.02


@dataclass
class _Pace:
    """How stretches are taken: Newton corrections of all their steps, one or two, and blocks."""

    sweeps: int = 1
    blocks: int = LONG


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
        step, functions = program.step, (program.before, program.after)
        self.before, self.after = (Called(function) for function in functions)
        self.watch, self.begin, self.iterate, self.finish = (
            Called(function) for function in (step.watch, step.begin, step.iterate, step.finish)
        )
        self.stretches: dict[tuple[int, int], Stretch] = {}
        self.tangents = CarriedTangents(program)

    def run(self, task: Task, position: Position, first: int, seen: FloatArray, report: FloatArray) -> Stop:
        place, pace = _Place(position.memory, position.own, position.level, position.cell), _Pace()
        at, along = first, self.tangents.along(task)
        while at < len(task.fed):
            if along is None and self._may_stretch(task, place):
                done, refused = self._stretch(task, at, place, seen, report, pace)
                at += done
                if not refused:
                    continue
            before, reported = place.position, report.copy()
            status = self._sample(task, at, place, seen, report, along)
            if status != Status.DONE:
                report[:] = reported
                cell = self._cell(task, place.memory)
                return Stop(status, at, before, cell - task.first_cell, place.level)
            at += 1
        return Stop(Status.DONE, at, place.position, 0, 0)

    def _cell(self, task: Task, memory: FloatArray) -> int:
        if not self.program.varies:
            return task.first_cell
        return math.floor(float(memory[self.program.step.layout.coordinates - 1]) / CELL + 0.5)

    def _may_stretch(self, task: Task, place: _Place) -> bool:
        return self.program.parts == 1 and place.level == 0 and place.cell == self._cell(task, place.memory)

    def _stretch(
        self, task: Task, at: int, place: _Place, seen: FloatArray, report: FloatArray, pace: _Pace
    ) -> tuple[int, bool]:
        """Samples of one step each; how many of them held, and whether the next one is refused."""
        stretch = self._paced(pace)
        part = task.fed[at : at + stretch.count]
        still = np.concatenate([task.fixed[0, place.cell - task.first_cell, 0], task.settings, task.values])
        states, shown, judged = stretch.take(np.concatenate([place.memory, place.own]), part, still)
        memories, owns = states[:, : len(place.memory)], states[:, len(place.memory) :]
        first, change, error = judged.T
        held = (change < 1.0) & (error <= 1.0)
        if self.program.varies:
            starts = np.vstack([place.memory, memories[:-1]])
            # what has run away is in no cell
            held &= [bool(np.isfinite(one).all()) and self._cell(task, one) == place.cell for one in starts]
        good = len(part) if held.all() else int(np.argmin(held))
        if good:
            seen[at : at + good] = shown[:good]
            report[0] += good
            report[2] += good * pace.sweeps
            report[4] = max(report[4], error[:good].max())
            report[7] = max(report[7], change[:good].max())
            report[8] += shown[:good].sum()
            place.memory, place.own = memories[good - 1], owns[good - 1]
        return good, _refused(pace, good, first, change)

    def _paced(self, pace: _Pace) -> Stretch:
        """The stretch of a pace, made when it is first asked for."""
        key = (pace.sweeps, pace.blocks)
        if key not in self.stretches:
            with SYMBOLS.taken():
                if key not in self.stretches:
                    self.stretches[key] = Stretch(self.program, *key)
        return self.stretches[key]

    def _sample(
        self, task: Task, at: int, place: _Place, seen: FloatArray, report: FloatArray, along: SampleTangents | None
    ) -> Status:
        program, row = self.program, task.fed[at]
        own_after, held, shown = self.before(place.memory, place.own, row, task.settings, task.values)
        start, inputs = row[-1], held.reshape(program.parts, -1)
        if along is not None:
            along.begin(at, place.memory, place.own)
        for part in range(program.parts):
            status = self._advance(task, part, place, inputs[part], start, report, along)
            if status != Status.DONE:
                if along is not None:
                    along.take_back()
                return status
            start += task.spans[part]
        (after,) = self.after(place.memory, own_after, row, task.settings, task.values)
        if along is not None:
            along.finish()
        place.own, seen[at] = own_after, np.concatenate([shown, after])
        report[8] += seen[at].sum()
        return Status.DONE

    def _advance(
        self, task: Task, part: int, place: _Place, held: FloatArray, start: float, report: FloatArray,
        along: SampleTangents | None,
    ) -> Status:  # fmt: skip
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
                (place.memory,) = self.watch(place.memory, held, share, time, fixed, task.values)
                place.cell = cell
            after, error, guess = self._attempt(place.memory, held, share, time, fixed, task.values, report)
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
            if along is not None:
                along.move(part, index, place.level, place.memory, held, share, time, guess)
            place.memory, at = after, at + length
            if place.level > 0 and error < COARSER and at % (2 * length) == 0:
                place.level -= 1
        return Status.DONE

    def _attempt(
        self, memory: FloatArray, held: FloatArray, place: float, time: float, fixed: FloatArray, values: FloatArray,
        report: FloatArray,
    ) -> tuple[FloatArray, float, FloatArray]:  # fmt: skip
        """Memory after the step, its error over the tolerance or -1, and what it was solved by."""
        base, guess = self.begin(memory, held, place, time, fixed)
        before = 1e300
        for sweep in range(SWEEPS):
            guess, found = self.iterate(memory, base, guess, time, fixed, values)
            change = float(found[0])
            report[2] += 1
            if change < 1.0 or not change < 1e290 or (sweep > 3 and change > before):
                break
            before = change
        if not change < 1.0:
            return memory, -1.0, guess
        report[7] = max(report[7], change)
        after, error = self.finish(memory, held, place, guess, fixed)
        return after, float(error[0]) if error[0] < 1e290 else -1.0, guess


def _refused(pace: _Pace, good: int, first: FloatArray, last: FloatArray) -> bool:
    """Whether the step behind the good ones is refused; sets the pace of the next stretch."""
    if good == len(first):
        pace.blocks = LONG
        pace.sweeps = 1 if bool((first < 1.0).all()) else 2
        return False
    if pace.sweeps == 1 and not last[good] < 1.0:
        pace.sweeps = 2  # the same steps again
        return False
    pace.blocks = SHORT
    return True
