"""A repeated servo cycle over hours: milliseconds of the drive and minutes of heat in one run.

    heat of a cycle at the present temperatures -> Q, g;   C dθ/dt = -K(g) θ + B Q over a macro step h;   new values

One cycle is simulated tick by tick, its losses averaged; the thermal model takes them over a macro step, at whose end
the cycle runs again with the values of the drive at the temperatures then (`thermal.coupling`):

    θ* = θ_n + ∫ (Q_n),      θ_(n+1) = θ_n + ∫ (Q_n + Q*) / 2,      Q* of the cycle at θ*

so that the coupling is of second order in h at one cycle a step. The difference of the two is the error of the first
order; h is chosen so that it stays at `tolerance`, and the second-order result is kept. While nothing changes, h grows.

Validity: temperatures change little within a cycle (h is never shorter than one); the nut is averaged over its travel;
the screw is held at its front end and free to grow at the other; the bed keeps its temperature and length.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from feeddrive.errors import InputError
from feeddrive.simulate.scenario.scenario import Scenario
from feeddrive.simulate.warm.warm_up_cycle import Cycle, ServoCycle
from feeddrive.simulate.warm.warm_up_result import RunEnergy, WarmUpPoint, WarmUpRun
from feeddrive.thermal.full.full_model import FRONT, NUT, REAR, SHAFT
from feeddrive.thermal.reduced.parametric_model import HeatModel, Path
from feeddrive.thermal.run.energy_balance import with_ledger
from feeddrive.typing import FloatArray

OBSERVED = (NUT, SHAFT, FRONT, REAR)
"""Outputs whose error chooses the macro step: those that the drive's values depend on."""

_SUBSTEP = 20.0
_FIRST, _LONGEST = 30.0, 1200.0
_MOST_STEPS = 5000

Progress = Callable[[float], None]
"""Called with the share of the run that is done."""


@dataclass(frozen=True)
class MacroSteps:
    """How the macro step is chosen.

    Attributes:
        tolerance: of the first-order coupling in one step [K].
        fixed: length of every step in its place [s]; None for the tolerance.

    Raises:
        InputError: a value that is not above zero.
    """

    tolerance: float = 0.05
    fixed: float | None = None

    def __post_init__(self) -> None:
        for name, value in (("tolerance", self.tolerance), ("fixed", self.fixed)):
            if value is not None and not (math.isfinite(value) and value > 0):
                raise InputError(f"{value:g} is not possible", f"macro steps, {name}", "write a value above zero")


def run_warm_up(
    scenario: Scenario, duration: float, steps: MacroSteps | None = None, progress: Progress | None = None
) -> WarmUpRun:
    """Repeat a scenario's motion for hours.

    Args:
        scenario: one cycle of a machine that declares heat and how it is joined to the motion: it must end where it
            began, at rest; the ambient of its heat is that of the run, and the start.
        duration: of the run [s].
        steps: how macro steps are chosen; None for the default tolerance.
        progress: called after every macro step.

    Returns:
        What happened at the macro steps.

    Raises:
        InputError: a scenario that is no cycle, a nut that leaves the shaft, a preload that is lost, a body that is
            not there, a duration shorter than a cycle, a machine without heat.
        SimulationError: a motion that cannot be followed.

    Warns:
        ValidityWarning: viscosity or speed outside the range of their laws.
    """
    cycle = ServoCycle(scenario)
    if not (math.isfinite(duration) and duration >= cycle.duration):
        raise InputError(
            f"{duration:g} s is shorter than the cycle", "duration", f"write {cycle.duration:.3g} s or more"
        )
    return _Marching(cycle, steps or MacroSteps(), duration, progress or (lambda share: None)).run()


class _Marching:
    """The macro steps of one run."""

    def __init__(self, cycle: ServoCycle, steps: MacroSteps, duration: float, progress: Progress) -> None:
        self.cycle, self.steps, self.duration, self.progress = cycle, steps, duration, progress
        self.model: HeatModel = with_ledger(cycle.heat_model())
        self.observed = np.vstack([self.model.readings[name] for name in OBSERVED])
        self.refused = 0

    def run(self) -> WarmUpRun:
        time, state = 0.0, np.zeros(self.model.order)
        now = self.cycle.at(self.model, state)
        points, energy = [self._point(0.0, state, now)], RunEnergy.zero()
        length = self.steps.fixed or _FIRST
        while time < self.duration * (1 - 1e-12):
            if len(points) + self.refused > _MOST_STEPS:
                raise InputError(
                    f"{_MOST_STEPS} macro steps reach {time / 3600:.3g} h", "tolerance", "write a larger one"
                )
            length = min(max(length, self.cycle.duration), self.duration - time)
            after, corrected, error = self._attempt(state, now, length, time)
            if self._too_far(error, length):
                self.refused += 1
                length *= max(0.3, 0.9 * math.sqrt(self.steps.tolerance / error))
                continue
            energy = energy.plus(now, after, length)
            time, state, now = time + length, corrected, after
            points.append(self._point(time, state, now))
            self.progress(time / self.duration)
            length = self._next(length, error)
        stored = float(self.model.capacity[:-1] @ state[:-1])
        return WarmUpRun(
            tuple(points), energy.closed(float(state[-1]), stored), self.cycle.duration, self.cycle.count, self.refused,
            self.cycle.stops, self.cycle.thermal, self.cycle.scenario.name,
        )  # fmt: skip

    def _attempt(self, state: FloatArray, now: Cycle, length: float, time: float) -> tuple[Cycle, FloatArray, float]:
        """Cycle at the predicted end, the corrected state there, and the largest difference of the two [K]."""
        predicted = self._heated(state, now, now, length)
        after = self.cycle.at(self.model, predicted, time + length)
        corrected = self._heated(state, now, after, length)
        return after, corrected, float(np.max(np.abs(self.observed @ (corrected - predicted))))

    def _heated(self, state: FloatArray, first: Cycle, last: Cycle, length: float) -> FloatArray:
        """The state after `length` under the mean of two cycles."""
        conductances: dict[Path, float] = {
            path: (g + last.conductances[path]) / 2 for path, g in first.conductances.items()
        }
        given = np.zeros(len(self.model.input_names))
        for name, power in first.heats.items():
            given[self.model.input_names.index(name)] = (power + last.heats[name]) / 2
        substeps = max(math.ceil(length / _SUBSTEP), 2)
        return self.model.at(conductances).stepper(length, substeps)(state, given)

    def _too_far(self, error: float, length: float) -> bool:
        shortest = length <= self.cycle.duration * (1 + 1e-9)
        return self.steps.fixed is None and error > self.steps.tolerance and not shortest

    def _next(self, length: float, error: float) -> float:
        if self.steps.fixed is not None:
            return self.steps.fixed
        growth = 0.9 * math.sqrt(self.steps.tolerance / max(error, 1e-12))
        return min(length * min(max(growth, 0.5), 2.0), _LONGEST)

    def _point(self, time: float, state: FloatArray, cycle: Cycle) -> WarmUpPoint:
        start = self.cycle.thermal.ambient
        named = {name: start + float(row @ state) for name, row in self.model.readings.items() if "growth" not in name}
        return WarmUpPoint(time, named, cycle)
