"""Observed orders of the finite volumes in space and of the implicit step in time."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.special import j0, j1

from feeddrive.thermal.full.full_model import discretise, full_model, model_of
from feeddrive.thermal.full.grid import Cells, cylinder
from feeddrive.thermal.reduced.system import HeatSystem
from feeddrive.thermal.rig import Steel
from tests.analytic.thermal_cases import BENCH, conductances, nut_heat

STEEL = Steel()


def _orders(errors: list[float]) -> list[float]:
    return [math.log2(a / b) for a, b in pairwise(errors)]


def _pole_error(radial: int, axial: int, film: float, exact: float) -> float:
    body = cylinder(0.0, 0.008, radial, 0.1, axial, STEEL)
    area = np.zeros(body.nodes)
    area[body.surface(-1)] = 2 * math.pi * 0.008 * body.spacing
    matrix = body.conduction() + np.diag(film * area)
    rates = np.sort(np.linalg.eigvals(matrix / body.capacities()[:, None]).real)
    return float(np.abs(rates - exact).min())


def test_order_over_the_radius_is_two() -> None:
    biot = 0.5
    root = brentq(lambda ζ: ζ * j1(ζ) - biot * j0(ζ), 0.1, 2.0)
    exact = STEEL.diffusivity * (root / 0.008) ** 2
    film = biot * STEEL.conductivity / 0.008
    errors = [_pole_error(n, 1, film, exact) for n in (4, 8, 16, 32)]
    assert _orders(errors) == pytest.approx([2.0, 2.0, 2.0], abs=0.1)


def test_order_along_the_axis_is_two() -> None:
    exact = STEEL.diffusivity * (math.pi / 0.1) ** 2
    errors = [_pole_error(1, n, 0.0, exact) for n in (10, 20, 40, 80)]
    assert _orders(errors) == pytest.approx([2.0, 2.0, 2.0], abs=0.1)


def _three_hours(cells: Cells) -> np.ndarray:
    system = full_model(BENCH.rig, cells).at(conductances(500))
    return np.asarray(system.step_response("nut", nut_heat(500), 180, 60.0)[-1])


def test_order_of_the_whole_model_in_space_is_two() -> None:
    coarse = Cells(50, 2, 10, 3)
    found = [_three_hours(coarse.refined(n)) for n in (1, 2, 4)]
    system = full_model(BENCH.rig, coarse).at(conductances(500))
    for name in ("nut", "shaft_travel"):
        row = system.row(name)
        first, second = (abs(found[i + 1][row] - found[i][row]) for i in (0, 1))
        # Contact and cover change within a cell at the ends of the travel, which costs a little of the order.
        assert math.log2(first / second) == pytest.approx(2.0, abs=0.25), name


def test_default_grid_is_within_three_millikelvin() -> None:
    fine, default = _three_hours(Cells(400, 8, 40, 12)), _three_hours(Cells())
    temperatures, growths = np.abs(fine - default)[:4], np.abs(fine - default)[4:]
    # A third of the difference to a grid twice as fine is left; the sensors' noise is 30 mK and 150 nm.
    assert temperatures.max() < 3e-3
    assert growths.max() < 5e-9


def test_implicit_step_is_of_second_order() -> None:
    system: HeatSystem = model_of(discretise(BENCH.rig, Cells(50, 2, 10, 3)), BENCH.rig.travel).at(conductances(500))
    given = np.eye(len(system.input_names))[0] * nut_heat(500)
    warm = system.simulate(np.tile(given, (60, 1)), 60.0)[-1]
    # Smooth decay from a warm state, so that the quickest modes are gone already.
    rest = np.zeros(len(system.input_names))

    def decayed(step: float) -> float:
        states = system.simulate(np.tile(rest, (round(3600 / step), 1)), step, warm)
        return float((states[-1] @ system.rows.T)[0])

    exact = decayed(3.75)
    errors = [abs(decayed(step) - exact) for step in (240.0, 120.0, 60.0, 30.0)]
    # The first step is long beside the second time constant; 3.75 s stands for the exact value.
    assert _orders(errors)[1:] == pytest.approx([2.0, 2.0], abs=0.15)


def test_default_grid_resolves_a_heated_seat() -> None:
    found = []
    for cells in (Cells(), Cells(600, 4, 20, 6)):
        system = full_model(BENCH.rig, cells).at(conductances(500))
        found.append(float(system.gain()[system.row("front"), system.column("front")]))
    # 1 W on 10 mm of the surface: what the axial cells leave is below 15 mK, half the sensors' noise.
    assert abs(found[0] - found[1]) < 0.015
