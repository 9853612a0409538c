"""Expansion of the screw, preload of the nut, friction, films, contact, and the thermal section of plant files."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path as FilePath

import numpy as np
import pytest

from feeddrive.errors import InputError, ValidityWarning
from feeddrive.files import find_plant
from feeddrive.plant.file.plant_file import read_plant
from feeddrive.thermal.full.full_model import full_model
from feeddrive.thermal.full.grid import cell_edges
from feeddrive.thermal.laws.expansion import growths
from feeddrive.thermal.laws.films import Films, rotating_cylinder_film
from feeddrive.thermal.laws.friction import Friction
from feeddrive.thermal.reduced.network import network
from feeddrive.thermal.rig import BothEnds
from feeddrive.thermal.thermal_coupling import Spacer, preload_change
from tests.analytic.thermal_cases import BENCH, BENCH_FILE, RPM, conductances

RIG = BENCH.rig
EDGES = cell_edges(RIG.length, 50)
ALPHA = RIG.steel.expansion


def test_free_end_grows_by_the_integral_of_the_rise() -> None:
    middle = (EDGES[1:] + EDGES[:-1]) / 2
    found = growths(RIG, 10 * middle / RIG.length, EDGES, np.array([0.3]))
    # A linear rise: the integral is a parabola, exact at the edges of the cells.
    assert found[0, 0] == pytest.approx(ALPHA * 10 * 0.3**2 / (2 * RIG.length), rel=1e-12)


def test_growth_is_that_of_the_model() -> None:
    model = full_model(RIG)
    states = model.at(conductances(500)).simulate(np.tile(np.eye(5)[0], (3, 1)), 600.0)
    found = growths(RIG, states @ model.profile.T, model.edges, np.array([0.25]))
    np.testing.assert_allclose(found[:, 0], states @ model.readings["growth_250mm"], rtol=1e-10)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: growths(RIG, np.zeros(50), EDGES, np.array([0.6])), "is not on the shaft"),
        (lambda: growths(RIG, np.zeros(7), EDGES, np.zeros(1)), "profile and edges do not fit"),
        (lambda: preload_change(1.0, -5.0, 260e6, 0.04, 0.01675, 0.8, Spacer.OVERSIZE), "preload"),
        (lambda: Friction(-1.0, 10, 170e-6, 0.01675), "load_torque"),
        (lambda: Films(-1.0, 0.0, 0.0, 0.0), "film.screw"),
        (lambda: rotating_cylinder_film(10.0, 0.0), "diameter"),
    ],
)  # fmt: skip
def test_bad_input_is_refused(make: object, message: str) -> None:
    with pytest.raises(InputError, match=message):
        make()  # type: ignore[operator]


def test_preload_of_the_double_nut_per_kelvin() -> None:
    # Recomputed independently for a 16 mm screw, 670 N: axial ±61, radial -25 N/K.
    over, under = (preload_change(1.0, 670.0, 260e6, 0.040, 0.01675, math.radians(45), kind) for kind in Spacer)
    assert (over - under) / 2 == pytest.approx(61, abs=0.5)
    assert (over + under) / 2 == pytest.approx(-25, abs=0.6)
    with pytest.warns(ValidityWarning, match="the nut is loose"):
        preload_change(10.0, 670.0, 260e6, 0.040, 0.01675, math.radians(45), Spacer.UNDERSIZE)


def test_heat_is_torque_times_speed_and_none_at_rest() -> None:
    heats = BENCH.nut.heats(np.array([-500.0, 0.0, 500.0]) * RPM)
    torque = BENCH.nut.load_torque + 1e-10 * 10 * (170 * 500) ** (2 / 3) * 16.75**3
    np.testing.assert_allclose(heats, 0.609 * 500 * RPM * torque * np.array([1.0, 0.0, 1.0]), rtol=1e-9)


def test_bench_file_is_the_declared_rig() -> None:
    assert pytest.approx(0.5e-2 / (2 * math.pi)) == BENCH.lead
    speed = np.array([500 * RPM])
    assert BENCH.films.on_screw(speed)[0] == pytest.approx(0.29033 * 500 ** (2 / 3), rel=1e-6)
    # 4.1364e-4·1300^1.33·d_m/cos γ
    assert BENCH.nut.load_torque == pytest.approx(4.1364e-4 * 1300**1.33 * 0.01675 / math.cos(math.radians(5.43)),
                                                  rel=1e-6)  # fmt: skip


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('nut_length = "100 mm"', 'nut_length = "600 mm"', "stroke of 100 mm is longer than the 0 mm"),
        ('travel = ["200 mm", "300 mm"]', 'travel = ["20 mm", "300 mm"]', "leaves the shaft"),
        ('travel = ["200 mm", "300 mm"]', 'travel = "200 mm"', "not a pair"),
        ('shaft_radius = "8 mm"', 'shaft_radius = "8"', "bare number"),
        ('screw_least = "5 W/(m^2 K)"', 'screw_least = "-5 W/(m^2 K)"', "film.screw_least"),
        ('preload = "1300 N"', 'prelaod = "1300 N"', 'did you mean "preload"'),
        ('name = "thermal bench"', 'nmae = "thermal bench"', 'did you mean "name"'),
        ("feeddrive-plant/1", "feeddrive-plant/9", "not a plant file of this version"),
        ("[thermal.nut]", "[thermal.front_bearing]", "load_torque"),
        ("[thermal", "[other", "unknown key|no .thermal. section"),
        ('heat_share = "0.609"', 'heat_share = "1.4"', "no share"),
    ],
)  # fmt: skip
def test_bad_files_are_refused_with_place_and_mend(tmp_path: FilePath, old: str, new: str, message: str) -> None:
    text = BENCH_FILE.read_text(encoding="utf-8")
    assert old in text
    path = tmp_path / "bad.toml"
    count = -1 if old == "[thermal" else 1
    path.write_text(text.replace(old, new, count), encoding="utf-8")
    with pytest.raises(InputError, match=message) as refusal:
        read_plant(path)
    assert str(path) in str(refusal.value)


def test_bearings_may_have_heat_and_film(tmp_path: FilePath) -> None:
    path = tmp_path / "bearing.toml"
    path.write_text(
        BENCH_FILE.read_text(encoding="utf-8")
        + '\n[thermal.front_bearing]\nload_torque = "0.5 mN m"\nviscous_factor = "3.3"\nviscosity = "32 mm^2/s"\n'
        'mean_diameter = "22 mm"\nfilm = "9.7 W/(m^2 K)"\nseat_length = "12 mm"\n'
        '[thermal.rear_bearing]\nfilm = "9.7 W/(m^2 K)"\n'
        '[[thermal.body]]\nname = "motor"\nport = "front"\ncapacity = "900 J/K"\nconductance = "0.5 W/K"\n',
        encoding="utf-8",
    )
    plant = read_plant(path).heat
    assert plant.bodies[0].capacity == pytest.approx(900.0)
    assert "motor" in plant.full_model().readings
    assert plant.front is not None and plant.rear is None
    assert plant.rig.front.length == pytest.approx(0.012)
    assert plant.rig.rear.film == pytest.approx(9.7)
    assert plant.heats(np.array([500 * RPM]))["front"][0] > 0


HELD = replace(RIG, both_ends=BothEnds(near=900e6, far=600e6, axial_rigidity=200.5e6))


def test_shaft_between_two_bearings_pushes_both_outwards_by_one_thrust() -> None:
    # Springs in series, written from the balance of the thrust: bearing, shaft, bearing shorten by the whole expansion.
    whole = ALPHA * 10 * RIG.length
    thrust = whole / (1 / 900e6 + RIG.length / 200.5e6 + 1 / 600e6)
    rises = np.full(50, 10.0)
    front, middle, rear = growths(HELD, rises, EDGES, np.array([0.0, RIG.length / 2, RIG.length]))[0]
    assert front == pytest.approx(-thrust / 900e6, rel=1e-12)
    assert rear == pytest.approx(thrust / 600e6, rel=1e-12)
    assert middle == pytest.approx(whole / 2 - thrust * (1 / 900e6 + RIG.length / 2 / 200.5e6), rel=1e-12)


def test_rigid_bearings_keep_the_ends_and_a_soft_far_one_lets_the_shaft_grow() -> None:
    rises, places = np.linspace(4.0, 12.0, 50), np.array([0.0, 0.2, RIG.length])
    rigid = replace(RIG, both_ends=BothEnds(1e18, 1e18, 200.5e6))
    assert growths(rigid, rises, EDGES, places)[0, [0, 2]] == pytest.approx([0.0, 0.0], abs=1e-12)
    soft = replace(RIG, both_ends=BothEnds(1e18, 1e-3, 200.5e6))
    np.testing.assert_allclose(growths(soft, rises, EDGES, places), growths(RIG, rises, EDGES, places), atol=1e-12)


def test_network_and_full_model_of_a_held_shaft_read_the_same_growth() -> None:
    # Both models hold an evenly warm machine exactly, so that only the law of the growth is compared.
    full, lumped = full_model(HELD), network(HELD, conductances(500)).system()
    whole = HELD.steel.expansion * HELD.length
    for name in ("growth_250mm", "growth_end"):
        found = float(np.sum(full.readings[name]))
        assert found == pytest.approx(float(lumped.rows[lumped.output_names.index(name)].sum()), rel=1e-9)
        assert found < 0.5 * whole


def _plant_with_heat(tmp_path: FilePath, kind: str) -> FilePath:
    """The warm axis with another kind of support and, where that takes thrust, a far bearing."""
    text = find_plant("warm_axis").read_text()
    text = text.replace('kind = "fixed-supported"', f'kind = "{kind}"')
    far = '[bearing.far]\naxial_stiffness = "600 N/µm"\n\n' if kind.endswith(("fixed", "d-supported")) else ""
    path = tmp_path / "axis.toml"
    path.write_text(text.replace("[nut]\n", f"{far if kind != 'fixed-supported' else ''}[nut]\n", 1))
    return path


def test_file_with_fixed_supports_at_both_ends_grows_between_them(tmp_path: FilePath) -> None:
    held = read_plant(_plant_with_heat(tmp_path, "fixed-fixed")).heat.rig.both_ends
    # E A of the root: 206 GPa on 28.4 mm.
    assert held is not None and (held.near, held.far) == (600e6, 600e6)
    assert held.axial_rigidity == pytest.approx(206e9 * math.pi * 0.0284**2 / 4)
    assert read_plant(_plant_with_heat(tmp_path, "fixed-supported")).heat.rig.both_ends is None


def test_supports_that_do_not_say_whether_the_screw_may_grow_are_refused(tmp_path: FilePath) -> None:
    with pytest.raises(InputError, match=r'support\.kind: .*\[thermal\] has to know; write "fixed-fixed"'):
        read_plant(_plant_with_heat(tmp_path, "supported-supported"))


def test_modulus_that_enters_nothing_is_no_key(tmp_path: FilePath) -> None:
    path = tmp_path / "bench.toml"
    path.write_text(BENCH_FILE.read_text().replace("[thermal]\n", '[thermal]\nelasticity = "206 GPa"\n', 1))
    with pytest.raises(InputError, match='unknown key "elasticity"'):
        read_plant(path)
