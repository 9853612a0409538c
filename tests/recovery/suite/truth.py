"""The true plant, in the package's own terms, through the package's own path: its error is the floor."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from feeddrive.diagnosis.judging.judge import channel_results, prepared_for_judging
from feeddrive.diagnosis.judging.result import ChannelResult
from feeddrive.diagnosis.likelihood.evidence import Evidence
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.preparation import prepared
from feeddrive.effects.base import Effect
from feeddrive.plant.plant import Plant
from feeddrive.recording import Recording

Errors = dict[str, float]
"""Channel to rms in the band on the recording that is judged (SI)."""


@dataclass(frozen=True)
class Prepared:
    """A pair of recordings beside the declared plant."""

    problem: Problem
    judged: tuple[Evidence, ...]

    def errors(self, effects: Sequence[Effect]) -> tuple[Errors, Errors]:
        """Errors of the declared plant and of the plant with these effects, on the same samples."""
        before = self.problem.plant
        after = before.with_effects(*effects)
        results = channel_results(
            self.problem, [prepared_for_judging(self.problem, e, before, after) for e in self.judged]
        )
        return _errors(results, "before"), _errors(results, "after")


def prepare_pair(plant: Plant, fitted: Recording, judged: Recording) -> Prepared:
    """The pair, ready for comparison."""
    problem, kept, _ = prepared(plant, [fitted], [judged], 0.75)
    return Prepared(problem, tuple(kept))


def declared_errors(plant: Plant, judged: Recording) -> Errors:
    """Errors of the declared plant on one recording."""
    return prepare_pair(plant, judged, judged).errors(())[0]


def _errors(results: Sequence[ChannelResult], side: str) -> Errors:
    return {result.name: float(getattr(result, side).rms) for result in results}


def worst_ratio(errors: Errors, floor: Errors) -> float:
    """The largest ratio of an error to its floor over the channels."""
    return max(float(np.float64(errors[name]) / floor[name]) for name in floor)
