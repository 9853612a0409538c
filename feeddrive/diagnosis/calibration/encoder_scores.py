"""What the encoder's steps draw declared values by: the sums K' r that they alone make, on motions that are drawn.

    s_db = K_db' (f(A) - f(A_d))_b,    S_encoder = β β' + Σ_b Σ_d (s_db - s_b) (s_db - s_b)' / (D - 1),    β = Σ_b s_b

| symbol | meaning | unit |
|---|---|---|
| A, A_d | motion that is expected, and those that would be if it were the true one (`motion.encoder_error`) | rad |
| f, K_d | what the declared plant makes of a motion over the noise, and its slopes with the values at A_d | 1 |
| b | block of time: what the steps do in one says nothing of the next | |
| s_b, D | mean over the draws, and how many they are | 1 |

The colour of a residual (`noise_colour`) knows how much an error scatters, not that slopes at a measured motion hold
the same error: a damping that is told near a resonance alone is drawn by several of its deviations. Both are here, what
all draws share in β and what they scatter by in the sum. That of a few draws over the whole recording would say of as
many directions alone how far the steps draw values, and of the others that they do not; blocks that scatter each by
itself add up to all directions. Source: Carroll et al., Measurement Error in Nonlinear Models (2006), chapter 5 (errors
that are simulated once more).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from weakref import WeakKeyDictionary

import numpy as np

from feeddrive.diagnosis.calibration.declared import CalibratedValue, with_values
from feeddrive.diagnosis.likelihood.folds import block_of_rows
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.motion.axis_evidence import AxisEvidence
from feeddrive.diagnosis.motion.preparing import BLOCK
from feeddrive.typing import FloatArray

STEP = 3e-3
"""Change of the logarithm of a value from which a slope is taken: its sign and size are enough."""

_known: WeakKeyDictionary[AxisEvidence, dict[tuple[str, float], FloatArray]] = WeakKeyDictionary()


def encoder_scores(problem: Problem) -> FloatArray:
    """S_encoder of the values that are fitted, (k, k); 0 where no recording holds an encoder's error."""
    known = problem.calibration
    assert known is not None
    total = np.zeros((len(known.values), len(known.values)))
    for e in problem.evidence:
        if isinstance(e, AxisEvidence) and e.drawn and known.values:
            at_hand = _known.setdefault(e, {})
            asked = [value for value in known.values if (value.key, value.deviation) not in at_hand]
            if asked:
                scores = _scores(problem, e, asked)
                at_hand |= {(one.key, one.deviation): part for one, part in zip(asked, scores, strict=True)}
            scores = np.stack([at_hand[value.key, value.deviation] for value in known.values], axis=-1)
            shared = np.mean(scores, axis=0)
            drawn_by, beside = np.sum(shared, axis=0), (scores - shared).reshape(-1, len(known.values))
            total += np.outer(drawn_by, drawn_by) + beside.T @ beside / max(len(e.drawn) - 1, 1)
    return total


def _scores(problem: Problem, evidence: AxisEvidence, asked: Sequence[CalibratedValue]) -> FloatArray:
    """s_db of one recording along some of its values, (values, draws, blocks)."""
    rows, plants = evidence.thinned(evidence.fit_rows), [problem.plant]
    long = replace(evidence, block=max(evidence.block, BLOCK))
    blocks = np.tile(block_of_rows(long, np.flatnonzero(rows)), len(evidence.channels))
    plants += [with_values(problem.plant, (value,), np.array([STEP / value.deviation])) for value in asked]
    expected = evidence.weighted(problem.predictor.predict(plants[0], evidence), rows)
    scores = []
    for at in evidence.at_draws:
        here, *others = (at.weighted(problem.predictor.predict(plant, at), rows) for plant in plants)
        scores.append([np.bincount(blocks, (other - here) * (expected - here)) * value.deviation / STEP
                       for other, value in zip(others, asked, strict=True)])  # fmt: skip
    return np.moveaxis(np.asarray(scores), 1, 0)
