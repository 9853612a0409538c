"""The colour of what a fit leaves over: how strongly a sum over its samples scatters, whatever its spectrum.

    S = E[(J' r)(J' r)'] = sum_l w(l) gamma(l) (x) sum_t J(t) J(t + l)',    gamma_cd(l) = 1/n sum_t r_c(t) r_d(t + l)

| symbol | meaning | unit |
|---|---|---|
| r | residual over its noise, one row per channel | 1 |
| J | columns whose sums with r are asked for, such as slopes of the prediction | any |
| gamma_cd | covariance of channels c and d at a lag of l samples, zero where samples are left out | 1 |
| w | Parzen's window, zero from two blocks of time on | 1 |

A programme that comes again after T brings again what a drive and its encoder do in it, and N cycles of one error are
one error. The share of noise that comes again, rho, is correlated over every number of cycles:

    gamma(l + k T) = rho gamma(l),  k = 1 .. N - 1,    rho = sum_k sum_t r(t) r(t + k T) / sum_k sum_t r(t)^2

What is more than noise is what laws miss: a comparison of sets takes its own share of it (`likelihood.set_evidence`).

Valid where the residual scatters alike over a recording; `uncertainty` looks after residuals that do not.
Source: Priestley, Spectral Analysis and Time Series (1981), sections 6.2.3 (window) and 7.8 (sums of coloured noise).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.fft import irfft, next_fast_len, rfft
from scipy.signal.windows import parzen

from feeddrive.diagnosis.likelihood.evidence import Evidence
from feeddrive.diagnosis.likelihood.problem import LEVEL
from feeddrive.diagnosis.motion.axis_evidence import AxisEvidence
from feeddrive.diagnosis.motion.cycle import cycle_of
from feeddrive.diagnosis.motion.preparing import BLOCK
from feeddrive.typing import BoolArray, ComplexArray, FloatArray, IntegerArray

WINDOW_FREEDOM = 3.71
"""Degrees of freedom of a spectrum by Parzen's window, times lags over samples (Priestley, table 6.2)."""

WINDOW = 2.0
"""Length of the window in blocks: half as long missed drift of a block's length, twice as long scattered more."""


@dataclass(frozen=True)
class Stretch:
    """The thinned samples of one recording, as they stand in a residual of all recordings.

    Attributes:
        rows: of the residual, all channels one after the other.
        channels: how many.
        floating: numbers of the channels whose mean was taken out.
        noise: mean square of what is noise alone, per channel, (c,).
        places: of a channel's samples on the thinned comb, shape (n,).
        lags: beyond which nothing is correlated but by what comes again, in thinned samples.
        cycle: after which the motion comes again, in thinned samples; 0 where it does not.
    """

    rows: slice
    channels: int
    floating: tuple[int, ...]
    noise: FloatArray
    places: IntegerArray
    lags: int
    cycle: float = 0.0

    @property
    def length(self) -> int:
        """Samples of the comb, those left out among them."""
        return int(self.places[-1]) + 1

    @property
    def size(self) -> int:
        """Length of a Fourier transform in which the end of the comb does not meet its beginning."""
        return int(next_fast_len(self.length + (self.length if self.cycle else self.lags), real=True))

    @property
    def cycles_apart(self) -> FloatArray:
        """Sum of the cosines of all lags of some cycles within the comb, at each frequency, (f,)."""
        turns = 2 * np.pi * np.arange(self.size // 2 + 1) * self.cycle / self.size
        return np.asarray(sum(np.cos(k * turns) for k in range(1, 1 + int((self.length - 1) / self.cycle))))

    def on_comb(self, values: FloatArray) -> FloatArray:
        """Values (m,) or (m, k) of a residual's rows by channel and comb, zero in gaps; shape (c, length[, k])."""
        own = values[self.rows].reshape(self.channels, len(self.places), *values.shape[1:])
        result = np.zeros((self.channels, self.length, *values.shape[1:]))
        result[:, self.places] = own
        return result


def stretches(evidence: Sequence[Evidence], rows: Sequence[BoolArray]) -> Iterator[Stretch]:
    """The recordings of a residual that holds their thinned `rows`, in order; recordings without rows are passed."""
    first = 0
    for one, chosen in zip(evidence, rows, strict=True):
        at = np.flatnonzero(one.thinned(chosen))
        last = first + len(at) * len(one.channels)
        step = one.thinning * one.recording.sample_time
        if len(at):
            lags = max(2, min(round(WINDOW * max(one.block, BLOCK) / step), len(at) // 3))
            floating = tuple(i for i, name in enumerate(one.channels) if name in one.floating)
            places, cycle = (at - at[0]) // one.thinning, cycle_of(one.recording, one.thinning, lags)
            cycle = cycle if cycle <= places[-1] else 0.0  # at least once within the comb
            noise = np.array([one.kept.get(name, 1.0) / one.left.get(name, 1.0) ** 2 for name in one.channels])
            yield Stretch(slice(first, last), len(one.channels), floating, noise, places, lags, cycle)
        first = last


def score_covariance(
    evidence: Sequence[Evidence], rows: Sequence[BoolArray], residual: FloatArray, columns: FloatArray
) -> FloatArray:
    """Covariance of columns' r, the colour taken from the residual itself.

    Args:
        evidence: recordings.
        rows: of each, the samples (before thinning) that the residual holds.
        residual: weighted, shape (m,); rows behind those of the recordings stand for themselves.
        columns: shape (m, k).

    Returns:
        Shape (k, k).
    """
    total = np.zeros((columns.shape[1], columns.shape[1]))
    last = sum(int(one.thinned(chosen).sum()) * len(one.channels) for one, chosen in zip(evidence, rows, strict=True))
    for stretch in stretches(evidence, rows):
        left = rfft(stretch.on_comb(residual), stretch.size, axis=1)
        total += _scatter(np.conj(left)[:, None] * left[None], columns, stretch, _shares_again(left, stretch))
    alone = columns[last:]
    if len(alone):
        # a measured number scatters as one independent value of the recordings does
        squares = np.sum(columns[:last] ** 2, axis=0)
        seen = squares > 0
        total += alone.T @ alone * (float(np.median(np.diag(total)[seen] / squares[seen])) if seen.any() else 1.0)
    return 0.5 * (total + total.T)


def fitted_away(
    evidence: Sequence[Evidence], rows: Sequence[BoolArray], columns: FloatArray, inverse: FloatArray
) -> FloatArray:
    """What `score_covariance` misses of white noise of variance one since the columns were fitted to it.

    A fit takes from the residual just what looks like its columns; a slow column leaves too little at low frequency.
    There the noise's own values are r + P r, P = J (J'J)^-1 J', and this is the same sum for P in place of r r'. The
    free zero of a scale is one more column.

    Args:
        evidence: recordings.
        rows: of each, the samples (before thinning) that the residual holds.
        columns: that were fitted, shape (m, k).
        inverse: of columns' columns, shape (k, k).

    Returns:
        Shape (k, k).
    """
    total = np.zeros_like(inverse)
    for stretch in stretches(evidence, rows):
        slopes = rfft(stretch.on_comb(columns), stretch.size, axis=1)
        pairs = np.einsum("cfi,ij,dfj->cdf", np.conj(slopes), inverse, slopes, optimize=True)
        zero = np.abs(rfft(stretch.on_comb(np.ones(len(columns))), stretch.size, axis=1)[0]) ** 2
        for channel in stretch.floating:
            pairs[channel, channel] += zero / len(stretch.places)
        total += _scatter(pairs, columns, stretch)
    return 0.5 * (total + total.T)


def _shares_again(left: ComplexArray, stretch: Stretch) -> FloatArray | None:
    """Root of rho of each channel, (c,), 0 where more than noise is left; None where the motion does not come again."""
    if not stretch.cycle:
        return None
    met = np.zeros(stretch.length)
    met[stretch.places] = 1.0
    kernels = np.vstack([np.ones(left.shape[1]), stretch.cycles_apart])
    rows, squares = (_sums(np.abs(one) ** 2, kernels, stretch.size) for one in (rfft(met, stretch.size)[None], left))
    pairs = np.where(rows[0, 1] > 0, rows[0, 1] / rows[0, 0], 1.0) * squares[:, 0]
    again = np.clip(squares[:, 1] / np.where(pairs > 0, pairs, 1.0), 0.0, 1.0)
    is_noise = squares[:, 0] / len(stretch.places) * LEVEL**2 < stretch.noise
    shares: FloatArray = np.sqrt(np.where(is_noise, again, 0.0))
    return shares


def _sums(power: FloatArray, kernels: FloatArray, size: int) -> FloatArray:
    """Sums of series' products at lags, (c, j), of their powers (c, f) and the lags' sums of cosines (j, f)."""
    return np.asarray((power * _twice(size)) @ kernels.T / size)


def _twice(size: int) -> FloatArray:
    """Weight of each frequency of one sign in a real sum over all: all but the first, and an even last, count twice."""
    twice = np.full(size // 2 + 1, 2.0)
    twice[0] = 1.0
    if size % 2 == 0:
        twice[-1] = 1.0
    return twice


def _scatter(
    pairs: ComplexArray, columns: FloatArray, stretch: Stretch, again: FloatArray | None = None
) -> FloatArray:  # fmt: skip
    """Covariance of the columns' sums under a periodogram of all pairs of channels, (c, c, f), smoothed; (k, k)."""
    colour = np.conj(_smoothed(pairs, stretch))
    if again is not None:
        colour *= 1.0 + 2.0 * np.multiply.outer(np.outer(again, again), stretch.cycles_apart)
    spectrum = rfft(stretch.on_comb(columns), stretch.size, axis=1)
    weighted = np.einsum("cdf,dfk->cfk", colour * _twice(stretch.size), spectrum, optimize=True)
    total: FloatArray = np.real(np.einsum("cfi,cfk->ik", np.conj(spectrum), weighted, optimize=True)) / stretch.size
    return total


def _smoothed(pairs: ComplexArray, stretch: Stretch) -> ComplexArray:
    """Spectra by Parzen's window, shape (c, c, f)."""
    window = np.zeros(stretch.size)
    half = parzen(2 * stretch.lags + 1)[stretch.lags :]
    window[: len(half)] = half
    window[-stretch.lags :] = half[:0:-1]
    smoothed: ComplexArray = rfft(irfft(pairs, stretch.size, axis=2) * window, axis=2) / len(stretch.places)
    return smoothed


def spectral_freedom(evidence: Sequence[Evidence], rows: Sequence[BoolArray]) -> float:
    """Degrees of freedom of the spectrum at one frequency, all recordings together."""
    return sum(WINDOW_FREEDOM * len(s.places) / s.lags for s in stretches(evidence, rows))


def independent_share(evidence: Evidence) -> float:
    """Independent values per thinned sample where the sensor noise is white: noise power in the band over its comb's.

    A signal in the band meets the noise of one thinned sample with this much of a white sample's information.
    """
    return evidence.thinning * evidence.band.noise_gain**2 if isinstance(evidence, AxisEvidence) else 1.0
