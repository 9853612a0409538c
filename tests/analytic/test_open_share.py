"""What judged data say that are few: a real effect that they hardly show is not denied by them alone."""

from __future__ import annotations

import numpy as np
import pytest

from feeddrive.diagnosis.judging.judge import Share
from feeddrive.diagnosis.likelihood.cross_validation import compare_left_out, compare_levelled

BLOCKS, ROWS = 24, 40


def share(size: float, truth: float, seed: int) -> Share:
    """An effect that predicts `size` standard deviations of the noise in all, of which `truth` is there."""
    random = np.random.default_rng(seed)
    noise, shape = random.standard_normal(BLOCKS * ROWS), random.standard_normal(BLOCKS * ROWS)
    shape *= size / np.linalg.norm(shape)
    before = noise + truth * shape
    blocks = np.repeat(np.arange(BLOCKS), ROWS)
    comparison = compare_left_out(before, before - shape, blocks, 0.0)
    # as `share_beyond`: what it predicts over the scatter of the gain
    predicted = 2 * size**2 / (comparison.standard_error * float(before @ before))
    return Share({}, comparison, predicted, compare_levelled(before, before - shape, blocks, 0.0))


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


def test_one_block_that_no_law_reaches_does_not_deny_what_all_others_show() -> None:
    random = np.random.default_rng(3)
    blocks = np.repeat(np.arange(BLOCKS), ROWS)
    shape = random.standard_normal(BLOCKS * ROWS)
    before = random.standard_normal(BLOCKS * ROWS) + shape
    # in one block the torque is far beyond what was fitted: half is there of what the law says
    shape[blocks == 7] *= 60.0
    before[blocks == 7] = 0.6 * shape[blocks == 7]
    after = before - shape
    one = Share({}, compare_left_out(before, after, blocks, 0.0), 2.4, compare_levelled(before, after, blocks, 0.0))
    assert 0 < one.comparison.gain < one.comparison.standard_error and one.carries
    # what makes the errors of the whole larger is denied whatever the others show
    before[blocks == 7] *= 0.5
    after = before - shape
    one = Share({}, compare_left_out(before, after, blocks, 0.0), 2.4, compare_levelled(before, after, blocks, 0.0))
    assert one.comparison.gain < 0 and not one.carries
