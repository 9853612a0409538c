"""The filter of the band, the lag of a channel and the gains of frequencies beside those of scipy and numpy."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import signal
from scipy.ndimage import shift

from feeddrive.diagnosis.likelihood.encoder_error import Weighing
from feeddrive.diagnosis.likelihood.zero_phase import PADDING, zero_phase
from feeddrive.diagnosis.starts.periodogram import OVERSAMPLING, _highest_peaks
from feeddrive.diagnosis.suspicion.channel_timing import lagging

DRAW = np.random.default_rng(5)
EPS = np.finfo(float).eps


@pytest.mark.parametrize("rate, edge", [(250.0, 25.0), (2000.0, 103.0), (2000.0, 900.0), (20000.0, 150.0)])
@pytest.mark.parametrize("count", [PADDING + 1, 32, 1000, 20011])
def test_filter_is_that_of_scipy(rate: float, edge: float, count: int) -> None:
    series = 100.0 + np.cumsum(DRAW.standard_normal(count))
    sections = signal.butter(4, edge, fs=rate, output="sos")
    # the recursion of the sections loses (rate / edge)^2 of the digits
    allowed = 20 * EPS * max(rate / edge, 1.0) ** 2 * float(np.abs(series).max())
    assert np.abs(zero_phase(series, edge, rate) - signal.sosfiltfilt(sections, series)).max() < allowed


def test_filter_far_below_the_sample_rate_leaves_a_straight_line() -> None:
    line = np.linspace(-3.0, 5.0, 40_000)
    # a second from the ends, a hundred of its time constants, nothing of the start is left
    assert np.abs(zero_phase(line, 50.0, 20_000.0) - line)[20_000:20_100].max() < 1e-11


def test_filter_tells_what_is_no_number() -> None:
    series = np.ones(400)
    series[200] = np.nan
    assert not np.isfinite(zero_phase(series, 100.0, 2000.0)).any()


@pytest.mark.parametrize("lag", [1e-4, -1e-4, 1e-3, 2.5e-3, -7.3e-3])
def test_lag_is_that_of_a_quintic_spline(lag: float) -> None:
    series = 5.0 + np.cumsum(DRAW.standard_normal(4000))
    expected = shift(series - series[0], lag / 1e-3, order=5, mode="nearest") + series[0]
    # the spline forgets its ends by 0.43 a sample: 0.43^40 = 2e-15
    assert np.abs(lagging(series, lag, 1e-3) - expected)[40:-40].max() < 1e-10


@pytest.mark.parametrize("count", [24_000, 24_841, 24_842])
def test_gains_of_frequencies_at_any_length(count: int) -> None:
    series, gains = DRAW.standard_normal(count), DRAW.uniform(0.3, 1.0, count // 2 + 1)
    expected = np.fft.irfft(np.fft.rfft(series) * gains, count)
    assert np.abs(Weighing.of(gains, count)(series) - expected).max() < 1e-13


def test_highest_peaks_are_those_of_scipy() -> None:
    for _ in range(50):
        spectrum = np.abs(np.convolve(DRAW.standard_normal(2000), np.ones(5)))
        peaks, _ = signal.find_peaks(spectrum, distance=OVERSAMPLING)
        assert _highest_peaks(spectrum, 3) == list(peaks[np.argsort(spectrum[peaks])[::-1][:3]])


@pytest.mark.parametrize("every", [2, 3, 4, 40])
@pytest.mark.parametrize("count", [PADDING + 1, 1000, 20011])
def test_filter_gives_some_samples_alone(every: int, count: int) -> None:
    series = np.cumsum(DRAW.standard_normal(count))
    whole = zero_phase(series, 103.0, 2000.0)
    # both passes are sums of some hundred products
    allowed = 1000 * EPS * float(np.abs(series).max())
    assert np.abs(zero_phase(series, 103.0, 2000.0, every) - whole[::every]).max() < allowed
