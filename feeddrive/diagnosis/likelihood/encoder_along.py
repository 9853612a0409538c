"""What an encoder's steps alone say for one set of effects against another.

    v = 1/D Σ_d (δ_d' ε_d)² / δ_d'δ_d,    δ_d = W (f_B(A_d) - f_A(A_d)),    ε_d = W (f_A(A) - f_A(A_d))

| symbol | meaning | unit |
|---|---|---|
| A, A_d | motion that is expected, and those that would be if it were the true one (`motion.encoder_error`) | rad |
| f_A, f_B | what the machines with the set of fewer values and with the other make of a motion, over the noise | 1 |
| W | takes out what declared values within their tolerances may do (`Calibration`) | 1 |
| v | mean square of what a machine of the set A alone gives along the difference of the two, over D draws | 1 |

A residual's own spectrum tells how much an error scatters, not that the answer of a plant to the measured motion holds
the same error: a mode, a softer spring, a mass answer the motor as a filter does, and take away what they are asked
with. That is as large in every block of a recording, so that blocks left out do not show it. What a machine of the
first set gives for the second where the encoder alone is at work is here, in the mean over draws and in their scatter;
it is a part of the variance that the two sets are compared by. Source: Carroll et al., Measurement Error in Nonlinear
Models (2006), chapter 5 (errors that are simulated once more).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.effects.base import Effect
from feeddrive.plant.plant import Plant
from feeddrive.typing import FloatArray


def encoder_along(problem: Problem, machines: tuple[Plant, Plant]) -> float:
    """v of two machines, that of the set of fewer values first; 0 where every encoder tells its motion.

    Args:
        problem: recordings, with the declared values of the second machine.
        machines: with the effects of either set, and the declared values that it stands beside.
    """
    draws = max((len(e.at_draws) for e in problem.evidence), default=0)
    squares = [_along(problem, machines, draw) ** 2 for draw in range(draws)]
    known = [one for one in squares if np.isfinite(one)]
    return float(np.mean(known)) if known else 0.0


def _along(problem: Problem, machines: tuple[Plant, Plant], draw: int) -> float:
    """δ_d' ε_d over the length of δ_d; not a number where a machine cannot follow the motion."""
    differences, errors = [], []
    for e in problem.evidence:
        rows = e.thinned(e.fit_rows)
        at = e.at_draws[draw] if e.at_draws else e
        first, second = (e.weighted(problem.predictor.predict(one, at), rows) for one in machines)
        expected = e.weighted(problem.predictor.predict(machines[0], e), rows)
        differences.append(second - first)
        errors.append(expected - first)
    none = np.zeros(len(problem.numbers))
    difference, error = (_whitened(problem, np.concatenate([*parts, none])) for parts in (differences, errors))
    length = float(np.linalg.norm(difference))
    return float(difference @ error) / length if length > 0 else 0.0


def _whitened(problem: Problem, rows: FloatArray) -> FloatArray:
    return rows if problem.whitener is None else problem.whitener.applied(rows)


def machines_of(
    first: tuple[Problem, Sequence[Effect]], second: tuple[Problem, Sequence[Effect]]
) -> tuple[Plant, Plant]:
    """Machines of two sets, each beside its own declared values, that with fewer effects first."""
    by_size = sorted((first, second), key=lambda one: len(one[1]))
    plain, other = (problem.machine(effects) for problem, effects in by_size)
    return plain, other
