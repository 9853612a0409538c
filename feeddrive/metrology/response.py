"""Frequency response as it is measured through the drive: averaged spectra, H1, coherence; and of a step.

    H1 = S_uy / S_uu,   coherence = |S_uy|^2 / (S_uu S_yy)

S are averaged cross spectra of segments (scipy.signal.csd: Welch, Hann window, half overlap). A periodic excitation is
averaged over whole periods without window, where nothing leaks. Source: Pintelon, Schoukens, System Identification,
2nd ed., sections 2.2 to 2.6.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from feeddrive.errors import InputError
from feeddrive.typing import FloatArray

SETTLED_BY = 0.8
"""Share of what was recorded after a step by which it must have come within its band for good. An exponential approach
1 - e^(-t/T) that is cut off at t_e has its end value put wrong by e^(-t_e/T); where that is the band of 2 % itself, the
approach enters the band about the wrong end at 0.8 t_e: who enters later, has an end value that is not known."""

_LEAKING = 3
"""Lowest lines into which a Hann window lets what is left of the mean and of a drift leak."""


@dataclass(frozen=True)
class Response:
    """Measured frequency response.

    Attributes:
        frequency: [Hz], shape (n,).
        response: output per input, complex, shape (n,).
        coherence: 0 to 1, shape (n,); NaN where there is one average only.
        averages: number of segments or periods; 0 where it is not known.
    """

    frequency: FloatArray
    response: FloatArray
    coherence: FloatArray
    averages: int

    def between(self, low: float, high: float) -> Response:
        """The part from `low` to `high` [Hz]."""
        inside = (self.frequency >= low) & (self.frequency <= high)
        return Response(self.frequency[inside], self.response[inside], self.coherence[inside], self.averages)


def measured_response(given: FloatArray, output: FloatArray, sample_time: float, segment: int) -> Response:
    """H1 over Hann windows of `segment` samples.

    Args:
        given, output: samples, shape (n,).
        sample_time: [s].
        segment: samples per window.

    Raises:
        InputError: fewer samples than a segment.
    """
    if len(given) < segment:
        raise InputError(f"{len(given)} samples for windows of {segment}", "frequency response", "record longer")
    options = {"fs": 1 / sample_time, "nperseg": segment, "detrend": "constant"}
    from scipy import signal  # takes a second to import

    frequency, cross = signal.csd(given, output, **options)
    _, power = signal.welch(given, **options)
    _, coherence = signal.coherence(given, output, **options)
    averages = (len(given) - segment) // (segment - segment // 2) + 1
    if averages < 2:
        coherence = np.full_like(coherence, np.nan)
    with np.errstate(divide="ignore", invalid="ignore"):
        inside = slice(_LEAKING, -1)  # nor at half the sample rate
        return Response(frequency[inside], (cross / power)[inside], coherence[inside], averages)


def periodic_response(
    given: FloatArray, output: FloatArray, sample_time: float, period: int, lines: FloatArray
) -> Response:
    """Response at excited harmonics, averaged over whole periods.

    Args:
        given, output: samples, the last `len // period` whole periods are used, shape (n,).
        sample_time: [s].
        period: samples per period.
        lines: excited frequencies [Hz], harmonics of the period, shape (k,).

    Raises:
        InputError: less than one period.
    """
    periods = len(given) // period
    if periods < 1:
        raise InputError(f"{len(given)} samples for a period of {period}", "frequency response", "record longer")
    index = np.round(lines * period * sample_time).astype(np.int64)
    spectra = [
        np.fft.rfft(_level(values[len(values) - periods * period :].reshape(periods, period)), axis=1)[:, index]
        for values in (given, output)
    ]
    cross, power, answer = (
        np.mean(a * np.conj(b), axis=0)
        for a, b in ((spectra[1], spectra[0]), (spectra[0], spectra[0]), (spectra[1], spectra[1]))
    )
    coherence = np.abs(cross) ** 2 / (power.real * answer.real)
    if periods < 2:
        coherence = np.full_like(coherence, np.nan)
    return Response(np.asarray(lines), cross / power.real, coherence, periods)


def _level(periods: FloatArray) -> FloatArray:
    """Periods without the mean of each."""
    level: FloatArray = periods - periods.mean(axis=1, keepdims=True)
    return level


@dataclass(frozen=True)
class StepResponse:
    """Figures of a step, relative to its height.

    Attributes:
        final: value at the end, in the unit of the signal.
        rise: from 10 to 90 % [s].
        overshoot: beyond the end value, as a share of the height.
        settling: until within 2 % of the height for good [s], from the step on; NaN where it has not settled by
            `SETTLED_BY` of the record, so that its end value is not known either.
    """

    final: float
    rise: float
    overshoot: float
    settling: float


def step_response(time: FloatArray, values: FloatArray, at: float) -> StepResponse:
    """Figures of a step at a time.

    Args:
        time, values: samples, shape (n,).
        at: when the step happens [s].

    Raises:
        InputError: no sample before or too few after the step, or no height.
    """
    first = int(np.searchsorted(time, at - 1e-12))
    after = values[first:]
    if first < 1 or len(after) < 20:
        raise InputError("too few samples about the step", "step response", "record before and after the step")
    start, final = float(values[first - 1]), float(np.mean(after[-max(1, len(after) // 20) :]))
    height = final - start
    if height == 0:
        raise InputError("the signal does not change", "step response", "choose the channel that steps")
    share = (after - start) / height
    rise = float(time[first + np.argmax(share >= 0.9)] - time[first + np.argmax(share >= 0.1)])
    outside = np.flatnonzero(np.abs(share - 1) > 0.02)
    settled = float(time[first + outside[-1]] - at) if len(outside) else 0.0
    if settled > SETTLED_BY * float(time[-1] - at):
        settled = math.nan
    return StepResponse(final, rise, float(max(0.0, share.max() - 1)), settled)
