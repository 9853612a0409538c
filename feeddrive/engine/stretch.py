"""Stretches of samples with one step each as one CasADi function, for runs without a compiler.

The virtual machine takes about as long for one scalar instruction as for a whole vector instruction that multiplies a
matrix. So what is linear in a step, most of it, is a product of matrices (MX), and only commands and effects are
scalars (SX).
"""

from __future__ import annotations

from collections.abc import Callable

import casadi as ca
import numpy as np

from feeddrive.engine.program import Program
from feeddrive.engine.step.step_constants import propagator_shapes, unflatten
from feeddrive.engine.virtual_machine import Called
from feeddrive.typing import Expression, FloatArray

BLOCK = 32
"""Samples that share one copy of the constants inside the virtual machine."""


class Stretch:
    """So many blocks of samples of one step each, with so many Newton corrections."""

    def __init__(self, program: Program, sweeps: int, blocks: int) -> None:
        parts = _Parts(program, sweeps)
        self.count = BLOCK * blocks
        self._computed, self._plain = parts.computed, parts.plain
        self._function = Called(_joined(parts, blocks))

    def take(self, begin: FloatArray, fed: FloatArray, still: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """The samples `fed`, (n, f), n at most `count`, from memory and own at the first; `still` is constant.

        Constants are those of the step, settings, values. Gives memory and own after every sample; what is seen; first
        and last correction and error, over their limits.
        """
        lacking = self.count - len(fed)
        padded = np.vstack([fed, np.repeat(fed[-1:], lacking, axis=0)]) if lacking else fed
        states, computed, judged = (rows[: len(fed)] for rows in self._function(begin, padded, still))
        seen = np.empty((len(fed), len(self._computed) + len(self._plain)))
        seen[:, self._computed] = computed
        known = np.hstack([np.vstack([begin, states[:-1]]), fed])
        seen[:, list(self._plain)] = known[:, list(self._plain.values())]
        return states, seen, judged


def _joined(parts: _Parts, blocks: int) -> ca.Function:
    """(begin; fed, a column a sample; still) -> a column a sample: state after, what is computed to be seen, judged."""
    block = parts.block()
    begin, still = ca.MX.sym("begin", block.size1_in(0)), ca.MX.sym("still", sum(parts.sizes))
    fed = ca.MX.sym("fed", block.size1_in(1), BLOCK * blocks)
    constants, state = parts.prepared(still), begin
    found: list[list[Expression]] = [[], [], []]
    for rows in ca.horzsplit(fed, BLOCK):
        results = block(state, rows, *constants)
        state = results[0][:, BLOCK - 1]
        for series, result in zip(found, results, strict=True):
            series.append(result)
    return ca.Function("stretch", [begin, fed, still], [ca.horzcat(*series) for series in found])


class _Parts:
    """The functions that a sample consists of; `state` is the memory, then the commands' own.

    Attributes:
        plain: column of what is seen to where it stands in state and fed, for what is nothing but that.
        computed: the other columns.
    """

    def __init__(self, program: Program, sweeps: int) -> None:
        self.program, self.step, self.layout = program, program.step, program.step.layout
        self.sweeps = sweeps
        before = program.before
        self.sizes = [self.step.iterate.size1_in(4), before.size1_in(3), before.size1_in(4)]
        self.early = [row for row in self.step.read if row < self.layout.states]
        self.state = ca.SX.sym("state", self.layout.memory + before.size1_in(1))
        self.fed = ca.SX.sym("fed", before.size1_in(2))
        self.fixed, self.settings, self.values = (ca.SX.sym("given", size) for size in self.sizes)
        self.memory, self.own = self.state[: self.layout.memory], self.state[self.layout.memory :]
        self._given = [self.memory, self.own, self.fed, self.settings, self.values]
        known = {entry.element_hash(): at for at, entry in enumerate(ca.vertsplit(ca.vertcat(self.state, self.fed)))}
        shown = before.call(self._given)[2]
        found = [known.get(shown[k].element_hash()) for k in range(shown.numel())]
        self.plain = {k: at for k, at in enumerate(found) if at is not None}
        rest = range(shown.numel() + program.after.size1_out(0))
        self.computed = [k for k in rest if k not in self.plain]

    def prepared(self, still: Expression) -> list[Expression]:
        """Constants as a block takes them: as they are, and as the matrices of the linear part."""
        fixed, settings, values = ca.vertsplit(still, [0, *(int(at) for at in np.cumsum(self.sizes))])
        shapes = propagator_shapes(self.layout)
        blocks = unflatten(fixed, shapes)
        rows = [[blocks[k][row, :] for row in self.early] for k in (0, 1)]
        by_state, by_input = (ca.vertcat(*rows[k], blocks[4 + k]) for k in (0, 1))
        others = ca.MX(by_state.shape[0], self.state.numel() - self.layout.states)
        return [fixed, settings, values, ca.horzcat(by_state, others), by_input, ca.horzcat(*blocks[6:])]

    def block(self) -> ca.Function:
        """`BLOCK` samples, one after the other."""
        shapes = [constant.shape for constant in self.prepared(ca.MX.sym("still", sum(self.sizes)))]
        constants = [ca.MX.sym("constant", *shape) for shape in shapes]
        begin, fed = ca.MX.sym("begin", self.state.numel()), ca.MX.sym("fed", self.fed.numel(), BLOCK)
        sample, state = self._sample(), begin
        found: list[list[Expression]] = [[], [], []]
        for row in ca.horzsplit(fed):
            results = sample(state, row, constants)
            state = results[0]
            for series, result in zip(found, results, strict=True):
                series.append(result)
        return ca.Function("block", [begin, fed, *constants], [ca.horzcat(*series) for series in found])

    def _sample(self) -> Callable[[Expression, Expression, list[Expression]], tuple[Expression, ...]]:
        """(state, fed, constants) -> (state after, seen, judged), of MX expressions."""
        command, after, solved = self._command(), self._after(), self._solved()
        early = len(self.early)

        def sample(state: Expression, row: Expression, constants: list[Expression]) -> tuple[Expression, ...]:
            fixed, settings, values, state_map, input_map, force_map = constants
            own, held, shown = command(state, row, settings, values)
            free = ca.mac(input_map, held, ca.mtimes(state_map, state))
            forces, kept, judged = solved(state, held, row, free, fixed, values)
            following = ca.vertcat(ca.mac(force_map, forces, free[early:]), kept, own)
            seen = ca.vertcat(shown, after(following, row, settings, values)) if after.size1_out(0) else shown
            return following, seen, judged

        return sample

    def _command(self) -> ca.Function:
        """(state, fed, settings, values) -> (own after, held inputs, what is computed to be seen)."""
        own, held, shown = self.program.before.call(self._given)
        computed = [k for k in self.computed if k < shown.numel()]
        return ca.Function("command", [self.state, *self._given[2:]], ca.cse([own, held, shown[computed]]))

    def _after(self) -> ca.Function:
        """(state, fed, settings, values) -> seen at the end of the sample."""
        return ca.Function("after", [self.state, *self._given[2:]], ca.cse(self.program.after.call(self._given)))

    def _solved(self) -> ca.Function:
        """(state; held inputs; fed; states without node forces, as the step takes them; constants, values)
        -> (node forces; memory after but for the states; first and last correction, error).
        """
        step, time = self.step, self.fed[self.fed.numel() - 1]
        held = ca.SX.sym("held", self.layout.inputs)
        free = ca.SX.sym("free", len(self.early) + self.layout.states)
        base, guess = step.open(self.memory, held, 0, self.fixed, free)
        guess, first = step.iterate(self.memory, base, guess, time, self.fixed, self.values)
        change = first
        for _ in range(self.sweeps - 1):  # taken where it is needed alone, as the compiled driver does
            again, smaller = step.iterate(self.memory, base, guess, time, self.fixed, self.values)
            guess, change = (ca.if_else(change < 1.0, old, new) for old, new in ((guess, again), (change, smaller)))
        kept, error = step.close(self.memory, guess, self.fixed)
        results = [guess[: 2 * len(self.layout.forced)], kept, ca.vertcat(first, change, error)]
        given = [self.state, held, self.fed, free, self.fixed, self.values]
        return ca.Function("solved", given, ca.cse(results))
