"""What judged data say that are few: a real effect that they hardly show is not denied by them alone."""

from __future__ import annotations

import numpy as np
import pytest

from feeddrive.diagnosis.judging.judge import Share
from feeddrive.diagnosis.likelihood.cross_validation import compare_left_out

BLOCKS, ROWS = 24, 40


def share(size: float, truth: float, seed: int) -> Share:
    """An effect that predicts `size` standard deviations of the noise in all, of which `truth` is there."""
    random = np.random.default_rng(seed)
    noise, shape = random.standard_normal(BLOCKS * ROWS), random.standard_normal(BLOCKS * ROWS)
    shape *= size / np.linalg.norm(shape)
    before = noise + truth * shape
    comparison = compare_left_out(before, before - shape, np.repeat(np.arange(BLOCKS), ROWS), 0.0)
    # as `share_beyond`: what it predicts over the scatter of the gain
    predicted = 2 * size**2 / (comparison.standard_error * float(before @ before))
    return Share({}, comparison, predicted)


@pytest.mark.parametrize("size", [3.5, 5.0])
def test_real_effect_that_is_hardly_shown_is_kept_or_left_open(size: float) -> None:
    seen = [share(size, 1.0, seed) for seed in range(200)]
    by_scatter = np.mean([one.carries for one in seen])
    kept = np.mean([one.carries or one.is_open or not one.shows for one in seen])
    # of a size that scatters by one about half of it, one of three or ten lies within its standard error
    assert by_scatter < 0.95 < kept


def test_effect_that_is_not_there_is_denied_or_asked_of_the_blocks_left_out() -> None:
    seen = [share(5.0, 0.0, seed) for seed in range(200)]
    # a gain beyond none is 2.5 deviations away: one of two hundred, and as many for the scatter's own error
    assert np.mean([one.carries or one.is_open for one in seen]) < 0.02


def test_large_effect_that_gains_nothing_is_denied() -> None:
    # half of it is there: it gains as much as it loses, which few data do not excuse
    seen = [share(20.0, 0.5, seed) for seed in range(50)]
    assert not any(one.is_open for one in seen)
