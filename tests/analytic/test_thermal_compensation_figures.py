"""Figures of the ISO 230-3 test and of compensations: what they draw, and what they refuse."""

from __future__ import annotations

import numpy as np
import pytest

from feeddrive.errors import InputError
from feeddrive.report.figures.drawing import render
from feeddrive.report.figures.figure_compensation import axis_heating_figure, compensation_figure, stroke_figure

TIMES = 60.0 * np.arange(1, 121)
POSITIONS = np.linspace(0.2, 0.3, 5)
ERROR = np.multiply.outer(-np.expm1(-TIMES / 1800), 1e-4 * POSITIONS)


def test_ends_and_middle_are_drawn_in_micrometres() -> None:
    entry = axis_heating_figure(TIMES, POSITIONS, ERROR, {"nut": 23 + TIMES / 1e3}, 3600.0)
    upper, lower = entry.figure.axes
    lines = [line for line in upper.get_lines() if not line.get_label().startswith("_")]
    assert [line.get_label() for line in lines] == ["at 200 mm", "at 250 mm", "at 300 mm"]
    np.testing.assert_allclose(lines[2].get_ydata(), ERROR[:, 4] * 1e6)
    np.testing.assert_allclose(lines[2].get_xdata(), TIMES / 3600)
    assert "axis stops" in [text.get_text() for text in upper.texts]
    assert lower.get_ylabel() == "temperature [°C]"


def test_compensation_shows_what_is_left() -> None:
    entry = compensation_figure(TIMES, POSITIONS, ERROR, {"half": ERROR / 2}, 3600.0)
    upper, lower = entry.figure.axes
    whole, half = upper.get_lines()[:2]
    np.testing.assert_allclose(half.get_ydata(), np.asarray(whole.get_ydata()) / 2)
    np.testing.assert_allclose(lower.get_lines()[0].get_ydata(), ERROR[:, 4] * 1e6 / 2)
    assert render(entry).png.startswith(b"\x89PNG")


def test_moments_are_named_by_the_clock() -> None:
    entry = stroke_figure(TIMES, POSITIONS, ERROR, ERROR, [900.0, 3600.0])
    labels = [line.get_label() for line in entry.figure.axes[0].get_lines()]
    assert labels[::2] == ["0 h 15 min", "1 h 00 min"]
    with pytest.raises(InputError, match="before the first time"):
        stroke_figure(TIMES, POSITIONS, ERROR, ERROR, [10.0])


def test_series_that_do_not_fit_are_refused() -> None:
    with pytest.raises(InputError, match="half of shape"):
        compensation_figure(TIMES, POSITIONS, ERROR, {"half": ERROR[:-1]}, 3600.0)
