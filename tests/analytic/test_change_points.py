"""Evidence of changes: against integration by numbers, on series whose truth is known, and on series without any."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.signal import lfilter

from feeddrive.report.figures.figure_trend import with_steps
from feeddrive.trend.change_points import ASSERTED, Course, course_of
from feeddrive.trend.series_evidence import JUMP, ODD, SETTLING, SLOPE, Atom, Series, Timeline, noise_of
from feeddrive.trend.watch import _course
from feeddrive.typing import FloatArray

COUNT = 120


@pytest.fixture(scope="module")
def line() -> Timeline:
    """A hundred and twenty days."""
    return Timeline(np.arange(float(COUNT)), np.ones(COUNT))


def found_in(line: Timeline, values: np.ndarray) -> Course:
    """The course, with ten quantities watched."""
    return course_of(Series(line, (values - values.mean()) / values.std()), 10)


def test_evidence_is_the_integral_over_sizes_and_scatter() -> None:
    """log p(y | jump) - log p(y | none), by quadrature over level and scatter; the jump's size is Gaussian.

    With y ~ N(a, s^2 (I + n P)), P the projection on the jump beside the level, p(a, s) = 1/s.
    """
    y = np.array([0.3, -0.4, 0.1, 1.9, 2.4, 1.6])
    n = len(y)
    jump = np.array([0.0, 0, 0, 1, 1, 1]) - 0.5
    wide = np.eye(n) + n * np.outer(jump, jump) / (jump @ jump)

    def marginal(covariance: np.ndarray) -> float:
        a, log_s = np.meshgrid(np.linspace(-60, 60, 3001), np.linspace(-4.0, 6.0, 801), indexing="ij")
        inverse = np.linalg.inv(covariance)
        off = y @ inverse @ y - 2 * a * np.sum(inverse @ y) + a**2 * np.sum(inverse)
        log = -n * log_s - 0.5 * off * np.exp(-2 * log_s) - 0.5 * np.linalg.slogdet(covariance)[1]
        return math.log(np.trapezoid(np.trapezoid(np.exp(log), log_s[0], axis=1), a[:, 0]))  # da ds / s = da dlog s

    series = Series(Timeline(np.arange(float(n)), np.ones(n)), y)
    ours = series.evidence([Atom(JUMP, 3.0)])[0] - series.evidence([])[0]  # the first setting is white noise
    assert ours == pytest.approx(marginal(wide) - marginal(np.eye(n)), abs=1e-4)  # tails beyond the grid: (6/60)^5


def test_one_more_is_the_evidence_with_it(line: Timeline) -> None:
    """The quick scan over candidates says what the evidence of the set says, to single precision."""
    y = np.random.default_rng(3).standard_normal(COUNT) + (np.arange(COUNT) >= 50)
    series, present = Series(line, y), [Atom(SLOPE, 20.0)]
    scanned = series.with_one_more(present)
    for place in (0, 47, 130, 250, 400, 600, len(line.tried) - 1):
        exact = np.logaddexp.reduce(series.evidence([*present, line.tried[place]]))
        assert scanned[place] == pytest.approx(exact, abs=2e-3), line.tried[place]


def test_noise_of_a_grid_whitens_what_it_describes() -> None:
    """Cov(white e) = I for e of that covariance."""
    time = np.array([0.0, 1, 2, 5, 6, 9])
    noise = noise_of(time, np.array([1.0, 1, 4, 1, 1, 2]))
    wandering = 0.3 * np.exp(-np.abs(time[:, None] - time) / (3 * np.median(np.diff(time))))
    covariance = 0.7 * np.diag([1.0, 1, 4, 1, 1, 2]) + wandering  # the third setting: 0.3 of it, over three files
    white = noise.whitening[2] @ covariance @ noise.whitening[2].T
    np.testing.assert_allclose(white, np.eye(6), atol=1e-12)
    assert noise.log_determinant[2] == pytest.approx(np.linalg.slogdet(covariance)[1], abs=1e-12)


def test_jump_and_slope_are_dated(line: Timeline) -> None:
    """A slope of -0.2 sigma a day from day 40 and a jump of 10 sigma back on day 80: either alone explains little."""
    t = line.time
    found = found_in(
        line, 0.5 * np.random.default_rng(5).standard_normal(COUNT) - 0.1 * np.clip(t - 40, 0, None) + 5 * (t >= 80)
    )
    kinds = {one.atom.kind: one for one in found.found}
    assert set(kinds) == {JUMP, SLOPE}
    assert kinds[JUMP].atom.date == 80
    low, high = kinds[SLOPE].dates
    assert low <= 40 <= high and high - low < 40
    assert all(one.odds > ASSERTED for one in found.found)


def test_settling_has_its_time_constant(line: Timeline) -> None:
    found = found_in(line, 50 * -np.expm1(-line.time / 17.0) + np.random.default_rng(6).standard_normal(COUNT))
    (one,) = found.found
    assert one.atom.kind == SETTLING and one.atom.date == 0
    # of 120 values to 1 sigma in 50: about 2 %, which its own interval says
    assert one.atom.time_constant == pytest.approx(17.0, rel=0.05)
    assert one.time_constants[0] < 17.0 < one.time_constants[1]


def test_one_odd_recording_is_no_change(line: Timeline) -> None:
    values = np.random.default_rng(7).standard_normal(COUNT)
    values[60] += 12
    (one,) = found_in(line, values).found
    assert (one.atom.kind, one.atom.date) == (ODD, 60.0)


def test_last_recording_alone_is_not_called_a_change(line: Timeline) -> None:
    values = np.random.default_rng(8).standard_normal(COUNT)
    values[-1] += 12
    assert [one.atom.kind for one in found_in(line, values).found] == [ODD]


@pytest.mark.parametrize("seed", range(12))
def test_nothing_is_found_where_nothing_changes(line: Timeline, seed: int) -> None:
    """White, wandering over days and over weeks: 36 series of ten quantities, none with a change."""
    random = np.random.default_rng(900 + seed)
    white = random.standard_normal(COUNT)
    days = lfilter([1.0], [1.0, -0.7], random.standard_normal(COUNT))
    weeks = lfilter([1.0], [1.0, -0.95], random.standard_normal(COUNT)) + random.standard_normal(COUNT)
    for values in (white, days, weeks):
        assert found_in(line, values).found == ()


def test_too_few_recordings_say_no_change() -> None:
    line = Timeline(np.arange(7.0), np.ones(7))
    assert found_in(line, np.array([0.0, 0.1, 0, 9, 9.1, 9, 9.05])).found == ()


def test_uneven_days_and_poor_recordings() -> None:
    """A jump found at uneven times, though a third of the values have ten times the variance."""
    random = np.random.default_rng(12)
    time = np.cumsum(random.uniform(0.2, 3.0, COUNT))
    variance = np.where(random.random(COUNT) < 0.3, 10.0, 1.0)
    values = np.sqrt(variance) * random.standard_normal(COUNT) + 6 * (np.arange(COUNT) >= 70)
    (one,) = course_of(Series(Timeline(time, variance), values / values.std()), 10).found
    assert one.atom.kind == JUMP and one.dates[0] <= time[70] <= one.dates[1]


def test_jump_is_drawn_where_it_is() -> None:
    """A recording a day: the line keeps its value until the day of the jump, on a slope as well."""
    times: FloatArray = np.arange(6.0)
    line = 2.0 * times + np.where(times >= 3, 5.0, 0.0)
    at, drawn, band = with_steps(times, line, np.full(6, 0.1), [(3.0, 5.0)])
    np.testing.assert_array_equal(at, [0, 1, 2, 3, 3, 4, 5])
    np.testing.assert_allclose(drawn, [0, 2, 4, 6, 11, 13, 15])
    assert len(band) == 7
    untouched = with_steps(times, line, np.full(6, 0.1), [])
    np.testing.assert_array_equal(untouched[0], times)


def test_jump_among_averaged_recordings_is_no_ramp() -> None:
    """Twelve hundred recordings are averaged by two or three; each still lies before the jump or behind it."""
    random = np.random.default_rng(11)
    times = np.arange(1200.0)
    values = 0.05 * random.standard_normal(1200) + (times >= 600)
    found = _course(times, values, np.ones(1200), 1, {})
    (jump,) = found.found
    np.testing.assert_allclose(found.fitted, np.where(times >= jump.atom.date, 1.0, 0.0), atol=0.02)
    assert abs(jump.atom.date - 600) <= 3  # as coarse as the averages


def test_a_slope_that_begins_between_recordings_is_drawn_from_there() -> None:
    times = np.array([0.0, 1.0, 2.0, 12.0, 13.0])
    line = np.array([5.0, 5.0, 5.0, 7.0, 8.0])
    at, drawn, band = with_steps(times, line, np.full(5, 0.1), [], [10.0, 1.0])
    assert at.tolist() == [0.0, 1.0, 2.0, 10.0, 12.0, 13.0]
    assert drawn.tolist() == [5.0, 5.0, 5.0, 5.0, 7.0, 8.0]
    assert band.size == 6
