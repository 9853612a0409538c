"""Guide friction in the plant: the curve and the film that it may hold, and what the parts hand over."""

from __future__ import annotations

import math
from pathlib import Path

import casadi as ca
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.interpolate import CubicHermiteSpline, PchipInterpolator

from feeddrive.effects.base import Motion, Port
from feeddrive.effects.friction.guide_friction import REST_VELOCITY, GuideFriction, guide_effect, smooth_curve
from feeddrive.errors import InputError
from feeddrive.files import plants_folder
from feeddrive.parts.guide.guide_carriage import table_friction
from feeddrive.parts.guide.guide_coefficients import SET_A, SET_B
from feeddrive.parts.guide.guide_geometry import HSR_20R, HSR_30R
from feeddrive.plant.file.lumped_text import plant_text_with_effects
from feeddrive.plant.file.plant_file import read_plant
from feeddrive.plant.friction_law import friction_force
from feeddrive.plant.plant import Plant
from feeddrive.plant.structure import parameter_symbols, parameter_values

BENCH = plants_folder() / "bench_axis.toml"
SPEEDS = (0.0, 0.01, 0.05, 0.1, 0.2)
MEASURED = (70.0, 60.0, 60.0, 66.0, 80.0)


def _forces(effect: GuideFriction, velocities: list[float]) -> np.ndarray:
    plant = Plant("alone", read_plant(BENCH).chain, (effect,))
    symbols, v = parameter_symbols(plant), ca.SX.sym("v")
    force = friction_force(plant, symbols, Port.TABLE, Motion(ca.SX(0), v))
    evaluate = ca.Function("force", [v, symbols.vector], [force])
    return np.array([float(evaluate(one, parameter_values(plant))) for one in velocities])


def _curve(nodes: list[float], values: list[float], x: np.ndarray) -> np.ndarray:
    at = ca.SX.sym("x")
    evaluate = ca.Function("curve", [at], [smooth_curve(at, ca.SX(ca.DM(nodes)), ca.SX(ca.DM(values)))])
    return np.array(evaluate(x[None, :])).ravel()


@given(
    st.lists(st.floats(0.01, 1.0), min_size=2, max_size=7),
    st.lists(st.sampled_from([0.0, 1.0, 2.0, 5.0, 40.0]), min_size=8, max_size=8),
)
def test_curve_is_the_monotone_cubic(widths: list[float], values: list[float]) -> None:
    nodes = np.concatenate([[0.0], np.cumsum(widths)])
    levels = np.array(values[: nodes.size])
    slopes = PchipInterpolator(nodes, levels).derivative()(nodes)
    slopes[[0, -1]] = np.diff(levels)[[0, -1]] / np.diff(nodes)[[0, -1]]  # chords at the ends
    x = np.linspace(0.0, nodes[-1], 50)
    expected = CubicHermiteSpline(nodes, levels, slopes)(x)
    # The same cubic in another order of operations, its differences taken of levels up to 40.
    assert _curve(list(nodes), list(levels), x) == pytest.approx(expected, abs=1e-11)


def test_curve_is_constant_outside_and_passes_its_points() -> None:
    x = np.array([-1.0, *SPEEDS, 0.5])
    assert _curve(list(SPEEDS), list(MEASURED), x) == pytest.approx([70.0, *MEASURED, 80.0], rel=1e-14)


def test_measured_curve_is_the_friction_of_the_table() -> None:
    effect = GuideFriction.of(coulomb=0.0, smoothing_velocity=1e-4, velocity=SPEEDS, force=MEASURED)
    # tanh(0.01 / 1e-4) is 1 to the last digit.
    assert _forces(effect, list(SPEEDS)) == pytest.approx([0.0, *MEASURED[1:]], rel=1e-14)
    assert _forces(effect, [-v for v in SPEEDS]) == pytest.approx([0.0, *(-F for F in MEASURED[1:])], rel=1e-14)


def test_plain_friction_holds_no_more_than_before() -> None:
    effect = GuideFriction.of(coulomb=60.0, smoothing_velocity=1e-3, viscous=300.0)
    assert set(effect.values) == {"coulomb", "smoothing_velocity", "viscous"}


@given(st.floats(0.0, 100.0), st.floats(0.1, 1.0), st.floats(1e-9, 2.0), st.floats(1.0001, 2.0))
def test_film_rises_from_nothing_and_resists(force: float, exponent: float, speed: float, factor: float) -> None:
    effect = GuideFriction.of(coulomb=0.0, smoothing_velocity=1e-3, film_force=force, film_exponent=exponent)
    back, rest, slow, fast = _forces(effect, [-speed, 0.0, speed, speed * factor])
    assert rest == 0.0
    assert back == -slow
    assert 0.0 <= slow <= fast
    if speed > 100 * REST_VELOCITY:
        assert slow == pytest.approx(force * speed**exponent, rel=5e-5)  # half (eps/v)^2


@pytest.mark.parametrize("guide", [HSR_20R, HSR_30R], ids=["20", "30"])
@pytest.mark.parametrize("load", [0.0, 3e3, 12e3])
def test_what_the_parts_hand_over(guide, load: float) -> None:
    effect = guide_effect(guide, SET_A, 4, load, seal_drag=3.0, smoothing_velocity=1e-4)
    speeds = np.geomspace(1e-3, 2.0, 30)
    expected = table_friction(guide, SET_A, 4, speeds, load, seal_drag=3.0)
    film = effect.viscous(Motion(0.0, ca.DM(speeds)), effect.values)
    # As its docstring says: the film is two powers of almost the same exponent.
    assert np.array(film).ravel() == pytest.approx(expected.viscous, rel=3e-4)
    assert _forces(effect, list(speeds)) == pytest.approx(expected.total, rel=3e-4)


def test_set_b_slips_more_under_load() -> None:
    a, b = (guide_effect(HSR_20R, one, 4, 12e3) for one in (SET_A, SET_B))
    assert b.values["coulomb"] > a.values["coulomb"]


def test_read_back_from_a_plant_file(tmp_path: Path) -> None:
    text = BENCH.read_text(encoding="utf-8")
    start = text.index('[[effect]]\nname = "guide_friction"')
    bare = text[:start] + text[text.index("[[effect]]", start + 1) :]
    for effect in (
        guide_effect(HSR_20R, SET_A, 4, 500.0),
        GuideFriction.of(coulomb=1.0, smoothing_velocity=1e-3, velocity=SPEEDS, force=MEASURED),
    ):
        path = tmp_path / "plant.toml"
        path.write_text(plant_text_with_effects(bare, [effect]), encoding="utf-8")
        assert read_plant(path).effects[-1].values == effect.values


@pytest.mark.parametrize(
    ("values", "told"),
    [
        pytest.param({"velocity": (0.0, 0.1), "force": (1.0,)}, "equal length", id="lengths"),
        pytest.param({"velocity": (0.0, 0.1)}, "equal length", id="one list alone"),
        pytest.param({"velocity": (0.1, 0.1), "force": (1.0, 2.0)}, "ascend", id="twice"),
        pytest.param({"velocity": (0.2, 0.1), "force": (1.0, 2.0)}, "ascend", id="descending"),
        pytest.param({"velocity": (-0.1, 0.1), "force": (1.0, 2.0)}, "outside its range", id="negative speed"),
        pytest.param({"velocity": (0.0, 0.1), "force": (1.0, -2.0)}, "outside its range", id="driving"),
        pytest.param({"velocity": (0.0, math.nan), "force": (1.0, 2.0)}, "outside its range", id="nan"),
    ],
)
def test_bad_curve_is_refused(values: dict[str, tuple[float, ...]], told: str) -> None:
    with pytest.raises(InputError, match=told):
        GuideFriction.of(coulomb=1.0, smoothing_velocity=1e-3, **values)
