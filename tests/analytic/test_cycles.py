"""What comes again with the motion is one error, however often: its sums scatter as those of one cycle."""

from __future__ import annotations

import gc
from weakref import ref

import numpy as np
import pytest

from feeddrive.diagnosis.certainty.noise_colour import score_covariance
from feeddrive.diagnosis.likelihood.evidence import Evidence
from feeddrive.diagnosis.motion.cycle import cycle_of
from feeddrive.recording import Recording
from feeddrive.typing import FloatArray

STEP = 0.01
LENGTH, CYCLES = 743, 6
"""Samples of a cycle but for a quarter of one, and how many there are."""


def angle(cycles: int = CYCLES, stretch: float = 1.0) -> FloatArray:
    """Strokes to and fro that come again every 7.4325 s, the last of `cycles` of another speed."""
    time = STEP * np.arange(round(cycles * (LENGTH + 0.25)))
    phase = time / (STEP * (LENGTH + 0.25))
    turned = np.where(phase >= cycles - 1, stretch, 1.0) * phase % 1.0
    return 50.0 * np.interp(turned, [0.0, 0.4, 0.5, 0.9, 1.0], [0.0, 1.0, 1.0, 0.0, 0.0])


def recorded(motion: FloatArray) -> Recording:
    """A recording of a motion."""
    return Recording.from_arrays(time=STEP * np.arange(len(motion)), motor_angle=motion, motor_torque=motion)


def evidence(motion: FloatArray) -> Evidence:
    """Two channels of a recording, all of their samples fitted."""
    all_rows, none = np.ones(len(motion), dtype=bool), dict[str, float]()
    measured = {name: np.zeros(len(motion)) for name in ("motor_torque", "table_position")}
    return Evidence(recorded(motion), measured, dict.fromkeys(measured, 1.0), all_rows, all_rows, 5.0, 0.5, 1, (), none)


def test_the_cycle_of_a_programme_is_found_to_a_part_of_a_sample() -> None:
    assert cycle_of(recorded(angle()), 1, 100) == pytest.approx(LENGTH + 0.25, abs=0.1)
    assert cycle_of(recorded(angle()), 2, 50) == pytest.approx((LENGTH + 0.25) / 2, abs=0.1)
    # a cycle that is asked for beyond its own length is the next one
    assert cycle_of(recorded(angle()), 1, 800) == pytest.approx(2 * (LENGTH + 0.25), abs=0.1)


@pytest.mark.parametrize(
    "motion",
    [
        angle(cycles=2, stretch=1.4),
        100.0 * STEP * np.arange(4000),  # goes on as it was
        np.cumsum(np.random.default_rng(1).standard_normal(4000)),
        np.zeros(4000),
    ],
)
def test_what_does_not_come_again_has_no_cycle(motion: FloatArray) -> None:
    assert cycle_of(recorded(motion), 1, 100) == 0.0


def test_a_recording_is_not_kept_for_its_cycle() -> None:
    """Hours of recordings, one after the other, are no memory of a program that goes through them."""
    one = recorded(angle())
    assert cycle_of(one, 1, 100) == cycle_of(one, 1, 100)
    alive = ref(one)
    del one
    gc.collect()
    assert alive() is None


def test_a_cycle_that_the_fitted_rows_do_not_hold_is_none() -> None:
    """Less than one of three cycles is fitted: nothing comes again in it."""
    one = evidence(angle(cycles=3))
    few = np.arange(len(one.counted)) < LENGTH - 40
    residual = np.random.default_rng(2).standard_normal(2 * int(few.sum()))
    assert cycle_of(one.recording, 1, 100) > 0
    told = score_covariance([one], [few], residual, np.ones((len(residual), 1)))
    assert told[0, 0] > 0


@pytest.mark.parametrize("share", [0.0, 0.5, 1.0])
def test_sums_of_what_comes_again_scatter_as_they_do(share: float) -> None:
    """Of noise a part of which is that of the first cycle again, over many draws, along three columns."""
    random = np.random.default_rng(11)
    one, n = evidence(angle()), len(angle())
    phase = np.arange(n) / (LENGTH + 0.25) % 1.0
    again, once = np.sin(2 * np.pi * 40 * phase), np.sin(2 * np.pi * 0.0531 * np.arange(n))
    columns = np.zeros((2 * n, 3))
    columns[:n, 0], columns[n:, 1], columns[:n, 2] = again, again, once
    sums, told = [], []
    for _ in range(60):
        rows = []
        for _ in range(2):
            # interpolated between samples of a cycle that is no whole number of them
            first, noise = random.standard_normal(LENGTH + 1), random.standard_normal(n)
            held = first[np.floor(phase * LENGTH).astype(int)]
            rows.append(np.sqrt(share) * held + np.sqrt(1 - share) * noise)
        residual = np.concatenate(rows)
        sums.append(columns.T @ residual)
        told.append(np.diag(score_covariance([one], [one.fit_rows], residual, columns)))
    # 60 draws tell a variance to 18 %, twice that is chance in one of twenty
    assert np.mean(told, axis=0)[:2] == pytest.approx(np.mean(np.square(sums), axis=0)[:2], rel=0.4)
    # along what comes again a share is correlated over six cycles
    assert np.mean(told, axis=0)[0] / (n / 2) == pytest.approx(1 + (CYCLES - 1) * share, rel=0.2)
    # a column that is half a period on after every cycle meets it with either sign, and no more of it than of noise
    assert np.mean(told, axis=0)[2] / (n / 2) < 1.1
