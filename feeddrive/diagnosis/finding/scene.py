"""What a start can be read from: the present residual and motion of every recording, and what a candidate is."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.motion.axis_evidence import AxisEvidence
from feeddrive.effects.base import Effect
from feeddrive.plant.plant import Plant
from feeddrive.simulate.driven import LoadMotion
from feeddrive.typing import FloatArray


@dataclass(frozen=True)
class Scene:
    """What a start can be read from: the present residual of every recording.

    Attributes:
        problem: declared plant and recordings.
        found: effects found so far.
        residuals: per recording, channel to measured less predicted in the band, shape (n,).
        runs: per recording, the motion of the load side; none where temperatures alone are predicted.
    """

    problem: Problem
    found: tuple[Effect, ...]
    residuals: tuple[dict[str, FloatArray], ...]
    runs: tuple[LoadMotion, ...] = ()

    @property
    def plant(self) -> Plant:
        """The declared plant."""
        return self.problem.plant

    @property
    def longest(self) -> int:
        """Index of the recording with the most fitted samples."""
        return int(np.argmax([e.fit_rows.sum() for e in self.problem.evidence]))

    def evened(self, at: int, name: str) -> FloatArray:
        """What is left of a channel of the recording number `at`, (n,), each frequency weighed by what is no law's.

        An encoder's steps shake a drive at its resonances: the strongest sines there are none of the machine. What is
        left beyond sensor and encoder is the laws' that are missing, which are taken to miss every frequency alike.
        """
        evidence, left = self.problem.evidence[at], self.residuals[at][name]
        if not isinstance(evidence, AxisEvidence) or name not in evidence.gains:
            return left
        beyond = float(np.mean(left[evidence.fit_rows] ** 2)) - evidence.known_to(name) ** 2
        return evidence.beside_misfit(name, max(beyond, 0.0)).evened(name, left, 1)


def scene_of(problem: Problem, found: Sequence[Effect]) -> Scene:
    """What starts are read from, after the effects found so far."""
    plant, residuals, runs = problem.machine(found), [], []
    for evidence in problem.evidence:
        predicted = problem.predictor.predict(plant, evidence)
        residuals.append({name: evidence.measured[name] - predicted[name] for name in evidence.channels})
        runs.append(problem.predictor.load_motion(plant, evidence))
    return Scene(problem, tuple(found), tuple(residuals), tuple(run for run in runs if run is not None))


@dataclass(frozen=True)
class Candidate:
    """An effect to try.

    Attributes:
        name: effect name.
        forms: started separately, each a list of values of which the best is refined.
        needs: why the recordings cannot show it, or an empty text.
        scanned: whether the starts are compared as they are; otherwise after one step of the fit.
        brief: whether a brief passage of the recording may be all that shows it.
    """

    name: str
    forms: Callable[[Any], list[list[Effect]]]
    needs: Callable[[Any], str]
    scanned: bool = False
    brief: bool = False
