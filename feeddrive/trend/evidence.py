"""Evidence of what a series did: how likely its values are under a level and some courses, sizes integrated out.

    y = a + X b + e,    e ~ N(0, s^2 K),    p(a, s) ~ 1/s,    b ~ N(0, n s^2 (X' K^-1 X)^-1)

    log p(y | X, K) = -1/2 log |K| - 1/2 log (1' K^-1 1) - (n-1)/2 log S0 - (n-1)/2 log(1 - n/(1+n) R^2) - k/2 log(1+n)

S0 is the whitened sum of squares about the level, R^2 the share of it that the courses take. The prior of b holds as much
information as one value (Zellner's g-prior, g = n; R. E. Kass and L. Wasserman, JASA 90, 1995), so that no size has to be
set. Source of the closed form: F. Liang et al., Mixtures of g priors, JASA 103 (2008), eq. (5).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.special import logsumexp

from feeddrive.trend.atoms import Atom, candidates, courses
from feeddrive.trend.noise import Noise, noises
from feeddrive.typing import FloatArray

LEAST_LEFT = 1e-12
"""Of a candidate's or the values' squared length that others leave: less is rounding."""


@dataclass(frozen=True, eq=False)
class Timeline:
    """Times and weights of a series, with all that does not depend on its values.

    Attributes:
        time: ascending, (n,).
        variance: relative, (n,).
    """

    time: FloatArray
    variance: FloatArray

    @cached_property
    def settings(self) -> tuple[Noise, ...]:
        """The noise that may be."""
        return noises(self.time, self.variance)

    @cached_property
    def tried(self) -> tuple[Atom, ...]:
        """Candidates."""
        return candidates(self.time)

    @cached_property
    def white_tried(self) -> tuple[FloatArray, ...]:
        """Candidates in white noise, (n, m) for each setting, in single precision: they are only ranked."""
        columns = courses(self.tried, self.time)
        return tuple(noise.white(columns).astype(np.float32) for noise in self.settings)


@dataclass(frozen=True, eq=False)
class Series:
    """Values of one quantity over the recordings.

    Attributes:
        line: their times.
        values: (n,), scaled to a spread of one for the sake of rounding.
    """

    line: Timeline
    values: FloatArray

    def evidence(self, atoms: Sequence[Atom]) -> FloatArray:
        """log p(y | atoms, K) for each setting of the noise, (h,)."""
        return np.array([self._parts(atoms, noise)[0] for noise in self.line.settings])

    def with_one_more(self, atoms: Sequence[Atom]) -> FloatArray:
        """log p(y | atoms and one candidate), settings of the noise summed out, (m,)."""
        count = len(self.values)
        shrink = count / (1 + count)
        found = np.empty((len(self.line.settings), len(self.line.tried)))
        for row, (noise, white) in enumerate(zip(self.line.settings, self.line.white_tried, strict=True)):
            given, total, basis, left = self._parts(atoms, noise)
            inside = (basis.T.astype(np.float32) @ white).astype(float)
            length = np.einsum("ij,ij->j", white, white, dtype=float)
            beyond = length - np.sum(inside**2, axis=0)
            possible = beyond > 1e-5 * length  # single precision
            along = (left.astype(np.float32) @ white).astype(float)
            gain = np.where(possible, along**2 / np.where(possible, beyond, 1.0), 0.0) / total
            before = 1 - shrink * (1 - float(left @ left) / total)
            after = np.clip(before - shrink * gain, LEAST_LEFT, None)
            better = -0.5 * (count - 1) * (np.log(after) - np.log(before)) - 0.5 * np.log(1 + count)
            found[row] = given + np.where(possible, better, -np.inf)
        summed: FloatArray = logsumexp(found, axis=0)
        return summed

    def _parts(self, atoms: Sequence[Atom], noise: Noise) -> tuple[float, float, FloatArray, FloatArray]:
        """Log evidence, S0, an orthonormal basis of level and courses, and what they leave, in white noise."""
        count = len(self.values)
        level = noise.white(np.ones(count))
        whole = noise.white(self.values)
        size = float(level @ level)
        about = whole - level * (float(level @ whole) / size)
        total = max(float(about @ about), LEAST_LEFT)
        columns = np.column_stack([level, noise.white(courses(list(atoms), self.line.time))])
        basis, triangle = np.linalg.qr(columns)
        kept = np.abs(np.diag(triangle)) > 1e-9 * np.linalg.norm(columns, axis=0)
        basis = basis[:, kept]
        left = about - basis @ (basis.T @ about)
        share = 1 - float(left @ left) / total
        log = (
            -0.5 * noise.log_determinant - 0.5 * np.log(size) - 0.5 * (count - 1) * np.log(total)
            - 0.5 * (count - 1) * np.log(max(1 - count / (1 + count) * share, LEAST_LEFT))
            - 0.5 * (int(kept.sum()) - 1) * np.log(1 + count)
        )  # fmt: skip
        return log, total, basis, left

    def estimate(self, atoms: Sequence[Atom]) -> tuple[FloatArray, FloatArray, float]:
        """Level and sizes of the courses, (1 + k,), their covariance, and the scatter of a value about them.

        Over the settings of the noise, each by its evidence.
        """
        weights = np.exp(self.evidence(atoms) - logsumexp(self.evidence(atoms)))
        columns = np.column_stack([np.ones(len(self.values)), courses(list(atoms), self.line.time)])
        freedom = max(1, len(self.values) - columns.shape[1])
        sizes, spreads, scatters = [], [], []
        for noise in self.line.settings:
            white, y = noise.white(columns), noise.white(self.values)
            inverse = np.linalg.pinv(white.T @ white)
            size = inverse @ (white.T @ y)
            variance = float(np.sum((y - white @ size) ** 2)) / freedom
            sizes.append(size)
            spreads.append(variance * inverse)
            scatters.append(variance)
        mean = np.einsum("h,hk->k", weights, np.array(sizes))
        about = np.array(sizes) - mean
        spread = np.einsum("h,hij->ij", weights, np.array(spreads)) + np.einsum("h,hi,hj->ij", weights, about, about)
        return mean, spread, float(np.sqrt(weights @ np.array(scatters)))
