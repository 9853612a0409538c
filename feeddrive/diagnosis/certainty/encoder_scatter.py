"""How much what the encoder's steps say of fitted coordinates scatters, on motions that are drawn.

    s_db = J_db' (f(A) - f(A_d))_b,    S = Σ_b Σ_d (s_db - s_b) (s_db - s_b)' / (D - 1)

| symbol | meaning | unit |
|---|---|---|
| A, A_d | motion that is expected, and those that would be if it were the true one (`motion.encoder_error`) | rad |
| f, J_d | what the machine with its effects makes of a motion, whitened, and its slopes at A_d | 1 |
| b | block of time: what the steps do in one says nothing of the next | |
| s_b, D | mean over the draws, and how many they are | 1 |

The colour of a residual (`noise_colour`) takes slopes for exact. At a measured motion they hold the error that the
residual holds, where a resonance magnifies it most of all: sums of their products scattered twice as much there as
sums of the residual with slopes of the true motion. What all draws share in s_b is not here. Drawn motions hold, at a
pole of the load, what the true one lacks, and said ten deviations where values were off by one; frequencies of much
error count for little instead. Source: Carroll et al., Measurement Error in Nonlinear Models (2006), chapter 5 (errors
that are simulated once more).
"""

from __future__ import annotations

from collections.abc import Sequence
from weakref import WeakKeyDictionary

import numpy as np

from feeddrive.diagnosis.finding.remembered import effects_key
from feeddrive.diagnosis.likelihood.coordinates import coordinate_ends, read_coordinates, write_coordinates
from feeddrive.diagnosis.likelihood.encoder_along import drawn_rows
from feeddrive.diagnosis.likelihood.folds import blocks_in_time
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.motion.predictability import has_play
from feeddrive.effects.base import Effect
from feeddrive.typing import FloatArray

_known: WeakKeyDictionary[object, dict[object, FloatArray]] = WeakKeyDictionary()


def encoder_scatter(problem: Problem, effects: Sequence[Effect], steps: FloatArray) -> FloatArray:
    """S of the coordinates of effects, (k, k).

    0 where every encoder tells its motion, and beside a free play, whose contacts no slope at another motion tells.

    Args:
        problem: recordings.
        effects: all fitted.
        steps: by which a coordinate is moved for its slope, (k,).
    """
    count = max((len(e.at_draws) for e in problem.evidence), default=0)
    if count < 2 or has_play(problem.machine(effects).effects):
        return np.zeros((len(steps), len(steps)))
    at_hand = _known.setdefault(problem.evidence[0], {})
    known = problem.calibration
    key = (effects_key(effects), problem.evidence[1:], () if known is None else (known.variance, *known.coordinates))
    if key not in at_hand:
        at_hand[key] = _scatter(problem, effects, steps, count)
    return at_hand[key]


def _scatter(problem: Problem, effects: Sequence[Effect], steps: FloatArray, count: int) -> FloatArray:
    blocks = blocks_in_time(problem)
    here, (_, high) = read_coordinates(effects, problem.plant), coordinate_ends(effects, problem.plant)
    steps = np.where(here + steps <= high, steps, -steps)
    plants = [problem.machine(effects)]
    for i, step in enumerate(steps):
        there = here.copy()
        there[i] += step
        plants.append(problem.machine(write_coordinates(effects, problem.plant, there)))
    expected, scores = drawn_rows(problem, plants[0], None), []
    for draw in range(count):
        base, *others = (drawn_rows(problem, plant, draw) for plant in plants)
        left = expected - base
        scores.append([
            np.bincount(blocks, np.nan_to_num((other - base) / step * left))
            for other, step in zip(others, steps, strict=True)
        ])  # fmt: skip
    beside = np.asarray(scores)
    beside -= np.mean(beside, axis=0)
    result: FloatArray = np.einsum("dib,djb->ij", beside, beside) / (count - 1)
    return result
