"""What a start can be read from: the present residual and motion of every recording, and what a candidate is."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from feeddrive.diagnose.fit import Problem
from feeddrive.effects.base import Effect
from feeddrive.simulate.driven import LoadMotion
from feeddrive.typing import FloatArray


@dataclass(frozen=True)
class Scene:
    """What a start can be read from: the present residual and motion of every recording.

    Attributes:
        problem: declared plant and recordings.
        found: effects found so far.
        residuals: per recording, channel to measured less predicted in the band, shape (n,).
        runs: per recording, the motion of the load side.
    """

    problem: Problem
    found: tuple[Effect, ...]
    residuals: tuple[dict[str, FloatArray], ...]
    runs: tuple[LoadMotion, ...]

    @property
    def longest(self) -> int:
        """Index of the recording with the most fitted samples."""
        return int(np.argmax([e.fit_rows.sum() for e in self.problem.evidence]))


@dataclass(frozen=True)
class Candidate:
    """An effect to try.

    Attributes:
        name: effect name.
        forms: started separately, each a list of values of which the best is refined.
        needs: why the recordings cannot show it, or an empty text.
        scanned: whether the starts are compared as they are; otherwise after one step of the fit.
    """

    name: str
    forms: Callable[[Scene], list[list[Effect]]]
    needs: Callable[[Scene], str]
    scanned: bool = False


def scene_of(problem: Problem, found: Sequence[Effect]) -> Scene:
    """The scene after the effects found so far."""
    plant = problem.plant.with_effects(*found)
    residuals, runs = [], []
    for evidence in problem.evidence:
        predicted = problem.predictor.predict(plant, evidence)
        residuals.append({name: evidence.measured[name] - predicted[name] for name in evidence.channels})
        runs.append(problem.predictor.load_motion(plant, evidence))
    return Scene(problem, tuple(found), tuple(residuals), tuple(runs))
