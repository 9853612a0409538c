"""A linear step of a set within what is physical, beside scipy's bounded least squares."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import lsq_linear

from feeddrive.diagnosis.finding.columns import within


@pytest.mark.parametrize("seed", range(20))
def test_with_one_coordinate_at_its_end_the_others_are_solved_anew(seed: int) -> None:
    """Where one end is passed, what is held there is right, and the rest is a smaller least squares problem."""
    rng = np.random.default_rng(seed)
    columns, target = rng.standard_normal((30, 4)), rng.standard_normal(30)
    normal, wanted = columns.T @ columns, columns.T @ target
    step = np.linalg.solve(normal, wanted)
    low, high = np.full(4, -np.inf), np.full(4, np.inf)
    (high if step[2] > 0 else low)[2] = 0.5 * step[2]
    exact = lsq_linear(columns, target, bounds=(low, high), tol=1e-14).x
    np.testing.assert_allclose(within(normal, wanted, step, low, high), exact, rtol=1e-6, atol=1e-9)


def test_no_coordinate_leaves_its_range() -> None:
    """Whatever the ends are that leave no step at all."""
    rng = np.random.default_rng(7)
    for _ in range(50):
        columns, target = rng.standard_normal((20, 5)), 3 * rng.standard_normal(20)
        normal, wanted = columns.T @ columns, columns.T @ target
        low, high = -rng.uniform(0, 1, 5), rng.uniform(0, 1, 5)
        there = within(normal, wanted, np.linalg.solve(normal, wanted), low, high)
        assert np.all(there >= low - 1e-12) and np.all(there <= high + 1e-12)


def test_a_step_within_its_range_stays_as_it_is() -> None:
    """No end is near."""
    step = np.array([1.0, -2.0])
    ends = np.full(2, np.inf)
    np.testing.assert_array_equal(within(np.eye(2), step, step, -ends, ends), step)
