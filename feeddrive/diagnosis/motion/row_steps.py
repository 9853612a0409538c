"""How many rows one step of the driven simulation takes: as many as no comparison tells from one.

What is compared lies in a band far below the rate of a fast recording. A step of k rows follows the motion without
what is faster than the steps. How much that changes is what both say of the same plant, all rows together:

    |f_k(plant) - f_1(plant)| / σ <= `UNSEEN`      in the band, over the noise

No value that is fitted to these rows is moved by more of its deviations than that by the predictions, as a projection
is no longer than what is projected; slopes are differences of runs, and ask for a tolerance of their own
(`simulate_steps`). The error is mostly that of the cubic between the steps, and grows with their fourth power: from
what one length misses the next one to try follows. Where friction turns or a bristle breaks away the engine takes
shorter steps by itself.
"""

from __future__ import annotations

import numpy as np

from feeddrive.diagnosis.likelihood.evidence import UNSEEN, Evidence
from feeddrive.diagnosis.likelihood.predictor import Predictor
from feeddrive.diagnosis.motion.axis_evidence import AxisEvidence
from feeddrive.plant.plant import Plant
from feeddrive.simulate.driven import GRID


def in_longest_steps(evidence: AxisEvidence, plant: Plant, predictor: Predictor[AxisEvidence]) -> AxisEvidence:
    """A recording simulated in the longest steps up to `GRID` that no comparison of this plant tells from its rows."""
    return _unseen(evidence, plant, predictor, int(GRID / evidence.recording.sample_time + 1e-6))


def in_told_steps(evidence: Evidence, plant: Plant, predictor: Predictor[AxisEvidence]) -> Evidence:
    """A recording with its steps as they are where this plant allows them; with shorter ones where it does not."""
    if not isinstance(evidence, AxisEvidence):
        return evidence
    return _unseen(evidence, plant, predictor, evidence.motion.every)


def _unseen(evidence: AxisEvidence, plant: Plant, predictor: Predictor[AxisEvidence], every: int) -> AxisEvidence:
    if every <= 1:
        return evidence
    whole, rows = evidence.in_steps(1), evidence.thinned(evidence.counted)
    true = predictor.predict(plant, whole)
    while every > 1:
        there = evidence.in_steps(every)
        told = predictor.predict(plant, there)
        series = {name: told[name] - true[name] for name in whole.channels}
        missed = float(np.linalg.norm(whole.weighted(series, rows)))
        if missed <= UNSEEN:
            return there
        every = min(every - 1, int(every * (UNSEEN / missed) ** 0.25)) if np.isfinite(missed) else 1
    return whole
