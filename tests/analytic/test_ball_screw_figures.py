"""Figures of the ball screw show what the laws give, and draw without complaint."""

from __future__ import annotations

import math

import numpy as np
import pytest

from feeddrive.parts.screw.screw_friction import ScrewFriction, ScrewGeometry
from feeddrive.report.figures.drawing import render
from feeddrive.report.figures.figure_ball_screw import contact_angle_figure, double_nut_figure, efficiency_figure

SCREW = ScrewFriction(ScrewGeometry(0.01, 0.041, math.pi / 4), 0.034)


def test_efficiency_curves_start_at_their_limit() -> None:
    entry = efficiency_figure((0.01, 0.034), math.pi / 4)
    lines = entry.figure.axes[0].lines
    assert len(lines) == 4
    for line, f in zip(lines, (0.01, 0.01, 0.034, 0.034), strict=True):
        # 100 (1 - f)/(1 + f) at no lead; the first point is at 1e-4 rad.
        assert np.asarray(line.get_ydata())[0] == pytest.approx(100 * (1 - f) / (1 + f), rel=1e-6)
    assert render(entry).png.startswith(b"\x89PNG")


def test_best_contact_angles_are_marked_on_the_curves() -> None:
    entry = contact_angle_figure(0.034, [math.radians(4.44), math.radians(30)])
    marks = [line for line in entry.figure.axes[0].lines if line.get_marker() == "o"]
    assert [float(np.asarray(mark.get_xdata())[0]) for mark in marks] == pytest.approx([46.1524, 56.1247], abs=1e-4)
    assert render(entry).png.startswith(b"\x89PNG")


def test_friction_of_the_double_nut_is_drawn_positive() -> None:
    entry = double_nut_figure(SCREW, 3e3)
    drags = [line for line in entry.figure.axes[1].lines if len(np.asarray(line.get_xdata())) > 2]
    assert len(drags) == 4
    assert all(np.all(np.asarray(line.get_ydata()) >= -1e-12) for line in drags)  # rounding of a difference
    at_rest = np.asarray(drags[0].get_ydata())[200]
    assert at_rest == pytest.approx(SCREW.preload_torque(3e3), rel=1e-9)
    assert render(entry).png.startswith(b"\x89PNG")
