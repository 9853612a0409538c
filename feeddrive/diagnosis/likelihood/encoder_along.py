"""What an encoder's steps alone say for one set of effects against another.

    v = max(1/D Σ_d δ_d' ε_d / |δ_d|, 0)²,    δ_d = W (f_B(A_d) - f_A(A_d)),    ε_d = W (f_A(A) - f_A(A_d))

| symbol | meaning | unit |
|---|---|---|
| A, A_d | motion that is expected, and those that would be if it were the true one (`motion.encoder_error`) | rad |
| f_A, f_B | what the machines with the set of fewer values and with the other make of a motion, over the noise | 1 |
| W | takes out what declared values within their tolerances may do (`Calibration`) | 1 |
| v | square of the mean, over D draws, of what a machine of the set A alone gives for B along the difference | 1 |

A residual's own spectrum tells how much an error scatters, not that the answer of a plant to the measured motion holds
the same error: a mode, a softer spring, a mass answer the motor as a filter does, and take away what they are asked
with. That is as large in every block of a recording, so that blocks left out do not show it. What a machine of the
first set gives for the second where the encoder alone is at work is here, in the mean over draws: what they all share.
Where that is less than nothing the steps speak against the second set, and are no reason for it: a friction that grows
with the load grows with a load that shakes as well, and hid a spring of three times the floor by what it took away.
By what they scatter the residual scatters as well, and its own spectrum counts that; what a mean of D holds of it, a
D-th, is left in. Where either machine has a free play v is the mean of the squares: what the steps do there is at
reversals, and grows with the motion, which no spectrum of a whole residual tells. v is a part of the variance that the
two sets are compared by. Source: Carroll et al., Measurement Error in Nonlinear Models (2006), chapter 5 (errors that
are simulated once more).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from feeddrive.diagnosis.likelihood.evidence import Evidence
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.motion.predictability import has_play
from feeddrive.plant.plant import Plant
from feeddrive.typing import FloatArray


def encoder_along(problem: Problem, plain: Plant, other: Plant) -> float:
    """v of two machines; 0 where every encoder tells its motion, and where no drawn motion can be followed.

    Args:
        problem: recordings, with the declared values of the second set.
        plain: the machine with the set of fewer values, and the declared values that it stands beside.
        other: that with the other set.
    """
    drawn = [e.at_draws for e in problem.evidence]
    count = max((len(draws) for draws in drawn), default=0)
    if not count:
        return 0.0
    expected, along = _rows(problem, plain, problem.evidence), []
    for draw in range(count):
        at = [draws[draw] if draws else e for draws, e in zip(drawn, problem.evidence, strict=True)]
        here = _rows(problem, plain, at)
        difference = _rows(problem, other, at) - here
        length = float(np.linalg.norm(difference))
        along.append(float(difference @ (expected - here)) / length if length > 0 else 0.0)
    known = np.array([one for one in along if np.isfinite(one)])
    if not len(known):
        return 0.0
    plays = has_play((*plain.effects, *other.effects))
    return float(np.mean(known**2)) if plays else max(float(np.mean(known)), 0.0) ** 2


def _rows(problem: Problem, machine: Plant, at: Sequence[Evidence]) -> FloatArray:
    """W times what a machine makes of motions, weighed as the recordings are, (m,); no number measured beside them."""
    parts = [
        e.weighted(problem.predictor.predict(machine, one), e.thinned(e.fit_rows))
        for e, one in zip(problem.evidence, at, strict=True)
    ]
    rows = np.concatenate([*parts, np.zeros(len(problem.numbers))])
    return rows if problem.whitener is None else problem.whitener.applied(rows)
