"""The order at which a sine fits best beside a slow curve, against least squares at every order."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

from feeddrive.diagnosis.motion.lead_map import lead_map
from feeddrive.diagnosis.unexplained.sine_order import ROWS, SineOrder
from feeddrive.typing import FloatArray


def left_by(angle: FloatArray, series: FloatArray, order: float) -> float:
    """Squared error of a sine and the slow curve, by least squares."""
    columns = np.column_stack([np.sin(order * angle), np.cos(order * angle), np.ones(len(angle)), lead_map(angle, 1.0)])
    columns /= np.linalg.norm(columns, axis=0)
    values = np.linalg.lstsq(columns, series, rcond=None)[0]
    return float(np.sum((series - columns @ values) ** 2))


@pytest.mark.parametrize("order", [0.73, 4.0, 29.3])
@pytest.mark.parametrize("middle", [0.0, 300.0], ids=["about zero", "far from it"])
@pytest.mark.parametrize("rows", [ROWS - 1, 3 * ROWS + 5], ids=["one part", "several parts"])
def test_order_is_that_of_least_squares_near_the_peak(order: float, middle: float, rows: int) -> None:
    draw = np.random.default_rng(rows)
    angle = middle + 40.0 * np.sin(np.linspace(0.0, 9.0, rows))
    curve = ((angle - middle) / 40.0) ** 2
    series = 0.3 * np.sin(order * angle + 1.0) + curve + draw.standard_normal(rows)
    width = np.pi / np.ptp(angle)
    begun = order + draw.uniform(-0.5, 0.5) * width
    found = SineOrder(angle).near(begun, series)
    bounds = begun - width, begun + width
    best = minimize_scalar(
        lambda n: left_by(angle, series, n), bounds=bounds, method="bounded", options={"xatol": 1e-9}
    )
    # both searches end within 1e-3 of the width; the ridge of one on thousands of rows moves the order by less
    assert found == pytest.approx(best.x, abs=3e-3 * width)
    assert abs(found - order) < 0.4 * width  # five deviations by the noise
