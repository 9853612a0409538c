"""What a run consists of: the step of the plant, and what is done at the samples before and after it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import IntEnum
from functools import cached_property

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from feeddrive.engine.step.step import StepModel
from feeddrive.typing import FloatArray

DEEPEST = 12
"""Halvings of a step at most: a sample of 1 ms is cut into 0.25 µs where contact or break-away asks for it."""

CELL = 0.005
"""Width of the cells of table position over which a chain that varies is frozen [m]; the rest acts as a force."""

NO_CELL = -(2**40)
"""Cell of a position whose forces are not yet known."""

TOLERANCE = 1e-11
"""Error of the table position that one step may make [m]; a thousandth of a good scale's resolution."""


class Status(IntEnum):
    """Why a run ended."""

    DONE = 0
    NEEDS_CONSTANTS = 1
    NO_SOLUTION = 2
    OFF_GRID = 3


@dataclass(frozen=True)
class Program:
    """Functions of a run, all CasADi SX; `values` are the plant's parameters.

    Attributes:
        step: of the plant.
        before: (memory, own, fed, settings, values) -> (own after, held per part, one after the other, seen). Called
            at every sample; the last entry of `fed` is the time of the sample [s].
        after: (memory, own, fed, settings, values) -> seen, at the end of the sample.
        parts: parts of a sample with an input of their own.
        varies: whether the chain depends on the table position.
        tangents: whether runs carry along how they change with parameters.
    """

    step: StepModel
    before: ca.Function
    after: ca.Function
    parts: int
    varies: bool
    tangents: bool = False

    @property
    def functions(self) -> tuple[ca.Function, ...]:
        """Functions that are generated for the driver; what is the same for every plant stands in it."""
        functions = (self.before, self.step.watch, self.step.iterate, self.after)
        return (*functions, self.step.tangent, self.before_tangent) if self.tangents else functions

    @property
    def before_tangent(self) -> ca.Function:
        """(arguments of `before`, then how memory, own, settings, values change) -> how its results change."""
        symbols = [ca.SX.sym(f"given_{i}", self.before.size1_in(i)) for i in range(5)]
        moving = [symbols[i] for i in (0, 1, 3, 4)]
        changes = [ca.SX.sym(f"change_{i}", symbol.numel()) for i, symbol in enumerate(moving)]
        outputs = self.before.call(symbols)
        changed = [ca.jtimes(output, ca.vertcat(*moving), ca.vertcat(*changes)) for output in outputs]
        return ca.Function("feeddrive_before_tangent", [*symbols, *changes], changed)

    @cached_property
    def sizes(self) -> dict[str, int]:
        """Sizes by the names that the C driver gives them."""
        layout, step = self.step.layout, self.step
        return {
            "N_MEMORY": layout.memory,
            "N_STATES": layout.states,
            "N_FORCED": len(layout.forced),
            "N_BRISTLES": layout.bristles,
            "N_SOLVED": max(len(layout.forced), layout.bristles),
            "N_WATCHED": layout.watched,
            "N_HELD": layout.inputs,
            "N_UNKNOWN": layout.unknowns,
            "N_FIXED": step.iterate.size1_in(4),
            "N_BASE": step.iterate.size1_in(1),
            "N_READ": len(step.read),
            "N_OWN": self.before.size1_in(1),
            "N_FED": self.before.size1_in(2),
            "N_PARTS": self.parts,
            "N_BEFORE": self.before.size1_out(2),
            "N_AFTER": self.after.size1_out(0),
            "DEEPEST": DEEPEST,
            "DRIVEN": int(layout.driven),
            "VARIES": int(self.varies),
            "TANGENTS": int(self.tangents),
            "N_SETTINGS": self.before.size1_in(3),
            "N_VALUES": self.before.size1_in(4),
            "TABLE": layout.coordinates - 1,
        }


@dataclass(frozen=True)
class StepReport:
    """How the steps of a run went.

    Attributes:
        samples, steps: of the run; equal where one step a sample was enough.
        refused: steps taken again at half their length.
        sweeps: Newton corrections.
        finest: shortest step, as halvings of the longest.
        last_sweep: largest last correction, over its limit (`step_constants.converged`); below 1.
        over: steps that stayed above the tolerance at the finest level: at jumps of a force.
        excess: sum of the errors estimated there [m].
        tolerance: error of the table position allowed per step [m].
    """

    samples: int
    steps: int
    refused: int
    sweeps: int
    finest: int
    last_sweep: float
    over: int
    excess: float
    tolerance: float

    def __str__(self) -> str:
        finer = f"{self.refused} steps were halved, down to 1/{2**self.finest} of a sample" if self.refused else ""
        jumps = (
            f"{self.over} steps stayed above the tolerance, by {1e9 * self.excess:.3g} nm in all" if self.over else ""
        )
        steps_taken = "; ".join(part for part in (finer, jumps) if part) or "one step a sample was enough"
        return f"finished: {self.steps} steps for {self.samples} samples; {steps_taken}"


def joined(reports: Sequence[StepReport]) -> StepReport:
    """The report of runs that follow one another."""
    samples, steps, refused, sweeps, over, excess = (
        sum(getattr(report, name) for report in reports)
        for name in ("samples", "steps", "refused", "sweeps", "over", "excess")
    )
    finest, last_sweep = max(r.finest for r in reports), max(r.last_sweep for r in reports)
    return StepReport(samples, steps, refused, sweeps, finest, last_sweep, over, excess, reports[0].tolerance)


REPORTS = 9
"""Entries of the driver's report: steps, refused, sweeps, over, worst, excess, finest, last sweep, sum of all seen."""


@dataclass(frozen=True)
class Task:
    """The numbers of a run.

    Attributes:
        fed: per sample, shape (n, f), the time [s] last.
        spans: length of the parts [s], shape (p,).
        settings: of the commands, shape (s,).
        values: of the plant, shape (v,).
        fixed: constants of the steps, shape (p, cells, levels, c); filled in place when they are asked for.
        made: which of them are there, shape (cells, levels).
        first_cell: number of the first cell; cell k is `CELL` wide about the table position k `CELL`.
        tangents: where the program has them.
    """

    fed: FloatArray
    spans: FloatArray
    settings: FloatArray
    values: FloatArray
    fixed: FloatArray
    made: NDArray[np.uint8]
    first_cell: int
    tangents: Tangents | None = None


@dataclass(frozen=True)
class Tangents:
    """How a run changes in d directions; filled in by the driver, which moves `memory` and `own` on.

    Attributes:
        memory: states and bristles, shape (d, m).
        own: of the commands, shape (d, o).
        settings, values: the directions, shapes (d, s) and (d, v).
        fixed: of the constants, shape (d, p, cells, levels, c), filled in as those are.
        on_fixed: whether a direction changes the constants, shape (d,).
        seen: shape (d, n, before).
    """

    memory: FloatArray
    own: FloatArray
    settings: FloatArray
    values: FloatArray
    fixed: FloatArray
    on_fixed: NDArray[np.uint8]
    seen: FloatArray


@dataclass(frozen=True)
class Position:
    """Where a run is: everything that it needs to go on.

    Attributes:
        memory: of the step, shape (m,).
        own: of the commands, shape (o,).
        level: halvings of the last step.
        cell: in which the memory's forces are known; `NO_CELL` before the first step.
    """

    memory: FloatArray
    own: FloatArray
    level: int = 0
    cell: int = NO_CELL


@dataclass(frozen=True)
class Stop:
    """Where the driver stopped, and why.

    Attributes:
        status: why.
        sample: that was not finished; the number of samples where all were.
        position: at its start.
        cell, level: of the constants that are missing, the cell counted from the first.
    """

    status: Status
    sample: int
    position: Position
    cell: int
    level: int


Run = Callable[[Task, Position, int, FloatArray, FloatArray], Stop]
"""(task, position, first sample, seen (n, s), report (9,)) -> where it stopped; seen and report are filled in place."""
