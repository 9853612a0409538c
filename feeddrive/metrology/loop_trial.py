"""What a cascade does on a plant in one case: margins, bandwidths, a step and a small circle."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from feeddrive.errors import InputError
from feeddrive.metrology.circular import Circular
from feeddrive.metrology.evaluate import evaluate
from feeddrive.metrology.response import StepResponse
from feeddrive.plant.plant import Plant
from feeddrive.servo.cascade import Cascade
from feeddrive.servo.loop_response import Loop, closed_figures, closed_response
from feeddrive.servo.margins import GROWTH
from feeddrive.servo.mechanics_response import Case
from feeddrive.simulate.scenario.scenario import ScenarioResult
from feeddrive.simulate.setpoints.trial_motions import Trial, circle_about, run_trial, step_at
from feeddrive.tuning.recommendation import Reached, reached_in

_LOWEST, _HIGHEST = 1.0, 4000.0


@dataclass(frozen=True)
class Ran:
    """A motion that was run, and its figure."""

    result: ScenarioResult
    figure: StepResponse | Circular


@dataclass(frozen=True)
class LoopTrial:
    """What a cascade does in one case.

    Attributes:
        reached: margins of both loops and growth of the worst eigenvalue.
        bandwidths: -3 dB of the closed velocity and position loop [Hz].
        step, circle: None where the loop is unstable, at rest, or the step did not end.
    """

    reached: Reached
    bandwidths: tuple[float, float]
    step: Ran | None
    circle: Ran | None

    @property
    def stable(self) -> bool:
        """Whether the whole loop is."""
        return self.reached.growth < GROWTH and self.reached.velocity.stable


def try_loop(plant: Plant, cascade: Cascade, case: Case) -> LoopTrial:
    """Margins and bandwidths in a case; in motion also the step and the circle, with friction and limits.

    Raises:
        InputError: as `servo.linear_loop.sampled_plant`.
    """
    reached = reached_in(plant, cascade, case)
    bandwidths = tuple(
        closed_figures(closed_response(plant, cascade, loop, case, _LOWEST, _HIGHEST)).bandwidth for loop in Loop
    )
    trial = LoopTrial(reached, (bandwidths[0], bandwidths[1]), None, None)
    if not trial.stable or not case.velocity:
        return trial
    step, circle = (_ran(plant, cascade, case, make(plant, case.position)) for make in (step_at, circle_about))
    return LoopTrial(reached, trial.bandwidths, step, circle)


def _ran(plant: Plant, cascade: Cascade, case: Case, trial: Trial) -> Ran | None:
    result = run_trial(plant, cascade, case, trial)
    try:
        (evaluated,) = evaluate(result)
    except InputError:
        return None  # a step that friction holds has no height
    assert isinstance(evaluated.figure, StepResponse | Circular)
    return Ran(result, evaluated.figure)


def glitch(circle: Ran | None) -> float:
    """Largest quadrant glitch [m]; NaN where no circle was run."""
    if circle is None or not isinstance(circle.figure, Circular):
        return math.nan
    return float(np.max(np.abs(circle.figure.glitch)))


def deviation(circle: Ran | None) -> float:
    """Circular deviation [m]; NaN where no circle was run."""
    return circle.figure.deviation if circle is not None and isinstance(circle.figure, Circular) else math.nan


def settling(step: Ran | None) -> float:
    """Settling time of the step to 2 % [s]; NaN where no step was run."""
    return step.figure.settling if step is not None and isinstance(step.figure, StepResponse) else math.nan


def overshoot(step: Ran | None) -> float:
    """Overshoot of the step as a share of its height; NaN where no step was run."""
    return step.figure.overshoot if step is not None and isinstance(step.figure, StepResponse) else math.nan
