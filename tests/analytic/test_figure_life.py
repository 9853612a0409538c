"""Figures of life: what is drawn is what was computed, and the captions say it."""

from __future__ import annotations

import math

import numpy as np
import pytest

from feeddrive.parts.life.consumed_life import consumed_life, rigid_nut_forces
from feeddrive.parts.life.weibull import life_sample, likelihood_fit
from feeddrive.parts.screw.load_distribution import load_distribution, nut_body
from feeddrive.parts.screw.screw_contact import BallTrack
from feeddrive.report.figures.drawing import render
from feeddrive.report.figures.figure_life import consumed_life_figure, load_distribution_figure, weibull_figure
from feeddrive.report.words.people import significant

LIVES = [250e3, 300e3, 310e3, 380e3, 420e3, 440e3]


def test_weibull_figure_shows_points_line_and_suspensions() -> None:
    sample = life_sample(LIVES, [440e3, 450e3])
    made = weibull_figure(sample)
    law = likelihood_fit(sample)
    assert "6 failures of 8 specimens" in made.caption
    assert f"L10 {significant(law.life())} rev" in made.caption
    lines = {line.get_label(): line for line in made.figure.axes[0].get_lines()}
    assert lines["failures at median ranks"].get_xdata() == pytest.approx(LIVES)
    assert lines["suspended"].get_xdata() == pytest.approx([440e3, 450e3])
    fit = lines["maximum likelihood"]
    # In Weibull paper the law is a straight line of its own slope.
    steps = np.diff(np.asarray(fit.get_ydata(), dtype=float)) / np.diff(
        np.log(np.asarray(fit.get_xdata(), dtype=float))
    )
    assert steps == pytest.approx(np.full(steps.size, law.slope), rel=1e-9)
    assert render(made).png.startswith(b"\x89PNG")


def test_weibull_figure_without_suspensions_and_in_other_units() -> None:
    made = weibull_figure(life_sample([0.25, 0.3, 0.42]), unit="10^6 rev")
    labels = [line.get_label() for line in made.figure.axes[0].get_lines()]
    assert "suspended" not in labels
    assert render(made).png


def test_load_distribution_figure_draws_every_ball() -> None:
    track = BallTrack(3.175e-3, 25.5e-3, 0.55, math.radians(45), 6e-3, 2.5)
    loads = load_distribution(nut_body(track, 0.04), 13.5e3)
    made = load_distribution_figure([("2.5 turns", loads)])
    assert made.figure.axes[0].get_lines()[0].get_ydata() == pytest.approx(loads.relative)
    assert "2.5 turns 1.08" in made.caption
    assert render(made).png


def test_consumed_life_figure_tells_what_is_used() -> None:
    time = np.linspace(0.0, 1.0, 101)
    forces = rigid_nut_forces(np.full(101, 1e3), 2e3)
    used = consumed_life(2 * math.pi * 10.0 * time, forces, 9.6e3)
    made = consumed_life_figure(time, forces, used)
    assert "10.0 revolutions use" in made.caption
    assert f"survive {significant(used.repetitions)} repetitions" in made.caption
    curve = made.figure.axes[1].get_lines()[0]
    assert float(curve.get_ydata()[-1]) == pytest.approx(1e6 * used.total[0])  # in ppm
    assert render(made).png


def test_consumed_life_figure_of_a_screw_at_rest() -> None:
    time = np.array([0.0, 1.0])
    forces = np.zeros((1, 2))
    made = consumed_life_figure(time, forces, consumed_life(np.zeros(2), forces, 9e3))
    assert "no life is used" in made.caption
    assert render(made).png
