"""The lag of a channel and the gains of frequencies beside what scipy and numpy make of them."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.ndimage import shift

from feeddrive.diagnosis.motion.weighing import Weighing
from feeddrive.diagnosis.suspicion.channel_timing import lagging

DRAW = np.random.default_rng(5)


@pytest.mark.parametrize("lag", [1e-4, -1e-4, 1e-3, 2.5e-3, -7.3e-3])
def test_lag_is_that_of_a_quintic_spline(lag: float) -> None:
    series = 5.0 + np.cumsum(DRAW.standard_normal(4000))
    expected = shift(series - series[0], lag / 1e-3, order=5, mode="nearest") + series[0]
    # the spline forgets its ends by 0.43 a sample: 0.43^40 = 2e-15
    assert np.abs(lagging(series, lag, 1e-3) - expected)[40:-40].max() < 1e-10


@pytest.mark.parametrize("every", [1, 3, 4])
@pytest.mark.parametrize("count", [24_000, 24_841, 24_842])
def test_gains_of_frequencies_at_any_length(count: int, every: int) -> None:
    series, gains = DRAW.standard_normal(count), DRAW.uniform(0.3, 1.0, count // 2 + 1)
    expected = np.fft.irfft(np.fft.rfft(series) * gains, count)
    assert np.abs(Weighing.of(gains, count, every)(series) - expected[::every]).max() < 1e-13
