"""How a run changes with parameters, carried along in CasADi's virtual machine: what `driver_tangents.c` does compiled.

The functions of the step are differentiated here as they stand, so that no equation is written again. One call serves
all directions.
"""

from __future__ import annotations

import casadi as ca
import numpy as np

from feeddrive.engine.program import Program, Tangents, Task
from feeddrive.engine.step.step import StepModel
from feeddrive.engine.virtual_machine import Called
from feeddrive.symbolic_turn import SYMBOLS
from feeddrive.typing import FloatArray


class CarriedTangents:
    """The changes of the runs of one program."""

    def __init__(self, program: Program) -> None:
        self._program = program
        self._made: dict[int, tuple[Called, Called]] = {}

    def along(self, task: Task) -> SampleTangents | None:
        """What carries along the tangents of a task; None where it has none."""
        if task.tangents is None:
            return None
        count = len(task.tangents.values)
        if count not in self._made:
            with SYMBOLS.taken():
                self._made[count] = (
                    _for_all(self._program.before_tangent, count, 5),
                    _for_all(_step_tangent(self._program.step), count, 7),
                )
        return SampleTangents(self._program, task, task.tangents, *self._made[count])


class SampleTangents:
    """The changes of one run; those of the task are moved on in place."""

    def __init__(self, program: Program, task: Task, tangents: Tangents, before: Called, step: Called) -> None:
        self.task, self.tangents = task, tangents
        self._before, self._step = before, step
        self._held = (len(tangents.values), program.parts, program.step.layout.inputs)
        self._history = np.zeros((len(tangents.values), program.step.layout.memory - tangents.memory.shape[1]))

    def begin(self, sample: int, memory: FloatArray, own: FloatArray) -> None:
        """What the commands make of the changes, seen at a sample."""
        task, t = self.task, self.tangents
        changes = (np.hstack([t.memory, self._history]), t.own, t.settings, t.values)
        found = self._before(memory, own, task.fed[sample], task.settings, task.values, *changes)
        own_after, held, seen = (part.reshape(len(t.values), -1) for part in found)
        t.seen[:, sample] = seen
        self._kept, self._own_after, self._inputs = t.memory.copy(), own_after, held.reshape(self._held)

    def move(
        self, part: int, index: int, level: int, memory: FloatArray, held: FloatArray, place: float, time: float,
        guess: FloatArray,
    ) -> None:  # fmt: skip
        """One accepted step, solved by `guess`; the constants are those of a part, cell and level."""
        task, t = self.task, self.tangents
        changes = (
            np.hstack([t.memory, self._history]),
            self._inputs[:, part],
            t.fixed[:, part, index, level],
            t.values,
        )
        fixed = task.fixed[part, index, level]
        (after,) = self._step(memory, held, place, time, fixed, guess, task.values, *changes)
        t.memory[:] = after.reshape(t.memory.shape)

    def finish(self) -> None:
        """The sample is done."""
        self.tangents.own[:] = self._own_after

    def take_back(self) -> None:
        """The sample is to be tried again."""
        self.tangents.memory[:] = self._kept


def _step_tangent(step: StepModel) -> ca.Function:
    """(memory, input, place, time, fixed, guess, values, then how memory, input, fixed and values change) -> how states
    and bristles after the step change.
    """
    memory, held, place, time, fixed = (ca.SX.sym("given", step.begin.size1_in(i)) for i in range(5))
    guess, values = (ca.SX.sym("given", step.iterate.size1_in(i)) for i in (2, 5))
    moving = (memory, held, fixed, values)
    changes = [ca.SX.sym("change", symbol.numel()) for symbol in moving]
    of_memory, of_held, of_fixed, of_values = changes
    base, _ = step.begin(memory, held, place, time, fixed)
    of_base = ca.jtimes(base, ca.vertcat(memory, held, fixed), ca.vertcat(of_memory, of_held, of_fixed))
    of_guess = step.tangent(memory, base, guess, time, fixed, values, of_memory, of_base, of_fixed, of_values)
    after, _ = step.finish(memory, held, place, guess, fixed)
    carried = after[: step.layout.states + step.layout.bristles]
    given, given_changes = ca.vertcat(memory, held, guess, fixed), ca.vertcat(of_memory, of_held, of_guess, of_fixed)
    result = ca.jtimes(carried, given, given_changes)
    return ca.Function("step_tangent", [memory, held, place, time, fixed, guess, values, *changes], ca.cse([result]))


def _for_all(function: ca.Function, count: int, shared: int) -> Called:
    """The function for so many directions at once; the first `shared` arguments are those of all."""
    return Called(function.map(f"{function.name()}_for_all", "serial", count, list(range(shared)), []))
