"""The encoder's own error: the motion that is expected given what was measured, and what its rest does to the channels.

The motor angle is measured in steps, θ_m = θ + q. Differentiated by the plant, q comes out as torque and position that
nothing of the machine asked for, and an effect that only makes the plant answer the motor less (a mass that is taken
away, a soft spring, a resonance of strong damping) lowers the error by that alone. What is simulated is therefore the
motion that is expected given what was measured, window by window and frequency by frequency (Wiener, Extrapolation,
Interpolation, and Smoothing (1949)):

    E[A | A_m] = max(1 - N / P, 0) A_m,   N = step²/12 Σw² |2 sin(ω h / 2)|⁴

| symbol | meaning |
|---|---|
| A_m | spectrum of the second difference of the angle in a window |
| P | mean square of A_m over neighbouring frequencies and windows |
| N | that of the steps' error, white, of variance step²/12 |
| w, h | window, sample time |

The error that is left is independent of the motion that is simulated, so that it draws no value towards none (Carroll
et al., Measurement Error in Nonlinear Models (2006), chapter 4). It adds to the residual what the declared plant makes
of it: an error that the same encoder would make is drawn and simulated, and each channel is weighed, frequency by
frequency, by the sensor's noise over both,

    gain(f) = 1 / √(1 + S_encoder(f) / S_sensor(f))
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.fft import irfft, next_fast_len, rfft
from scipy.ndimage import uniform_filter
from scipy.signal import welch

from feeddrive.diagnosis.likelihood.band import END_CUT, Band
from feeddrive.engine.step.step_constants import SimulationError
from feeddrive.plant.plant import Plant
from feeddrive.recording import Recording
from feeddrive.recording.checks.flaws import quantisation_step
from feeddrive.simulate.driven import MotorMotion, motor_motion, simulate_driven
from feeddrive.typing import ComplexArray, FloatArray

WINDOW = 0.128
"""Length of a window [s]: motion keeps its spectrum that long, and 8 Hz are distinguished from the next."""

ALONG_FREQUENCY, ALONG_TIME = 5, 3
"""Neighbours over which P is averaged: 15 values, of which those of overlapping windows are half independent, are
within a third of the mean square of noise."""

SHOWN = 1 + 2 / math.sqrt(10)
"""P over N from which there is motion: two standard deviations of the mean of ten independent squares of noise."""

SURE_MOTION = 8.0
"""Frequency [Hz] below which the angle is motion: an axis moves many steps within a window."""


MATERIAL = 0.1
"""Variance that the encoder adds to a channel, over its sensor's, from which it is carried: errors grow by 5 %."""

SEED = 12
"""Seed of the places of the drawn encoder's steps; all of them are passed, so that any will do."""


@dataclass(frozen=True)
class EncoderError:
    """What the steps of an encoder do to a comparison.

    Attributes:
        motion: of the motor, as expected.
        gains: channel to the gain at each frequency of its whole series, (n // 2 + 1,).
        added: channel to the rms of what the encoder's error makes of it, in the band [SI].
    """

    motion: MotorMotion
    gains: dict[str, FloatArray]
    added: dict[str, float]


@dataclass(frozen=True)
class Weighing:
    """Gains on the frequencies of a series, for many series of one length.

    A length with large prime factors takes several times longer to transform. The gains are a circular convolution
    then, and are done as one of twice the length or more, folded back.

    Attributes:
        spectrum: gains at the frequencies of `size` samples.
        count: samples of a series.
        size: samples that are transformed.
    """

    spectrum: ComplexArray | FloatArray
    count: int
    size: int

    @classmethod
    def of(cls, gains: FloatArray, count: int) -> Weighing:
        """Ready a gain at each frequency of a series of so many samples, (count // 2 + 1,)."""
        if next_fast_len(count, real=True) == count:
            return cls(gains, count, count)
        size = next_fast_len(2 * count, real=True)
        return cls(rfft(irfft(gains, count), size), count, size)

    def __call__(self, series: FloatArray) -> FloatArray:
        """The series, (count,), with its frequencies weighed."""
        found: FloatArray = irfft(rfft(series, self.size) * self.spectrum, self.size)
        if self.size == self.count:
            return found
        folded = found[: self.count]
        folded[:-1] += found[self.count : 2 * self.count - 1]
        return folded


def encoder_error(plant: Plant, recording: Recording, band: Band, noise: dict[str, float]) -> EncoderError | None:
    """The encoder's error in a recording; None where it does not matter beside the sensors' noise.

    Args:
        plant: as declared, that answers the motion.
        recording: with a motor angle.
        band: of the comparison.
        noise: channel to the rms of its sensor noise in the band [SI].
    """
    angle, sample_time = recording["motor_angle"], recording.sample_time
    step = quantisation_step(angle)
    if step <= 0 or round(WINDOW / sample_time) < 16 or len(angle) < 4 * round(WINDOW / sample_time):
        return None
    time: FloatArray = np.arange(len(angle), dtype=np.float64) * sample_time
    expected = expected_motion(angle, step, sample_time)
    left = drawn_error(expected, step, sample_time)
    motion = motor_motion(time, expected)
    try:
        runs = [simulate_driven(plant, one) for one in (motion, motor_motion(time, expected + left))]
    except SimulationError:
        return None
    inner = slice(round(END_CUT / sample_time), -round(END_CUT / sample_time))
    gains, added = {}, {}
    for name in noise:
        series = [run.torque if name == "motor_torque" else run.table_position for run in runs]
        error = series[1] - series[0]
        added[name] = float(np.std(band.filter(error)[inner]))
        length = 2 * round(WINDOW / sample_time)
        frequency, density = welch(error[inner], 1 / sample_time, nperseg=length)
        white = 2 * sample_time * (noise[name] / band.noise_gain) ** 2
        all_frequencies = np.fft.rfftfreq(len(angle), sample_time)
        gains[name] = 1 / np.sqrt(1 + np.interp(all_frequencies, frequency, density) / white)
    if all(added[name] ** 2 < MATERIAL * noise[name] ** 2 for name in noise):
        return None
    return EncoderError(motion, gains, added)


def drawn_error(expected: FloatArray, step: float, sample_time: float) -> FloatArray:
    """The error that the expected motion would have if it were the true one, measured by the same encoder, (n,) [rad].

    Slow motion and rest make an error that is slow: it is drawn by measuring, not as white noise.
    """
    true = expected + step * np.random.default_rng(SEED).uniform()
    measured = step * np.round(true / step)
    drawn: FloatArray = expected_motion(measured, step, sample_time) - true
    return drawn


def expected_motion(angle: FloatArray, step: float, sample_time: float) -> FloatArray:
    """The motor angle that is expected given one measured in steps.

    Args:
        angle: as measured [rad], shape (n,).
        step: of the encoder [rad].
        sample_time: [s].

    Returns:
        Angle [rad], shape (n,).
    """
    length = 2 * round(0.5 * WINDOW / sample_time)
    window = np.sqrt(np.hanning(length + 1)[:-1])
    spectra = np.fft.rfft(_frames(np.concatenate([[0.0], np.diff(angle, 2), [0.0]]), length) * window, axis=1)
    omega = 2 * np.pi * np.arange(spectra.shape[1]) / length
    difference = (2 * np.sin(0.5 * omega)) ** 2
    noise = step**2 / 12 * float(window @ window) * difference**2
    power = uniform_filter(np.abs(spectra) ** 2 / np.where(noise > 0, noise, 1.0), (ALONG_TIME, ALONG_FREQUENCY))
    error = np.where(power > SHOWN, 1 / np.maximum(power, SHOWN), 1.0)  # share of the steps
    error[:, omega < 2 * math.pi * SURE_MOTION * sample_time] = 0.0
    # minus the second difference, summed twice, is the angle
    taken = _added(-error * spectra / np.where(difference > 0, difference, 1.0), window, len(angle))
    return angle - taken


def _frames(series: FloatArray, length: int) -> FloatArray:
    """Windows of a series that overlap by half, (count, length)."""
    half = length // 2
    padded = np.concatenate([np.zeros(half), series, np.zeros(length + (-len(series)) % half)])
    frames: FloatArray = np.lib.stride_tricks.sliding_window_view(padded, length)[::half]
    return frames


def _added(spectra: ComplexArray, window: FloatArray, count: int) -> FloatArray:
    """The series of so many samples that overlapping windows with these spectra add up to."""
    length = len(window)
    half = length // 2
    parts = np.fft.irfft(spectra, length, axis=1) * window
    total = np.zeros((len(parts) + 1) * half)
    for i, part in enumerate(parts):
        total[i * half : i * half + length] += part
    return total[half : half + count]
