"""What a run consists of: the step of the plant, and what is done at the samples before and after it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import IntEnum

import casadi as ca
import numpy as np

from feeddrive.simulate.step import StepModel
from feeddrive.simulate.step_constants import Linear, step_constants
from feeddrive.typing import FloatArray

DEEPEST = 12
"""Halvings of a step at most: a sample of 1 ms is cut into 0.25 µs where contact or break-away asks for it."""

TOLERANCE = 1e-11
"""Error of the table position that one step may make [m]; a thousandth of a good scale's resolution."""


class Status(IntEnum):
    """Why a run ended."""

    DONE = 0
    NEEDS_LEVEL = 1
    NO_SOLUTION = 2


@dataclass(frozen=True)
class Program:
    """Functions of a run, all CasADi SX; `values` are the plant's parameters.

    Attributes:
        step: of the plant.
        before: (memory, own, fed, settings, values) -> (own after, held per part, one after the other, seen). Called
            at every sample; the last entry of `fed` is the time of the sample [s].
        after: (memory, own, fed, settings, values) -> seen, at the end of the sample.
        parts: parts of a sample with an input of their own.
    """

    step: StepModel
    before: ca.Function
    after: ca.Function
    parts: int

    @property
    def functions(self) -> tuple[ca.Function, ...]:
        """Every function that a run calls."""
        return (self.before, self.step.begin, self.step.iterate, self.step.finish, self.after)

    @property
    def sizes(self) -> dict[str, int]:
        """Sizes by the names that the C driver gives them."""
        return {
            "N_MEMORY": self.step.layout.memory,
            "N_OWN": self.before.size1_in(1),
            "N_FED": self.before.size1_in(2),
            "N_PARTS": self.parts,
            "N_HELD": self.step.layout.inputs,
            "N_FIXED": self.step.begin.size1_in(4),
            "N_BASE": self.step.begin.size1_out(0),
            "N_UNKNOWN": self.step.layout.unknowns,
            "N_BEFORE": self.before.size1_out(2),
            "N_AFTER": self.after.size1_out(0),
            "DEEPEST": DEEPEST,
        }


@dataclass(frozen=True)
class StepReport:
    """How the steps of a run went.

    Attributes:
        samples, steps: of the run; equal where one step a sample was enough.
        refused: steps taken again at half their length.
        sweeps: Newton corrections.
        finest: shortest step, as halvings of the longest.
        last_sweep: largest last correction, over its limit of 1e-9 of the force or of full scale; below 1.
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
        told = "; ".join(part for part in (finer, jumps) if part) or "one step a sample was enough"
        return f"finished: {self.steps} steps for {self.samples} samples; {told}"


REPORTS = 8
"""Entries of the driver's report: steps, refused, sweeps, over, worst, excess, finest, last sweep."""


@dataclass(frozen=True)
class Task:
    """The numbers of a run.

    Attributes:
        fed: per sample, shape (n, f), the time [s] last.
        spans: length of the parts [s], shape (p,).
        settings: of the commands, shape (s,).
        values: of the plant, shape (v,).
        table: constants of the steps, shape (p, levels, c).
        tolerance: error of the table position that a step may make [m]; infinite for steps of fixed length.
    """

    fed: FloatArray
    spans: FloatArray
    settings: FloatArray
    values: FloatArray
    table: FloatArray
    tolerance: float

    def deeper(self, program: Program, linear: Linear, levels: int) -> Task:
        """The task with constants for more levels."""
        made = self.table.shape[1]
        more = [
            [
                step_constants(linear, program.step.layout, span / 2**level, 0.5**level, self.tolerance)
                for level in range(made, levels)
            ]
            for span in self.spans
        ]
        return replace(self, table=np.concatenate([self.table, np.array(more)], axis=1))


@dataclass(frozen=True)
class Position:
    """Where a run is: everything that it needs to go on.

    Attributes:
        memory: of the step, shape (m,).
        own: of the commands, shape (o,).
        level: halvings of the last step.
    """

    memory: FloatArray
    own: FloatArray
    level: int = 0
