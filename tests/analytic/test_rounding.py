"""Rounding to steps: how often rows toggle under a noise, and what comes again of the error, against drawn rows."""

from __future__ import annotations

import numpy as np
import pytest

from feeddrive.diagnosis.motion.rounding import BROKEN_UP, noise_over_step, rounding_of, toggling


@pytest.mark.parametrize("through", [0.0, 0.3])
@pytest.mark.parametrize("noise", [0.02, 0.1, 0.3, 0.5, 1.0])
def test_rows_toggle_as_often_as_the_noise_says(noise: float, through: float) -> None:
    rng, gone = np.random.default_rng(3), np.array([through])
    rows = rng.uniform(size=400_000)[:, None] + [0.0, through] + noise * rng.standard_normal((400_000, 2))
    toggled = float(np.mean(np.diff(np.round(rows), axis=1) != 0))
    # four deviations of a share of 400 000
    assert toggling(noise, gone) == pytest.approx(toggled, abs=4 * np.sqrt(toggled / 400_000))
    if noise < BROKEN_UP and not through:  # a torque that moves toggles as many rows without noise as beside a little
        assert noise_over_step(toggling(noise, gone), gone) == pytest.approx(noise, rel=1e-9)


def test_noise_of_more_than_half_a_step_breaks_the_rounding_up() -> None:
    steady = np.zeros(1)
    assert noise_over_step(toggling(0.7, steady), steady) == BROKEN_UP
    rng = np.random.default_rng(4)
    torque = 0.01 * np.round((0.5 + 0.01 * rng.standard_normal(5000)) / 0.01)
    assert rounding_of(torque, np.full(5000, 0.5), 0.01, np.ones(5000, dtype=np.bool_)) is None


def test_what_comes_again_is_as_large_as_it_is_on_the_mean() -> None:
    """At steady torques anywhere between two steps, under noise of a tenth of one."""
    rng, step = np.random.default_rng(5), 0.2
    levels = rng.uniform(-3, 3, 300)
    torques = np.repeat(levels, 400)
    recorded = step * np.round((torques + 0.1 * step * rng.standard_normal(len(torques))) / step)
    found = rounding_of(recorded, torques, step, np.ones(len(torques), dtype=np.bool_))
    assert found is not None
    mean = np.mean((recorded - torques).reshape(300, 400), axis=1)
    # a mean square of 300 values that are even between ends is known to 0.9 / sqrt(300), at three deviations; the
    # noise between rows leaves a four-hundredth of a twelfth of its own
    assert found.size == pytest.approx(np.sqrt(np.mean(mean**2)), rel=0.5 * 3 * 0.9 / np.sqrt(300))


def test_its_columns_hold_the_error_of_steady_torques() -> None:
    """Four speeds to and fro, the torque off by a friction of its own at each: what is left beside S is nothing."""
    rng, step = np.random.default_rng(6), 0.1
    true = np.repeat(rng.uniform(0.3, 1.3, 4)[[0, 1, 2, 3, 1, 0, 3, 2]], 500)
    declared = true * (1 + 0.1 * np.sin(true / 0.2))
    recorded = step * np.round(true / step)
    found = rounding_of(recorded, declared, step, np.ones(len(true), dtype=np.bool_))
    assert found is not None
    columns = np.column_stack(list(found.parts()))
    error = recorded - true
    # each of four levels has a column of its own phase: the error lies in their span but for rounding of numbers
    left = error - columns @ np.linalg.lstsq(columns, error, rcond=None)[0]
    assert np.linalg.norm(left) < 1e-9 * np.linalg.norm(error)


def test_rows_that_a_moving_torque_steps_through_are_no_noise() -> None:
    ramp = np.linspace(0, 2, 5000)
    found = rounding_of(0.01 * np.round(ramp / 0.01), ramp, 0.01, np.ones(5000, dtype=np.bool_))
    assert found is not None
    # 200 steps in 5000 rows are those of the ramp: without noise all of Δ / sqrt(12) comes again, of nine waves 0.97
    assert found.size == pytest.approx(0.01 / np.sqrt(12), rel=0.04)
