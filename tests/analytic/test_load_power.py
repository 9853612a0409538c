"""Friction that goes with a power of the load: its law, and that it costs nothing where it is in proportion."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest

from feeddrive.diagnosis.likelihood.coordinates import read_coordinates
from feeddrive.effects.base import Motion
from feeddrive.effects.friction.load_dependent_friction import FIRST_POWER, LoadDependentFriction
from feeddrive.files import find_plant
from feeddrive.plant.file.plant_file import read_plant
from feeddrive.plant.structure import left_out
from feeddrive.typing import FloatArray

RADIUS, AT = 0.02 / (2 * np.pi), 400.0
FORCES: FloatArray = np.array([-2000.0, -400.0, -40.0, 4.0, 400.0, 1300.0])


def level(effect: LoadDependentFriction, force: FloatArray) -> FloatArray:
    f = ca.SX.sym("f")
    made = effect.level(Motion(0.0, 0.0, force=f, radius=RADIUS), effect.values)
    return np.array(ca.Function("level", [f], [made])(force[None, :])).ravel()


@pytest.mark.parametrize("at", [1.0, AT])
def test_without_a_bend_it_is_in_proportion_wherever_it_is_stated(at: float) -> None:
    effect = LoadDependentFriction.of(coefficient=0.07, at_force=at)
    assert level(effect, FORCES) == pytest.approx(0.07 * RADIUS * np.abs(FORCES), rel=1e-12)


@pytest.mark.parametrize("bend", [1 / 3, -1 / 3])
def test_it_is_the_coefficient_where_it_is_stated_and_a_power_elsewhere(bend: float) -> None:
    effect = LoadDependentFriction.of(coefficient=0.07, bend=bend, at_force=AT)
    expected = 0.07 * RADIUS * np.abs(FORCES) * (np.abs(FORCES) / AT) ** bend
    # at a hundredth of F0 the first power within a thousandth of it is a share b / 2 of a hundredth
    assert level(effect, FORCES) == pytest.approx(expected, rel=0.5 * abs(bend) * (FIRST_POWER / 0.01) ** 2 * 1.01)


def test_its_slope_about_no_force_is_finite() -> None:
    effect = LoadDependentFriction.of(coefficient=0.07, bend=-1 / 3, at_force=AT)
    near = level(effect, np.array([0.0, 1e-9 * AT]))
    assert near[0] == 0.0
    assert near[1] / (1e-9 * AT) == pytest.approx(0.07 * RADIUS * FIRST_POWER ** (-1 / 3), rel=1e-6)


def test_a_bend_of_none_is_neither_computed_nor_fitted() -> None:
    plain, bent = (LoadDependentFriction.of(coefficient=0.07, bend=bend, at_force=AT) for bend in (0.0, 1 / 3))
    plant = read_plant(find_plant("bench_axis"))
    assert (left_out(plain), left_out(bent)) == (("bend",), ())
    symbols = {"coefficient": ca.SX.sym("c"), "bend": ca.SX(0), "at_force": ca.SX.sym("at")}
    made = plain.level(Motion(0.0, 0.0, force=ca.SX.sym("f"), radius=RADIUS), symbols)
    assert not ca.depends_on(made, symbols["at_force"])
    assert [len(read_coordinates([one], plant)) for one in (plain, bent)] == [1, 2]
