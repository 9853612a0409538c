"""The noise of a series of values, one a recording: scatter from file to file, and what wanders with the days.

    K = (1 - nu) diag(w) + nu exp(-|t_i - t_j| / tau)

| symbol | meaning |
|---|---|
| w | relative variance of a value: 1, more where its recording tells less |
| nu | share of the variance that wanders: lubrication, temperature of the hall |
| tau | time within which it forgets |

Neither nu nor tau is known: every model of a series is judged over all of a grid of them, and the size of K is
integrated out. A series that wanders is thereby not taken for one that changes.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import cholesky, solve_triangular

from feeddrive.typing import FloatArray

SHARES = (0.3, 0.6, 0.9)
MEMORIES = (1.0, 3.0, 10.0, 30.0, 100.0)
"""Of the wandering part, in usual distances of the recordings; half-decades from one file to half a year of days."""


@dataclass(frozen=True, eq=False)
class Noise:
    """All settings of the grid, h of them.

    Attributes:
        whitening: inverse of the lower Cholesky factor of each K, (h, n, n).
        log_determinant: of each K, (h,).
        log_prior: of each setting, (h,): a machine that does not wander is as likely as one that does in any way.
    """

    whitening: FloatArray
    log_determinant: FloatArray
    log_prior: FloatArray

    def white(self, columns: FloatArray) -> FloatArray:
        """Columns, (n, k), as they are where the noise is white and of size one, (h, n, k)."""
        found: FloatArray = self.whitening @ columns
        return found


def noise_of(time: FloatArray, variance: FloatArray) -> Noise:
    """The settings of the grid.

    Args:
        time: of the recordings, ascending, (n,).
        variance: relative, (n,).
    """
    usual = float(np.median(np.diff(time)))
    apart = np.abs(time[:, None] - time[None, :]) / usual
    settings = [(0.0, 1.0), *((share, memory) for share in SHARES for memory in MEMORIES)]
    inverses, logs = [], []
    for share, memory in settings:
        wandering = share * np.exp(-apart / memory) if share else 0.0
        factor = cholesky(np.diag((1 - share) * variance) + wandering, lower=True)
        inverses.append(solve_triangular(factor, np.eye(len(time)), lower=True))
        logs.append(2 * float(np.sum(np.log(np.diag(factor)))))
    prior = np.log([0.5, *([0.5 / (len(settings) - 1)] * (len(settings) - 1))])
    return Noise(np.array(inverses), np.array(logs), prior)
