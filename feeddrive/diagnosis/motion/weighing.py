"""Gains on the frequencies of a series, at the samples that are asked for."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.fft import irfft, next_fast_len, rfft

from feeddrive.typing import ComplexArray, FloatArray


@dataclass(frozen=True)
class Weighing:
    """Gains on the frequencies of a series, for many series of one length that are asked for at every k-th sample.

    The gains are a circular convolution. Of its taps and of the series every k-th belong together, and what they make
    are the asked samples alone: k transforms of a k-th of the length there, one back. A length with large prime factors
    takes several times longer to transform; the series is continued by itself then, to twice the length or more.

    Attributes:
        spectra: of the taps that belong together, (k, f).
        count: samples of a series.
        size: samples that are transformed at a time.
    """

    spectra: ComplexArray
    count: int
    size: int

    @classmethod
    def of(cls, gains: FloatArray, count: int, every: int = 1) -> Weighing:
        """Ready a gain at each frequency of a series of so many samples, (count // 2 + 1,)."""
        rows = -(-count // every)
        whole = rows * every == count and next_fast_len(rows, real=True) == rows
        size = rows if whole else next_fast_len(2 * rows - 1, real=True)
        taps = np.zeros(rows * every)
        taps[:count] = irfft(gains, count)
        return cls(rfft(taps.reshape(rows, every).T[::-1], size), count, size)

    def __call__(self, series: FloatArray) -> FloatArray:
        """The series, (count,), with its frequencies weighed, at every k-th sample from the first on."""
        every = len(self.spectra)
        rows = -(-self.count // every)
        length = rows if self.size == rows else 2 * rows - 1
        begin = (every * (rows - length - 1) + 1) % self.count  # what precedes the first asked sample comes first
        missing = length * every - (self.count - begin)
        past = np.concatenate([series[begin:], series[:missing], series[: max(missing - self.count, 0)]])
        together = np.zeros((every, self.size))
        together[:, :length] = past[: length * every].reshape(length, every).T
        spectra = rfft(together)
        found: FloatArray = irfft(np.einsum("pf,pf->f", spectra, self.spectra), self.size)
        return found[length - rows : length]
