"""What the figures of an axis' parts draw: efficiency, life under a duty, carriages, life along a recording."""

from __future__ import annotations

import math

import numpy as np
import pytest

import feeddrive as fd
from feeddrive.interface.machine.summary import Summary
from feeddrive.parts.guide.guide_rating import RatedCarriage, RollingCarriage
from feeddrive.parts.life.consumed_life import consumed_life
from feeddrive.plant.analysis.nut_losses import nut_losses
from feeddrive.plant.analysis.rated_life import life_under, rated_life

DRAFT = {"screw": "32 x 10 mm", "length": "1.2 m", "motor": "400 W", "guide": "25", "mass": "80 kg"}


def summary(axis: fd.Axis) -> Summary:
    found = axis.summary()
    assert isinstance(found, Summary)
    return found


def test_efficiency_balances_the_power_of_screw_table_and_drags() -> None:
    losses = nut_losses(fd.load("hsr_axis").plant)
    assert losses is not None and losses.effect == "nut_friction" and losses.drag == pytest.approx(0.35)
    # f 0.006 at 45 deg, lead 16 mm on 41.4 mm, preload 3.6 kN shared rigidly; written out here from Lin's equations
    alpha, f, r = math.atan(16 / (math.pi * 41.4)), 0.006, 16e-3 / (2 * math.pi)
    root = math.sqrt(0.5 + math.tan(alpha) ** 2)
    a, b = math.cos(alpha) ** 2 * math.sqrt(0.5) * root, math.cos(alpha) ** 2 * root**2
    loaded, relieved = next(one.nut_loads for one in rated_life(fd.load("hsr_axis").plant) if one.force == 4000.0)
    torque = 4000 * r + r * (loaded * f / (a - f * b) + relieved * f / (a + f * b)) + 0.35
    assert losses.efficiency(4000.0) == pytest.approx(4000 * r / torque, rel=1e-9)
    back = 4000 * r - r * (loaded * f / (a + f * b) + relieved * f / (a - f * b)) - 0.35
    assert losses.efficiency(4000.0, driving=False) == pytest.approx(back / (4000 * r), rel=1e-9)
    assert losses.efficiency(10.0, driving=False) == 0.0
    leads = [losses.efficiency(4000.0, lead=lead) for lead in (4e-3, 8e-3, 16e-3, 32e-3)]
    assert leads == sorted(leads)  # the drag of the bearings counts less at a larger lead


def test_the_drag_of_a_drafted_axis_gives_its_friction() -> None:
    plant = fd.draft(**DRAFT).axis.plant
    losses = nut_losses(plant)
    assert losses is not None and losses.effect == "nut_drag"
    assert losses.screw.preload_torque(losses.preload) == pytest.approx(0.2074, rel=1e-3)
    # drafted for an efficiency of 95 % of the balls alone
    assert losses.screw.driving_efficiency == pytest.approx(0.95, abs=0.005)
    assert nut_losses(fd.load("kimm_testbed").plant) is None


def test_life_under_a_duty_is_the_sum_of_its_parts() -> None:
    plant = fd.load("hsr_axis").plant
    alone, loaded = (life_under(plant, [(1.0, force)]) for force in (0.0, 4000.0))
    assert [row.revolutions for row in rated_life(plant)] == [alone, loaded]
    mixed = life_under(plant, [(0.25, 4000.0), (0.75, 0.0)])
    assert loaded < mixed < alone
    # a motion of one turn in four under load, written as samples, takes as much
    angle = np.linspace(0.0, 8 * math.pi, 5)
    loads = np.array([[5789.43] + [3600.0] * 4, [1789.43] + [3600.0] * 4])
    taken = consumed_life(angle, loads, 52e3)
    assert taken.repetitions * 4 == pytest.approx(mixed, rel=1e-4)
    assert taken.equivalent[0] == pytest.approx((0.25 * 5789.43**3 + 0.75 * 3600**3) ** (1 / 3), rel=1e-9)
    with pytest.raises(fd.InputError, match="no dynamic rating"):
        life_under(fd.load("kimm_testbed").plant, [(1.0, 0.0)])


def test_carriages_come_from_the_file_and_their_friction_is_that_of_the_plant() -> None:
    written = summary(fd.load("hsr_axis")).carriages
    assert written is not None and isinstance(written.one, RollingCarriage)
    assert (written.count, written.seal_drag) == (4, 6.0)
    assert written.load == pytest.approx(320 * 9.80665 / 4)
    rated = summary(fd.draft(**DRAFT).axis).carriages
    assert rated is not None and isinstance(rated.one, RatedCarriage) and rated.name == "HGH25HA"
    assert summary(fd.load("kimm_testbed")).carriages is None


def test_every_axis_of_figures_names_its_unit_and_what_is_missing_is_said() -> None:
    for axis, drawn, left_out in (
        (fd.load("hsr_axis"), 5, 0),
        (fd.draft(**DRAFT).axis, 5, 0),
        (fd.load("kimm_testbed"), 2, 3),
        (fd.load("bench_axis"), 0, 4),
    ):
        found = summary(axis)
        figures = found._figures()
        assert len(figures) == drawn and len(found.not_drawn) == left_out
        for one in figures:
            for axes in one.figure.axes:
                assert axes.get_xlabel() == "" or axes.get_xlabel().endswith("]")
    assert all("declare" in line or "describe" in line for line in summary(fd.load("bench_axis")).not_drawn)


def test_life_draws_itself_where_a_rating_is_declared() -> None:
    left, right = fd.load("hsr_axis").life().plot().axes[:2]
    heights = left.lines[0].get_ydata()
    assert np.all(np.diff(heights) < 0) and right.lines[0].get_ydata()[0] == pytest.approx(heights[0])
    with pytest.raises(fd.InputError, match="nothing to draw"):
        fd.load("kimm_testbed").life().plot()
