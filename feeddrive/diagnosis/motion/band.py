"""The band in which plant and recording are compared, the hold of the torque, and the sensor noise in the band.

Measured and predicted series pass the same zero-phase filter (4th-order Butterworth, forward and backward).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from scipy import signal
from scipy.fft import next_fast_len

from feeddrive.diagnosis.motion.weighing import Weighing
from feeddrive.plant.analysis.modes import screw_frequency
from feeddrive.plant.plant import Plant
from feeddrive.recording.checks.flaws import quantisation_step
from feeddrive.typing import FloatArray

WIDEST_BAND = 150.0
"""Upper edge [Hz] beyond which a servo engineer's axis shows structure that no chain of three inertias has."""

SHARE_OF_SAMPLE_RATE = 0.1
"""Upper edge over sample rate; differentiating splines are exact to 1e-4 up to here."""

SHARE_OF_ANTIRESONANCE = 0.42
"""Upper edge over the screw's anti-resonance, where the load side answers the motor without gain."""

END_CUT = 0.5
"""Left out at each end of a recording [s]: start-up of the simulated load side and of the filter."""

ENDS = 15
"""Samples that a series is continued by at either end before it is filtered, three times as many as the filter has
coefficients (the default of `sosfiltfilt`)."""

FORGOTTEN = 12.0
"""Periods of the edge in which the filter forgets an end: its slowest pole falls by exp(-2 pi 0.38) in each."""

NOISE_BLOCK = 0.25
"""Length of the blocks from which the sensor noise is read [s]."""


@dataclass(frozen=True)
class Band:
    """A low-pass band.

    Attributes:
        edge: upper edge [Hz].
        sample_rate: of the recording [Hz].
    """

    edge: float
    sample_rate: float

    def filter(self, series: FloatArray) -> FloatArray:
        """The series in the band, zero phase; shape (n,) or (n, k).

        One series is filtered as `sosfiltfilt` does, number by number, without its tests and copies (a third of its
        time).
        """
        sections, rested = _sections(self.edge, self.sample_rate)
        if series.ndim > 1 or len(series) <= ENDS:
            whole: FloatArray = signal.sosfiltfilt(sections, series, axis=0)
            return whole
        mirrored = 2 * series[0] - series[ENDS:0:-1], series, 2 * series[-1] - series[-2 : -ENDS - 2 : -1]
        forward = np.concatenate(mirrored)
        forward, _ = signal.sosfilt(sections, forward, zi=rested * forward[0])
        backward, _ = signal.sosfilt(sections, forward[::-1], zi=rested * forward[-1])
        filtered: FloatArray = backward[-ENDS - 1 : ENDS - 1 : -1]
        return filtered

    def thinned(self, series: FloatArray) -> FloatArray:
        """The series in the band, (n,), at every `thinning`-th sample from the first on; not within `END_CUT` of ends.

        Away from the ends the filter is a gain of frequencies, and a third of the work of two passes over all samples.
        """
        if END_CUT * self.edge < FORGOTTEN:
            return self.filter(series)[:: self.thinning]
        weighing = _gains(self.edge, self.sample_rate, len(series), self.thinning)
        behind = np.full(weighing.count - len(series), series[-1])
        return weighing(np.concatenate([series, behind]))[: -(-len(series) // self.thinning)]

    @property
    def thinning(self) -> int:
        """Every how many samples carry all that is in the band, with a margin for the filter's skirt."""
        return max(1, int(self.sample_rate / (3.3 * self.edge)))

    @property
    def noise_gain(self) -> float:
        """Rms in the band over rms of white noise."""
        impulse = np.zeros(int(20 * self.sample_rate / self.edge) * 2 + 401)
        impulse[len(impulse) // 2] = 1.0
        return float(np.linalg.norm(self.filter(impulse)))


@lru_cache(maxsize=16)
def _sections(edge: float, sample_rate: float) -> tuple[FloatArray, FloatArray]:
    """Second-order sections of the filter, (2, 6), and their states after a step of one, (2, 2).

    To design it takes as long as to filter ten thousand samples.
    """
    sections = np.asarray(signal.butter(4, edge, fs=sample_rate, output="sos"))
    return sections, signal.sosfilt_zi(sections)


@lru_cache(maxsize=16)
def _gains(edge: float, sample_rate: float, count: int, every: int) -> Weighing:
    """The filter, forward and backward, as gains of the frequencies of a series that is continued to a fast length."""
    size = every * next_fast_len(-(-count // every), real=True)
    _, response = signal.sosfreqz(_sections(edge, sample_rate)[0], 2 * np.pi * np.arange(size // 2 + 1) / size)
    return Weighing.of(np.abs(response) ** 2, size, every)


def comparison_band(plant: Plant, sample_rate: float) -> Band:
    """The band in which this plant and a recording at this rate [Hz] are compared."""
    edge = min(WIDEST_BAND, SHARE_OF_SAMPLE_RATE * sample_rate)
    return Band(min(edge, SHARE_OF_ANTIRESONANCE * screw_frequency(plant, plant.middle)), sample_rate)


def held(series: FloatArray) -> FloatArray:
    """What acts at the sample instants when each sample is held until the next one.

    The hold filters by sinc(u) exp(-j u), u = omega h / 2. Six taps about the middle of the past sample meet sinc(u) to
    the fourth order: 2 sum a_k = 1, 2 sum a_k k^2 = 1/3, 2 sum a_k k^4 = 1/5 for k = 1, 3, 5.
    """
    odd = np.array([1.0, 3.0, 5.0])
    half = np.linalg.solve(2 * np.vstack([odd**0, odd**2, odd**4]), np.array([1.0, 1 / 3, 1 / 5]))
    taps = np.concatenate([half[::-1], half])
    padded = np.concatenate([np.full(3, series[0]), series, np.full(2, series[-1])])
    acting: FloatArray = np.convolve(padded, taps, mode="valid")
    return acting


def sensor_noise(series: FloatArray, band: Band) -> float:
    """Rms of what a sensor adds, in the band.

    Steps larger than twice the noise are not dithered by it: their error, step / sqrt(12), follows the motion, and in
    slow motion all of it is in the band.
    """
    white, step = white_noise(series, band.sample_rate), quantisation_step(series)
    coarse = step / math.sqrt(12) if step > 2 * white else 0.0
    return math.hypot(white * band.noise_gain, coarse)


def white_noise(series: FloatArray, sample_rate: float) -> float:
    """Rms of the white part of a series, from fourth differences in its quietest tenth of blocks."""
    length = max(16, int(NOISE_BLOCK * sample_rate))
    differences = np.diff(series, 4)
    blocks = len(differences) // length
    if blocks < 1:
        return float(np.std(differences) / math.sqrt(70))
    levels = np.sqrt(np.mean(differences[: blocks * length].reshape(blocks, length) ** 2, axis=1))
    moving = levels[levels > 0]
    # 70 = 1 + 16 + 36 + 16 + 1, the power of the fourth difference of white noise
    return float(np.quantile(moving, 0.1) / math.sqrt(70)) if len(moving) else 0.0
