"""Signals that excite a band: logarithmic sweep, multisine of low crest, pseudo-random binary sequence.

All have amplitude 1 at most (the multisine exactly), and know their exact integral and derivatives, so that they can
be a velocity set-point as well as an excitation of speed or torque.

    sweep      w = sin(b (e^(k t) - 1)),  k = ln(f1 / f0) / T,  b = 2 pi f0 / k
    multisine  w = c sum cos(2 pi f_i t + p_i),  p_i = -pi i (i - 1) / N   (Schroeder)
    PRBS       w = +-1, a maximum-length sequence, each bit held for a while

| symbol | meaning | unit |
|---|---|---|
| f0, f1, T | first and last frequency, duration of the sweep | Hz, Hz, s |
| f_i, N | harmonics of 1 / period within the band, their number | Hz, 1 |
| c | makes the largest value 1 | 1 |

Source: Schroeder, Synthesis of low-peak-factor signals, IEEE Trans. Inf. Theory 16 (1970).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np

from feeddrive.errors import InputError
from feeddrive.typing import FloatArray

_LENGTHS = range(4, 21)
"""Orders of the binary sequence."""

_MOST_HARMONICS = 1e5
"""Harmonics of a multisine at most: 100 s up to 1 kHz. Its crest is sought at 32 times as many places, 26 MB each."""


class Waveform(Protocol):
    """A signal of amplitude 1 over time [s], its integral from 0 and its first two derivatives."""

    @property
    def duration(self) -> float: ...

    def values(self, time: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
        """Integral [s], value [1], derivative [1/s] and second derivative [1/s^2] at times [s], (n,) each."""
        ...


@dataclass(frozen=True)
class Sweep:
    """A sine whose frequency grows by the same factor in equal times, from `low` to `high` [Hz] over `duration` [s]."""

    low: float
    high: float
    duration: float

    def __post_init__(self) -> None:
        _refuse_band(self.low, self.high, "trajectory")
        if not self.duration * self.low >= 1:
            what = f"{self.duration:g} s do not hold one period of {self.low:g} Hz"
            raise InputError(what, "sweep", "make it longer, or begin at a higher frequency")

    def values(self, time: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
        k = math.log(self.high / self.low) / self.duration
        b = 2 * math.pi * self.low / k
        u = b * np.exp(k * np.asarray(time))
        from scipy import special  # takes time to import

        sine_integral, cosine_integral = special.sici(u)
        first_sine, first_cosine = special.sici(b)
        integral = math.cos(b) * (sine_integral - first_sine) - math.sin(b) * (cosine_integral - first_cosine)
        sine, cosine = np.sin(u - b), np.cos(u - b)
        return integral / k, sine, k * u * cosine, k**2 * u * (cosine - u * sine)


@dataclass(frozen=True)
class Multisine:
    """Cosines at harmonics of 1 / `period` from `low` to `high` [Hz], for `periods` periods [s].

    All harmonics of the band, or about `lines` of them in equal ratios where that is not 0.
    """

    low: float
    high: float
    period: float
    periods: int = 1
    lines: int = 0

    def __post_init__(self) -> None:
        _refuse_band(self.low, self.high, "multisine")
        if self.high * self.period > _MOST_HARMONICS:
            what = f"{self.period:g} s hold {self.high * self.period:.3g} periods of {self.high:g} Hz"
            raise InputError(what, "multisine", f"at most {_MOST_HARMONICS:g} are possible; make the period shorter")
        if not len(self.frequencies):
            what = f"no harmonic of {1 / self.period:g} Hz lies between {self.low:g} and {self.high:g} Hz"
            raise InputError(what, "multisine", "make the period longer")

    @property
    def duration(self) -> float:
        return self.period * self.periods

    @property
    def frequencies(self) -> FloatArray:
        """f_i [Hz]."""
        first, last = math.ceil(self.low * self.period - 1e-9), math.floor(self.high * self.period + 1e-9)
        chosen = np.arange(first, last + 1)
        if 0 < self.lines < len(chosen):
            chosen = np.unique(np.round(np.geomspace(first, last, self.lines)))
        harmonics: FloatArray = chosen / self.period
        return harmonics

    @cached_property
    def _scale(self) -> float:
        fine = np.linspace(0.0, self.period, 32 * math.ceil(self.high * self.period), endpoint=False)
        return 1.0 / float(np.max(np.abs(self._sums(fine)[1])))

    @property
    def crest(self) -> float:
        """Peak over rms value; 1.41 for a sine."""
        return math.sqrt(2 / len(self.frequencies)) / self._scale

    def values(self, time: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
        integral, value, slope, curve = self._sums(np.asarray(time, dtype=float))
        return self._scale * integral, self._scale * value, self._scale * slope, self._scale * curve

    def _sums(self, time: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
        count = len(self.frequencies)
        sums = [np.zeros_like(time) for _ in range(4)]
        for i, w in enumerate(2 * math.pi * self.frequencies, 1):
            phase = -math.pi * i * (i - 1) / count
            sine, cosine = np.sin(w * time + phase), np.cos(w * time + phase)
            for total, term in zip(
                sums, ((sine - math.sin(phase)) / w, cosine, -w * sine, -(w**2) * cosine), strict=True
            ):
                total += term
        return sums[0], sums[1], sums[2], sums[3]


@dataclass(frozen=True)
class Prbs:
    """A maximum-length binary sequence of order n, 2^n - 1 bits of `bit` [s] each, run `periods` times."""

    bit: float
    order: int
    periods: int = 1

    def __post_init__(self) -> None:
        if self.order not in _LENGTHS:
            raise InputError(f"order {self.order} of a binary sequence", "prbs", "write an order from 4 to 20")
        if not self.bit > 0:
            raise InputError(f"a bit of {self.bit:g} s", "prbs", "write a time above zero")

    @property
    def duration(self) -> float:
        return self.bit * self.periods * ((1 << self.order) - 1)

    def values(self, time: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
        from scipy.signal import max_len_seq  # takes a second to import

        bits = 2.0 * max_len_seq(self.order)[0] - 1.0
        place = np.asarray(time) / self.bit
        index = np.floor(place + 1e-6).astype(np.int64)  # a tick that rounding puts just before its bit belongs to it
        whole = np.concatenate([[0.0], np.cumsum(bits)])
        rounds, within = np.divmod(index, len(bits))
        integral = self.bit * (rounds * whole[-1] + whole[within] + (place - index) * bits[within])
        nothing = np.zeros_like(place)
        return integral, bits[within], nothing, nothing


def _refuse_band(low: float, high: float, where: str) -> None:
    if not 0 < low < high:
        raise InputError(f"no band from {low:g} to {high:g} Hz", where, "write a low frequency below the high one")
