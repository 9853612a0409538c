"""Recordings drawn from the package's own prediction with fresh noise: quick, and exact in what they lack."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from feeddrive.diagnosis.finding.attempt import compared
from feeddrive.diagnosis.finding.search import Search
from feeddrive.diagnosis.judging.judge import Judged, prepared_for_judging
from feeddrive.diagnosis.judging.result import Trial
from feeddrive.diagnosis.likelihood.fit import fit
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.motion.axis_evidence import AxisEvidence
from feeddrive.diagnosis.motion.prediction import AxisPredictor
from feeddrive.diagnosis.motion.preparing import prepare
from feeddrive.effects.base import Effect
from feeddrive.plant.plant import Plant
from tests.recovery.planted import axis_plant, pair


def drawn(plant: Plant, evidence: AxisEvidence, planted: Sequence[Effect], seed: int) -> AxisEvidence:
    """The recording as the plant with the planted effects would give it, with white sensor noise of the same size."""
    generator = np.random.default_rng(seed)
    exact = AxisPredictor().predict(plant.with_effects(*planted), evidence)
    noisy = {
        name: exact[name]
        + evidence.noise[name] / evidence.band.noise_gain * evidence.band.filter(generator.standard_normal(len(series)))
        for name, series in exact.items()
    }
    return replace(evidence, measured=noisy)


def settled(
    planted: Sequence[Effect], taken: Sequence[Effect], rival: Effect, seed: int
) -> tuple[Search, list[Judged]]:
    """A search that took `taken` on the bench, the rival tried in the round of the first of them, and its judging."""
    plant = axis_plant("bench")
    fitted, judged = (prepare(one, plant, share) for one, share in zip(pair("bench", "null"), (1.0, 0.0), strict=True))
    problem = Problem(plant, (drawn(plant, fitted, planted, seed),), AxisPredictor())
    found = fit(problem, taken)
    tried = compared(problem, rival.name, fit(problem, [rival]), [])
    trials = (Trial(1, taken[0].name, tried.comparison.gain, tried.comparison.standard_error, True),)
    search = Search(problem, found, trials, ((tried,),), {})
    after = plant.with_effects(*found.effects)
    return search, [prepared_for_judging(problem, drawn(plant, judged, planted, seed + 1), plant, after)]
