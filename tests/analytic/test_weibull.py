"""Weibull law and fits: closed forms, recovery of a known law, censoring, intervals that cover what they say."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.stats import weibull_min

from feeddrive.errors import InputError
from feeddrive.parts.life.weibull import (
    WeibullLaw,
    complete_slope_interval,
    life_sample,
    likelihood_fit,
    line_fit,
    log_likelihood,
    median_ranks,
    rank_fit,
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


def test_median_ranks_of_a_complete_sample() -> None:
    _, ranks = median_ranks(life_sample([3.0, 1.0, 2.0]))
    # The median of the least of n is 1 - 2^(-1/n); the middle one of three lies at a half by symmetry.
    first = 1.0 - 2.0 ** (-1.0 / 3.0)
    assert ranks == pytest.approx([first, 0.5, 1.0 - first], abs=1e-12)


def test_ranks_after_a_suspension_move_up() -> None:
    """Johnson's increments: after a suspension at place 2 of 5 the next failures have ranks 2.25, 3.5, 4.75."""
    _, ranks = median_ranks(life_sample([1.0, 3.0, 4.0, 5.0], [2.0]))
    _, plain = median_ranks(life_sample([1.0, 2.0, 3.0, 4.0, 5.0]))
    assert ranks[0] == pytest.approx(plain[0], abs=1e-15)
    # Benard's (i - 0.3)/(n + 0.4) is within 0.005 of the median rank.
    assert ranks[1:] == pytest.approx((np.array([2.25, 3.5, 4.75]) - 0.3) / 5.4, abs=0.005)


def test_suspensions_after_the_last_failure_leave_the_ranks() -> None:
    _, ranks = median_ranks(life_sample([1.0, 2.0], [2.0, 2.0, 2.0]))
    _, plain = median_ranks(life_sample([1.0, 2.0, 3.0, 4.0, 5.0]))
    assert ranks == pytest.approx(plain[:2], abs=1e-15)


def test_log_likelihood_agrees_with_scipy_and_with_short_intervals() -> None:
    lives = np.array([300e3, 500e3, 700e3])
    plain = log_likelihood(LAW, life_sample(lives))
    assert plain == pytest.approx(weibull_min.logpdf(lives, 3.6, scale=560e3).sum(), rel=1e-14)
    width = 1.0
    between = log_likelihood(LAW, life_sample([], found=np.column_stack((lives - width / 2, lives + width / 2))))
    # A density times a short width; the next term is of the order (width / life)^2 = 1e-11.
    assert between == pytest.approx(plain + 3 * math.log(width), rel=1e-9)


def test_likelihood_fit_is_at_the_top() -> None:
    generator = np.random.default_rng(3)
    lives = LAW.scale * generator.weibull(LAW.slope, 12)
    sample = life_sample(lives[:8], np.full(4, lives[:8].max()))
    best = likelihood_fit(sample)
    top = log_likelihood(best, sample)
    for scale, slope in ((1.001, 1.0), (0.999, 1.0), (1.0, 1.003), (1.0, 0.997)):
        assert log_likelihood(WeibullLaw(scale * best.scale, slope * best.slope), sample) < top


def test_large_sample_recovers_the_law() -> None:
    """Standard errors of maximum likelihood: 0.78 e / sqrt(n) and 1.05 A / (e sqrt(n)); four of them are allowed."""
    count = 4000
    lives = LAW.scale * np.random.default_rng(11).weibull(LAW.slope, count)
    fitted = likelihood_fit(life_sample(lives))
    assert fitted.slope == pytest.approx(LAW.slope, rel=4 * 0.78 / math.sqrt(count))
    assert fitted.scale == pytest.approx(LAW.scale, rel=4 * 1.05 / LAW.slope / math.sqrt(count))


def test_suspended_specimens_do_not_bias_the_life() -> None:
    """Half of 2000 specimens taken out at random: counted as suspended the law comes back, dropped it does not."""
    generator = np.random.default_rng(5)
    lives = LAW.scale * generator.weibull(LAW.slope, 2000)
    ends = LAW.scale * generator.weibull(LAW.slope, 2000)
    failed, suspended = lives[lives <= ends], ends[lives > ends]
    fitted = likelihood_fit(life_sample(failed, suspended))
    # About 1000 failures: four standard errors, 1.3 / 3.6 / sqrt(1000) of the scale, 0.78 / sqrt(1000) of the slope.
    assert fitted.scale == pytest.approx(LAW.scale, rel=0.046)
    assert fitted.slope == pytest.approx(LAW.slope, rel=0.10)
    # The least of two lives has the scale A 2^(-1/e) = 0.825 A, nine of those standard errors away.
    assert likelihood_fit(life_sample(failed)).scale < 0.87 * LAW.scale


def test_inspection_grid_does_not_bias_the_life() -> None:
    lives = LAW.scale * np.random.default_rng(8).weibull(LAW.slope, 1000)
    seen = 30e3 * np.floor(lives / 30e3)
    by_interval = likelihood_fit(life_sample([], found=np.column_stack((seen, seen + 30e3))))
    exact = likelihood_fit(life_sample(lives))
    # The grid is a twentieth of the life: a change below a fifth of the law's standard error (1 % and 2.5 %).
    assert by_interval.scale == pytest.approx(exact.scale, rel=0.002)
    assert by_interval.slope == pytest.approx(exact.slope, rel=0.006)


def test_exact_slope_interval_covers() -> None:
    """200 samples of ten: nine in ten intervals hold the slope; 4 standard deviations of 200 trials are 0.085."""
    generator = np.random.default_rng(21)
    held = 0
    for _ in range(200):
        slope = likelihood_fit(life_sample(generator.weibull(LAW.slope, 10))).slope
        interval = complete_slope_interval(slope, 10)
        held += interval.low < LAW.slope < interval.high
    assert held / 200 == pytest.approx(0.9, abs=0.085)


@pytest.mark.parametrize(
    ("failed", "suspended", "found"),
    [
        ([1.0], [], []),
        ([1.0, -1.0], [], []),
        ([1.0, math.nan], [], []),
        ([1.0, 2.0], [0.0], []),
        ([], [], [(2.0, 1.0), (1.0, 2.0)]),
        ([], [], [(-1.0, 1.0), (1.0, 2.0)]),
    ],
)
def test_unusable_samples_are_refused(
    failed: list[float], suspended: list[float], found: list[tuple[float, float]]
) -> None:
    with pytest.raises(InputError):
        life_sample(failed, suspended, found)


@pytest.mark.parametrize("fit", [rank_fit, likelihood_fit])
def test_equal_lives_have_no_slope(fit: object) -> None:
    with pytest.raises(InputError, match=r"one life|the life 5"):
        fit(life_sample([5.0, 5.0, 5.0]))  # type: ignore[operator]


@pytest.mark.parametrize("found", [[(200.0, 230.0)] * 4, [(0.0, 4.0), (0.0, 8.0), (4.0, 8.0)]])
def test_inspections_too_far_apart_have_no_slope(found: list[tuple[float, float]]) -> None:
    with pytest.raises(InputError, match="every failure may have come at the life"):
        likelihood_fit(life_sample([], found=found))


def test_one_life_and_specimens_that_outlived_it_have_a_slope() -> None:
    fitted = likelihood_fit(life_sample([5.0, 5.0], [10.0] * 5))
    assert 0.5 < fitted.slope < 5.0


def test_levels_and_counts_outside_their_range_are_refused() -> None:
    with pytest.raises(InputError, match="level"):
        complete_slope_interval(3.6, 10, 1.0)
    with pytest.raises(InputError, match="specimens"):
        complete_slope_interval(3.6, 2)
    with pytest.raises(InputError, match="scale"):
        WeibullLaw(0.0, 1.0)
