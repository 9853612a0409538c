"""The motion that is expected given an angle measured in steps, and motions that are as likely.

Window by window and frequency by frequency (Wiener, Extrapolation, Interpolation, and Smoothing (1949)):

    E[A | A_m] = H A_m,   var[A | A_m] = H N,   H = max(1 - N / P, 0) where there is motion
    E[A | A_m] = 0,       var[A | A_m] = max(P̄ - N, 0)              elsewhere
    N = step²/12 Σw² |2 sin(ω h / 2)|⁴

| symbol | meaning |
|---|---|
| A_m | spectrum of the second difference of the angle in a window |
| P | mean square of A_m over neighbouring windows; neighbouring frequencies tell besides where there is motion at all |
| P̄ | mean square of A_m at a frequency, over all windows and neighbouring frequencies where no motion is told |
| N | that of the steps' error, white, of variance step²/12 |
| w, h | window, sample time |

P is of one frequency, as the spectrum of a stroke falls fifty times from one to the next, and what is taken away is
then N in the mean however steep it is (Stein, Ann. Statist. 9 (1981) 1135).

An angle that goes to and fro between two steps and meets no third, as that of an axis does which a drive holds, is at
the edge between them, wherever its mean is and however large its steps are: no sample lies farther than half a step
from the motion, and what is no larger than a few tenths of one shows as a whole one (consistent reconstruction: Thao
and Vetterli, IEEE Trans. Signal Process. 42 (1994) 519).

What is expected has less power than the true motion: what is too small to be told in a window is not in it, and an
encoder that measured it would lose no more. A likely motion has what may have been lost besides, drawn at random, so
that it has the power of the true one.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from scipy.ndimage import uniform_filter
from scipy.signal.windows import hann

from feeddrive.typing import BoolArray, ComplexArray, FloatArray

WINDOW = 0.128
"""Length of a window [s]: motion keeps its spectrum that long, and 8 Hz are distinguished from the next."""

ALONG_FREQUENCY, ALONG_TIME = 5, 3
"""Neighbours that tell where there is motion: 15 values, of which those of overlapping windows are half independent,
are within a third of the mean square of noise."""

SHOWN = 1 + 2 / math.sqrt(10)
"""P over N from which there is motion: two standard deviations of the mean of ten independent squares of noise."""

EVEN = math.log(1000)
"""Square of the mean phasor between rows, over that of phases at random, from which steps make lines: that square is
exponential, and one window in a thousand reaches so much by chance. An angle that passes many steps a row, unevenly,
makes white ones (Widrow & Kollár, Quantization Noise (2008)), in which peaks of a draw are of that draw alone."""

TO_AND_FRO = 2
"""Changes of the angle in each half of a window from which it goes to and fro: a motion that passes changes it once."""

PARTS = 1, 2, 4
"""Parts of a window in which the angle is asked whether it goes to and fro: a rest ends within one, not with it. The
longest leave the fewest rows that a slow motion's passage through an edge would take for a rest."""

SURE_MOTION = 8.0
"""Frequency [Hz] below which the angle is motion: an axis moves many steps within a window."""

DRAWS = 4
"""Errors that are drawn: with `encoder_error.SMOOTHED` neighbours on either side, a spectrum is known to a fifth."""


@dataclass(frozen=True)
class ExpectedMotion:
    """What a measured angle says of the motion.

    Attributes:
        angle: as it is expected, (n,) [rad].
        spread: in each window and at each of its frequencies, the standard deviation of what is not told, over that of
            white steps, (windows, m).
        step: of the encoder [rad].
        sample_time: of the rows [s].
    """

    angle: FloatArray
    spread: FloatArray
    step: float
    sample_time: float

    def likely(self, draw: int) -> FloatArray:
        """A motion that is as likely as any given what was measured, (n,) [rad]; `draw` is its seed."""
        window = window_of(self.sample_time)
        white = np.random.default_rng(draw).normal(0.0, self.step / math.sqrt(12), len(self.angle))
        spectra = np.fft.rfft(frames_of(white, len(window)) * window, axis=1)
        return self.angle + added(self.spread * spectra, window, len(white))


def expected_motion(angle: FloatArray, step: float, sample_time: float) -> ExpectedMotion:
    """The motion that is expected given an angle measured in steps.

    Args:
        angle: as measured [rad], shape (n,).
        step: of the encoder [rad].
        sample_time: [s].
    """
    window = window_of(sample_time)
    length = len(window)
    omega = 2 * np.pi * np.arange(length // 2 + 1) / length
    difference = (2 * np.sin(0.5 * omega)) ** 2
    spectra = spectra_of(angle, window)
    white = step**2 / 12 * float(window @ window) * difference**2

    def given(noise: FloatArray) -> ExpectedMotion:
        over_noise = np.abs(spectra) ** 2 / np.where(noise > 0, noise, 1.0)
        moving = uniform_filter(over_noise, (ALONG_TIME, ALONG_FREQUENCY)) > SHOWN
        sure = omega < 2 * math.pi * SURE_MOTION * sample_time
        error = np.where(moving, 1 / np.maximum(uniform_filter(over_noise, (ALONG_TIME, 1)), 1.0), 1.0)
        unsure = np.where(moving, 1 - error, _hidden(over_noise, moving))
        error[:, sure] = unsure[:, sure] = 0.0  # nothing of it is lost
        # minus the second difference, summed twice, is the angle
        expected = angle - added(-error * spectra / np.where(difference > 0, difference, 1.0), window, len(angle))
        spread = np.sqrt(unsure * np.divide(noise, white, out=np.ones_like(unsure), where=white > 0))
        return ExpectedMotion(expected, spread, step, sample_time)

    first = given(white).angle
    made = np.mean([np.abs(spectra_of(_steps_of(first, step, draw), window)) ** 2 for draw in range(DRAWS)], axis=0)
    made = uniform_filter(made, (ALONG_TIME, 1))
    lines = (made > SHOWN * white) & _keeps_step(first / step, window**2)[:, None]
    found = given(np.where(lines, made, white))
    held = found.angle
    for part in PARTS:
        held = _at_edges(angle, held, step, window_of(sample_time, part))
    return replace(found, angle=held)


def _at_edges(angle: FloatArray, expected: FloatArray, step: float, window: FloatArray) -> FloatArray:
    """An expected motion, (n,), with the edge in its place where the angle goes to and fro between two steps."""
    length = len(window)
    frames = frames_of(angle, length)
    least, most = np.min(frames, axis=1), np.max(frames, axis=1)
    changes = np.abs(np.diff(frames, axis=1)) > 0.5 * step
    first, last = (np.sum(half, axis=1) for half in np.array_split(changes, 2, axis=1))
    inside = np.all(frames_of(np.ones(len(angle)), length) > 0, axis=1)
    held = inside & (most - least < 1.5 * step) & (np.minimum(first, last) >= TO_AND_FRO)
    edge = np.where(held, 0.5 * (least + most), 0.0)[:, None]
    beyond = np.where(held[:, None], edge - frames_of(expected, length), 0.0)
    return expected + _overlapped(beyond * window**2, len(angle))


def _hidden(over_noise: FloatArray, moving: BoolArray) -> FloatArray:
    """What there may be of motion where none is told, over the noise, (windows, m).

    At each frequency as much as there is too much for noise in all such windows and at neighbouring frequencies. A
    window in which no step is passed is at rest.
    """
    still = ~moving & np.any(over_noise > 0, axis=1)[:, None]
    count = uniform_filter(np.sum(still, axis=0, dtype=np.float64), ALONG_FREQUENCY)
    square = uniform_filter(np.sum(np.where(still, over_noise, 0.0), axis=0), ALONG_FREQUENCY)
    mean = np.divide(square, count, out=np.ones(len(count)), where=count > 0)
    return np.where(still, np.maximum(mean - 1, 0.0), 0.0)


def window_of(sample_time: float, part: int = 1) -> FloatArray:
    """Window of the spectra, or a part of it: squares of windows that overlap by half add up to one, (m,)."""
    return np.asarray(np.sqrt(hann(2 * round(0.5 * WINDOW / part / sample_time), sym=False)))


def _keeps_step(places: FloatArray, weights: FloatArray) -> BoolArray:
    """In which windows an angle, (n,) [steps], passes the steps evenly from row to row, (windows,)."""
    turns = np.exp(2j * np.pi * np.diff(places, prepend=places[:1]))
    coherence = np.abs(frames_of(turns, len(weights)) @ weights) ** 2
    return np.asarray(coherence > EVEN * float(weights @ weights))


def _steps_of(angle: FloatArray, step: float, draw: int) -> FloatArray:
    """What an encoder adds to an angle, (n,): `draw` is the seed of where its steps lie."""
    at = angle + step * np.random.default_rng(draw).uniform()
    return np.asarray(step * np.round(at / step) - at)


def spectra_of(angle: FloatArray, window: FloatArray) -> ComplexArray:
    """Spectra of the second difference of an angle in windows that overlap by half, (windows, frequencies)."""
    frames = frames_of(np.concatenate([[0.0], np.diff(angle, 2), [0.0]]), len(window))
    return np.asarray(np.fft.rfft(frames * window, axis=1))


def frames_of(series: FloatArray, length: int) -> FloatArray:
    """Windows of a series that overlap by half, (count, length)."""
    half = length // 2
    padded = np.concatenate([np.zeros(half), series, np.zeros(length + (-len(series)) % half)])
    frames: FloatArray = np.lib.stride_tricks.sliding_window_view(padded, length)[::half]
    return frames


def added(spectra: ComplexArray, window: FloatArray, count: int) -> FloatArray:
    """The series of so many samples that overlapping windows with these spectra add up to."""
    return _overlapped(np.fft.irfft(spectra, len(window), axis=1) * window, count)


def _overlapped(parts: FloatArray, count: int) -> FloatArray:
    """The series of so many samples that windows which overlap by half, (windows, length), add up to."""
    length = parts.shape[1]
    half = length // 2
    total = np.zeros((len(parts) + 1) * half)
    for i, part in enumerate(parts):
        total[i * half : i * half + length] += part
    return total[half : half + count]
