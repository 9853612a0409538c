"""The Cramér-Rao bound of a planted effect's parameters where the noise is coloured.

    I = sum over channels and over |f| <= edge of  conj(J(f)) J(f)^T / (n S(f)),    bound = 1.96 sqrt(diag(I^-1))

| symbol | meaning |
|---|---|
| J(f) | discrete Fourier transform of the prediction's slope with the coordinates, at the true values |
| S(f) | variance per sample that white noise of the density at f would have, from the residual of the true plant |
| n | samples |

Slopes are those of the package's prediction in its own coordinates, at the samples that it fits; the density is
Welch's. No unbiased estimate from this band has narrower intervals. Of heat, what lies along a channel's own rise is
discounted in both by the gain that sensor and model leave open.
Source: S. M. Kay, Fundamentals of statistical signal processing: estimation theory, 1993, section 3.9.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.signal import welch

from feeddrive.diagnosis.likelihood.coordinates import read_coordinates, spread_to_values
from feeddrive.diagnosis.likelihood.evidence import Evidence
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.likelihood.slopes import jacobian_of
from feeddrive.effects.base import Effect

SEGMENT = 1.0
"""Length of Welch's segments [s] in motion; a warm-up, of few rows, is cut into eight."""

NORMAL = 1.96


def bounds(problem: Problem, effects: Sequence[Effect]) -> list[dict[str, float]]:
    """Half width of the narrowest possible 95 % interval per effect and fitted key (SI)."""
    base = problem.predicted(effects)
    slopes = jacobian_of(problem, effects, [True] * len(effects), base)
    information = np.zeros((slopes.shape[1], slopes.shape[1]))
    at, residual = 0, problem.measured - base
    for evidence in problem.evidence:
        rows = int(evidence.thinned(evidence.fit_rows).sum())
        rate = 1 / (evidence.recording.sample_time * evidence.thinning)
        for _ in evidence.channels:
            part = slice(at, at + rows)
            information += fisher(slopes[part], residual[part], rate, _edge(evidence, rate))
            at += rows
    covariance = np.linalg.pinv(information, rcond=1e-14, hermitian=True)
    vector = read_coordinates(effects, problem.plant)
    spread = spread_to_values(effects, problem.plant, vector, covariance)
    return [{key: NORMAL * float(v[0]) for key, v in one.items() if len(v) == 1 and v[0] > 0} for one in spread]


def fisher(slopes: np.ndarray, residual: np.ndarray, rate: float, edge: float) -> np.ndarray:
    """Information of one channel.

    Args:
        slopes: (n, k).
        residual: noise, (n,).
        rate: samples per second [Hz].
        edge: of the band [Hz].

    Returns:
        (k, k).
    """
    count = len(residual)
    segment = min(count, int(SEGMENT * rate) if rate > 1 else count // 8)
    at, density = welch(residual, rate, nperseg=segment)
    frequencies = np.fft.rfftfreq(count, 1 / rate)
    # The first bins of Welch's lack the mean that it takes away.
    variance = np.interp(frequencies, at[2:], density[2:]) * rate / 2
    inside = frequencies <= edge
    transformed = np.fft.rfft(slopes, axis=0)[inside]
    twice = np.where(frequencies[inside] > 0, 2.0, 1.0) / (count * variance[inside])
    result: np.ndarray = np.real(np.conj(transformed).T @ (transformed * twice[:, None]))
    return result


def _edge(evidence: Evidence, rate: float) -> float:
    return min(evidence.edge, 0.5 * rate)
