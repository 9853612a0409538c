"""Weibull law and fits: closed forms, recovery of a known law, censoring, intervals that cover what they say."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.stats import weibull_min

from feeddrive.errors import InputError
from feeddrive.parts.life.weibull import (
    WeibullLaw,
    complete_slope_interval,
    line_fit,
)

LAW = WeibullLaw(560e3, 3.6)


@given(st.floats(1e-3, 1e9), st.floats(0.3, 20.0), st.floats(0.001, 0.999))
def test_life_and_failure_are_inverse(scale: float, slope: float, failed: float) -> None:
    law = WeibullLaw(scale, slope)
    # Rounding of the power, magnified by the slope.
    assert law.failure(law.life(failed)) == pytest.approx(failed, rel=1e-12 * max(slope, 1.0))
    again = WeibullLaw.through(law.life(failed), failed, slope)
    assert again.scale == pytest.approx(scale, rel=1e-12)


def test_tiny_probabilities_keep_their_digits() -> None:
    # F is (L/A)^e to first order; 1 - exp(...) would be 0 here.
    assert WeibullLaw(1.0, 2.0).failure(1e-10) == pytest.approx(1e-20, rel=1e-12)


@given(st.floats(10.0, 1e7), st.floats(0.5, 10.0))
def test_points_on_a_line_give_the_line(scale: float, slope: float) -> None:
    law = WeibullLaw(scale, slope)
    shares = np.array([0.05, 0.2, 0.5, 0.9])
    fitted = line_fit(np.array([law.life(share) for share in shares]), shares)
    assert fitted.slope == pytest.approx(slope, rel=1e-9)
    assert fitted.scale == pytest.approx(scale, rel=1e-9)


def test_levels_and_counts_outside_their_range_are_refused() -> None:
    with pytest.raises(InputError, match="level"):
        complete_slope_interval(3.6, 10, 1.0)
    with pytest.raises(InputError, match="specimens"):
        complete_slope_interval(3.6, 2)
    with pytest.raises(InputError, match="scale"):
        WeibullLaw(0.0, 1.0)


def test_exact_slope_interval_covers() -> None:
    """200 samples of ten: nine in ten intervals hold the slope; 4 standard deviations of 200 trials are 0.085."""
    generator = np.random.default_rng(21)
    held = 0
    for _ in range(200):
        slope = weibull_min.fit(generator.weibull(LAW.slope, 10), floc=0.0)[0]
        interval = complete_slope_interval(slope, 10)
        held += interval.low < LAW.slope < interval.high
    assert held / 200 == pytest.approx(0.9, abs=0.085)
