"""Numbers of a test after ISO 230-3 against closed forms."""

from __future__ import annotations

import numpy as np
import pytest

from feeddrive.errors import InputError
from feeddrive.metrology.axis_heating import axis_heating

TIMES = 30.0 * np.arange(1, 961)
STOP = 4 * 3600.0
TAU = 2400.0


def _error(scale: float) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    warm = scale * -np.expm1(-np.minimum(TIMES, STOP) / TAU)
    return np.where(TIMES <= STOP, warm, scale * -np.expm1(-STOP / TAU) * np.exp(-(TIMES - STOP) / TAU))


def test_numbers_of_exponentials() -> None:
    found = axis_heating(TIMES, np.column_stack([_error(10e-6), _error(-14e-6)]), np.array([0.2, 0.3]), STOP)
    near, far = found.targets
    top = 10e-6 * -np.expm1(-STOP / TAU)
    # Rounding: the rows hit 1 h and 4 h.
    assert near.first_hour == pytest.approx(10e-6 * -np.expm1(-1.5), rel=1e-12)
    assert near.heating == near.whole == near.largest == pytest.approx(top, rel=1e-12)
    assert far.largest == pytest.approx(-1.4 * top, rel=1e-12)
    assert found.slope == pytest.approx(-2.4 * top / 0.1, rel=1e-12)
    # 1 - exp(-t/τ) within 5 % of its value at the stop, next row.
    settled = -TAU * np.log(1 - 0.95 * -np.expm1(-STOP / TAU))
    assert settled <= near.settling <= settled + 30.0


def test_unusable_tests_are_refused() -> None:
    error = np.zeros((960, 2))
    with pytest.raises(InputError, match="heat for an hour"):
        axis_heating(TIMES, error, np.array([0.2, 0.3]), 1800.0)
    with pytest.raises(InputError, match="a column a target"):
        axis_heating(TIMES, error, np.array([0.2, 0.25, 0.3]), STOP)
    with pytest.raises(InputError, match="ascending"):
        axis_heating(TIMES[::-1], error, np.array([0.2, 0.3]), STOP)
