"""Figures of the ball guide show the numbers of the program."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from feeddrive.parts.guide.guide_carriage import carriage_friction
from feeddrive.parts.guide.guide_coefficients import SET_A
from feeddrive.parts.guide.guide_equilibrium import guide_equilibrium
from feeddrive.parts.guide.guide_geometry import HSR_20R, HSR_30R
from feeddrive.parts.guide.guide_stiffness import unloading_force
from feeddrive.report.figures.drawing import render
from feeddrive.report.figures.figure_guide import guide_ball_load_figure, guide_friction_figure, guide_shares_figure


def test_shares_fill_each_panel() -> None:
    entry = guide_shares_figure(HSR_20R, SET_A, (0.0, 24e3))
    assert len(entry.figure.axes) == 2
    rolling = entry.figure.axes[0].collections[0].get_paths()[0].vertices
    found = 100.0 * float(carriage_friction(HSR_20R, SET_A, 0.06 / 60).shares()[0])
    at_left = rolling[np.isclose(rolling[:, 0], 0.06)]
    assert at_left[:, 1].max() == pytest.approx(found, rel=1e-9)  # the same numbers
    assert render(entry).png.startswith(b"\x89PNG")


def test_friction_over_speed_and_load() -> None:
    left, right = guide_friction_figure(HSR_20R, SET_A, (0.0, 6e3), (0.05, 0.2), seal_drag=2.0).figure.axes
    speed, force = left.lines[1].get_data()
    assert force[-1] == pytest.approx(float(carriage_friction(HSR_20R, SET_A, speed[-1] / 60, 6e3).total) + 2.0)
    assert right.lines[0].get_data()[1][-1] == pytest.approx(
        float(carriage_friction(HSR_20R, SET_A, 0.05, 6e3).total) + 2.0
    )


def test_ball_loads_end_where_contact_is_lost() -> None:
    axes = guide_ball_load_figure(HSR_30R, (5e-6,)).figure.axes[0]
    pressed, relieved, dot = axes.lines
    assert pressed.get_data()[1][0] == pytest.approx(float(guide_equilibrium(HSR_30R, 0.0).ball_load[2]))
    assert relieved.get_data()[0][-1] == dot.get_data()[0][0] == pytest.approx(1e-3 * unloading_force(HSR_30R))
    assert relieved.get_data()[1][-1] == pytest.approx(0.0, abs=1e-3)


def test_guide_without_preload_is_drawn() -> None:
    axes = guide_ball_load_figure(replace(HSR_30R, preload_oversize=0.0)).figure.axes[0]
    assert axes.get_xlim()[1] == 10.0
