"""Filters of set-points and torque commands, of first and second order, and their discrete form.

    F(s) = (b2 s^2 + b1 s + b0) / (a2 s^2 + a1 s + a0)

PT1    1 / (T s + 1)
PT2    1 / (s^2 / w^2 + 2 D s / w + 1)
notch  (s^2 + 2 Dz w s + w^2) / (s^2 + 2 Dn w s + w^2),  Dn = bandwidth / (2 f),  Dz = Dn 10^(-depth / 20 dB)
biquad (s^2 / wz^2 + 2 Dz s / wz + 1) / (s^2 / wn^2 + 2 Dn s / wn + 1)

| symbol | meaning | unit |
|---|---|---|
| w = 2 pi f | corner or notch frequency; wz of the numerator, wn of the denominator | rad/s |
| D | damping | 1 |
| T | time constant, corner at f = 1 / (2 pi T) | s |

Discrete form: the bilinear map s = c (z - 1) / (z + 1), prewarped so that gain and phase are exact at the matched
frequency: the corner of PT1 and PT2, the notch, the denominator of the biquad. Elsewhere it is compressed towards half
the sample rate. Source: Franklin, Powell, Workman, Digital Control of Dynamic Systems, 3rd ed., section 6.1.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from feeddrive.errors import InputError
from feeddrive.typing import FloatArray

_HIGHEST = 0.45
"""Highest frequency of a filter over the sample rate: nearer to its half, prewarping bends it beyond use."""


@dataclass(frozen=True)
class Filter:
    """A continuous filter of at most second order.

    Attributes:
        kind: its name, for people.
        numerator: b2, b1, b0.
        denominator: a2, a1, a0.
        frequency: at which its discrete form is exact [Hz].
    """

    kind: str
    numerator: tuple[float, float, float]
    denominator: tuple[float, float, float]
    frequency: float

    def discrete(self, sample_time: float) -> FloatArray:
        """Coefficients c, (5,), of y_k = c0 u_k + c1 u_(k-1) + c2 u_(k-2) - c3 y_(k-1) - c4 y_(k-2).

        Raises InputError where the matched frequency is above 0.45 of the sample rate.
        """
        if self.frequency * sample_time > _HIGHEST:
            what = f"a {self.kind} at {self.frequency:g} Hz does not fit a sample rate of {1 / sample_time:g} Hz"
            raise InputError(what, "filter", f"choose a frequency below {_HIGHEST / sample_time:g} Hz")
        warped = math.pi * self.frequency / math.tan(math.pi * self.frequency * sample_time)
        first = 1 if self.numerator[0] == self.denominator[0] == 0.0 else 0
        b, a = (_bilinear(part, first, 2 * warped) for part in (self.numerator, self.denominator))
        coefficients: FloatArray = np.concatenate([b, a[1:]]) / a[0]
        return coefficients

    def response(self, frequency: FloatArray) -> FloatArray:
        """Complex F(j 2 pi f) of the continuous filter at frequencies [Hz], shape (n,)."""
        s = 2j * math.pi * np.asarray(frequency)
        values: FloatArray = np.polyval(self.numerator, s) / np.polyval(self.denominator, s)
        return values


def _bilinear(polynomial: tuple[float, float, float], first: int, scale: float) -> FloatArray:
    """Coefficients of 1, z^-1, z^-2 for s = scale (z - 1) / (z + 1), times (z + 1)^order; the order is 2 - first.

    scipy.signal has the same and takes a second to import, longer than a whole run.
    """
    p2, p1, p0 = polynomial[0] * scale**2, polynomial[1] * scale, polynomial[2]
    return np.array([p1 + p0, p0 - p1, 0.0] if first else [p2 + p1 + p0, 2 * (p0 - p2), p2 - p1 + p0])


def pt1(frequency: float) -> Filter:
    """Low-pass of first order with its -3 dB corner at `frequency` [Hz]."""
    _refuse_not_positive("PT1", frequency=frequency)
    return Filter("PT1", (0.0, 0.0, 1.0), (0.0, 1 / (2 * math.pi * frequency), 1.0), frequency)


def pt2(frequency: float, damping: float) -> Filter:
    """Low-pass of second order with natural frequency [Hz] and damping."""
    _refuse_not_positive("PT2", frequency=frequency, damping=damping)
    w = 2 * math.pi * frequency
    return Filter("PT2", (0.0, 0.0, 1.0), (1 / w**2, 2 * damping / w, 1.0), frequency)


def notch(frequency: float, bandwidth: float, depth: float) -> Filter:
    """Notch of a frequency and a bandwidth at -3 dB, if deep [Hz], and a depth [dB], infinite for a complete one."""
    _refuse_not_positive("notch", frequency=frequency, bandwidth=bandwidth, depth=depth)
    w, wide = 2 * math.pi * frequency, 2 * math.pi * bandwidth
    return Filter("notch", (1.0, wide * 10 ** (-depth / 20), w**2), (1.0, wide, w**2), frequency)


def biquad(zero_frequency: float, zero_damping: float, pole_frequency: float, pole_damping: float) -> Filter:
    """General filter of second order with unit gain at rest; frequencies [Hz], dampings [1], zero damping may be 0."""
    _refuse_not_positive("biquad", frequency=zero_frequency, pole_frequency=pole_frequency, pole_damping=pole_damping)
    if zero_damping < 0:
        raise InputError(f"the zero damping {zero_damping:g} is negative", "filter", "write 0 or more")
    wz, wn = 2 * math.pi * zero_frequency, 2 * math.pi * pole_frequency
    numerator, denominator = (1 / wz**2, 2 * zero_damping / wz, 1.0), (1 / wn**2, 2 * pole_damping / wn, 1.0)
    return Filter("biquad", numerator, denominator, pole_frequency)


def _refuse_not_positive(kind: str, **values: float) -> None:
    for key, value in values.items():
        if not value > 0:
            raise InputError(f"{kind}: {key} {value:g} is not above zero", "filter", "write a positive value")
