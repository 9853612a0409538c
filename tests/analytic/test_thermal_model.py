"""The finite-volume model against closed forms, the paper's printed equations, and energy."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
import scipy.sparse as sparse
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import brentq
from scipy.special import j0, j1

from feeddrive.errors import InputError
from feeddrive.thermal.full.full_model import Discretisation, discretise, full_model, model_of
from feeddrive.thermal.full.grid import Cells, cell_edges, cylinder, overlap, places_of
from feeddrive.thermal.reduced.parametric_model import Path
from feeddrive.thermal.reduced.system import HeatSystem
from feeddrive.thermal.rig import Body, Nut, Seat, Steel, Travel
from tests.analytic.node_classes import node_classes, printed_rates, stability_by_class
from tests.analytic.thermal_cases import BENCH, bench_parts, conductances, nut_heat
from tests.claims.book import CLAIMS
from tests.heat_oracle.explicit import paper_cells, run_explicitly, stability_limit

STEEL = Steel()


def _bar(radial: int, axial: int, film: float, length: float = 0.1, radius: float = 0.008) -> HeatSystem:
    """A solid cylinder with a film on its surface and heat at one end; output: its first cross-section."""
    body = cylinder(0.0, radius, radial, length, axial, STEEL)
    area = np.zeros(body.nodes)
    area[body.surface(-1)] = 2 * math.pi * radius * body.spacing
    heat = np.zeros(body.nodes)
    heat[:: body.axial] = body.areas / body.areas.sum()
    return HeatSystem(
        body.capacities(), body.conduction() + sparse.diags_array(film * area).tocsr(), heat[:, None], heat[None, :],
        ("heat",), ("end",),
    )  # fmt: skip


def test_slowest_pole_of_a_cylinder_with_a_film_is_the_bessel_root() -> None:
    film = 50 * STEEL.conductivity / 0.008 / 100  # Biot number 0.5: a clear profile over the radius
    biot = film * 0.008 / STEEL.conductivity
    root = brentq(lambda ζ: ζ * j1(ζ) - biot * j0(ζ), 0.1, 2.0)
    exact = -STEEL.diffusivity * (root / 0.008) ** 2
    # Second order: (1/16)² of order 0.1.
    assert _bar(16, 2, film).poles(1)[0] == pytest.approx(exact, rel=1e-3)


def test_heat_at_one_end_gives_the_profile_of_a_fin() -> None:
    film, length, radius = 20.0, 0.3, 0.008
    m = math.sqrt(2 * film / (STEEL.conductivity * radius))
    conductance = STEEL.conductivity * math.pi * radius**2 * m * math.tanh(m * length)
    rise = float(_bar(4, 300, film, length).gain()[0, 0])
    # The first cell's middle is half a millimetre from the end (0.4 % of the gradient); Biot number 0.003.
    half_cell = 0.5e-3 / (STEEL.conductivity * math.pi * radius**2)
    assert rise + half_cell == pytest.approx(1 / conductance, rel=4e-3)


def test_conduction_conserves_heat_and_is_symmetric() -> None:
    model = model_of(bench_parts(), BENCH.rig.travel)
    for matrix in (model.conduction, model.ways[Path.CONTACT].matrix):
        # Sums of some ten terms of size max|K|.
        assert np.abs(matrix.sum(axis=0)).max() < 1e-13 * abs(matrix).max()
        assert abs(matrix - matrix.T).max() < 1e-13 * abs(matrix).max()


def test_heat_capacities_are_those_of_the_bodies() -> None:
    rig = BENCH.rig
    volume = math.pi * (rig.radius**2 * rig.length + (rig.nut.outer_radius**2 - rig.radius**2) * rig.nut.length)
    total = model_of(bench_parts(), rig.travel).capacity.sum()
    assert total == pytest.approx(rig.steel.heat_capacity * volume, rel=1e-12)


def test_all_heat_leaves_through_the_films_in_the_steady_state() -> None:
    model = model_of(bench_parts(), BENCH.rig.travel)
    g = conductances(500)
    system = model.at(g)
    inputs = np.zeros(len(system.input_names))
    inputs[:3] = (3.0, 0.5, 0.25)
    states = system.steady(inputs)
    lost = sum(g[path] * float(way.facing @ states) for path, way in model.ways.items() if path in g and way.source)
    assert lost == pytest.approx(3.75, rel=1e-9)


def test_warmer_air_in_the_end_warms_everything_alike() -> None:
    system = full_model(BENCH.rig).at(conductances(500))
    inputs = np.zeros(len(system.input_names))
    inputs[system.column("ambient")] = 2.0
    np.testing.assert_allclose(system.steady(inputs), 2.0, rtol=1e-9)


def test_uniform_rise_grows_every_position_by_its_length() -> None:
    model = full_model(BENCH.rig)
    states = np.full(model.order, 5.0)
    for position in BENCH.rig.growth_positions:
        grown = float(model.readings[f"growth_{position * 1e3:g}mm"] @ states)
        assert grown == pytest.approx(11.7e-6 * 5.0 * position, rel=1e-12)


@given(low=st.floats(0.05, 0.45), stroke=st.floats(0.0, 0.4))
def test_overlap_covers_the_nut_wherever_it_goes(low: float, stroke: float) -> None:
    travel = Travel(low, min(low + stroke, 0.45))
    lengths = overlap(cell_edges(0.1, 7) - 0.05, cell_edges(0.5, 33), travel)
    # Lengths below 1e-12 of the shaft are dropped.
    np.testing.assert_allclose(lengths.sum(axis=1), 0.1 / 7, rtol=1e-9)
    assert lengths.min() >= 0
    assert lengths.sum(axis=0).max() <= 0.5 / 33 * (1 + 1e-9)


def test_mean_overlap_is_the_mean_over_the_places() -> None:
    nut, shaft = cell_edges(0.1, 20) - 0.05, cell_edges(0.5, 100)
    places, shares = places_of(Travel(0.2, 0.3), 0.005)
    stepped = sum(share * overlap(nut, shaft, Travel(p, p)) for p, share in zip(places, shares, strict=True))
    # Hat functions of one cell: the trapezoidal rule on them is exact.
    np.testing.assert_allclose(overlap(nut, shaft, Travel(0.2, 0.3)), stepped, atol=1e-12)


def _paper_parts() -> Discretisation:
    nut = Nut(0.020, 0.100, end_share=1.0)
    rig = replace(BENCH.rig, nut=nut, rear=Seat(0.010, film=9.7, end_share=1.0))
    return discretise(rig, paper_cells(rig))


def test_every_node_keeps_the_share_that_the_papers_class_prints() -> None:
    parts = _paper_parts()
    g = {**conductances(500), Path.REAR_FILM: 9.7}
    system = model_of(parts, Travel(0.25, 0.25)).at(g)
    kinds, printed = node_classes(parts, 0.25), printed_rates(parts, 0.25, g)
    assert set(kinds) == set(range(18))
    described = kinds > 0
    rates = system.conductance.diagonal() / system.capacity
    np.testing.assert_allclose(rates[described], printed[described], rtol=1e-12)


def test_class_one_limits_the_step_of_the_paper() -> None:
    steel = Steel(conductivity=50.0, heat_capacity=3.6e6)
    parts = discretise(replace(BENCH.rig, steel=steel), paper_cells(BENCH.rig))
    limits = stability_by_class(parts, 0.25, conductances(500))
    assert min(limits, key=lambda kind: limits[kind]) == 1
    # 1/(α (2/Δz² + 4/Δr²)) with α = 1.389e-5: 4.41 ms.
    assert limits[1] == pytest.approx(4.41e-3, abs=0.005e-3)
    assert stability_limit(model_of(parts, Travel(0.25, 0.25)).at(conductances(500))) == pytest.approx(limits[1])


def test_energy_of_the_explicit_scheme_is_balanced() -> None:
    rig = replace(BENCH.rig, nut_heat_share=0.5)
    heats = {"nut": 3.0, "front": 0.5, "ambient": 1.0}
    run = run_explicitly(discretise(rig, Cells()), conductances(500), heats, 0.05, 600.0)
    # Rounding of some thousand steps.
    CLAIMS["heat.balance"].check(run.imbalance)
    assert run.heat_stored > 0.1 * run.heat_in


def test_standing_nut_is_the_same_explicitly_and_implicitly() -> None:
    travel = Travel(0.25, 0.25)
    parts = bench_parts(Cells(50, 2, 10, 3))
    run = run_explicitly(parts, conductances(500), {"nut": 3.0}, 1.0, 3600.0, travel=travel, reports=1)
    system = model_of(parts, travel).at(conductances(500))
    implicit = system.step_response("nut", 3.0, 360, 10.0)
    # First order of the explicit scheme: a step of 0.1 s over time constants of minutes.
    np.testing.assert_allclose(run.outputs[-1], implicit[-1], rtol=2e-4)


def test_body_at_a_port_takes_and_gives_heat_without_loss() -> None:
    model = full_model(BENCH.rig).with_body(Body("motor", "front", 800.0, 0.4, 0.1))
    system = model.at(conductances(500))
    gain = system.gain()
    motor, front = system.row("motor"), system.row("front")
    # Reciprocity: the motor's heat warms the front as the front's heat warms the motor.
    assert gain[motor, system.column("front")] == pytest.approx(gain[front, system.column("motor")], rel=1e-9)
    inputs = np.zeros(len(system.input_names))
    inputs[system.column("ambient")] = 3.0
    np.testing.assert_allclose(system.steady(inputs), 3.0, rtol=1e-9)


def test_very_long_step_lands_in_the_steady_state() -> None:
    system = full_model(BENCH.rig).at(conductances(500))
    given = np.eye(len(system.input_names))[0] * nut_heat(500)
    landed = system.stepper(1e9)(np.full(system.order, 7.0), given)
    # An L-stable step forgets its start: 1e9 s are 5e5 time constants, of which the stability function leaves 1e-6.
    np.testing.assert_allclose(landed, system.steady(given), rtol=1e-5)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: replace(BENCH.rig, travel=Travel(0.05, 0.5)), "longer than the 400 mm"),
        (lambda: replace(BENCH.rig, travel=Travel(0.40, 0.48)), "leaves the shaft"),
        (lambda: Travel(0.3, 0.2), "lower end first"),
        (lambda: replace(BENCH.rig, nut=Nut(0.007, 0.1)), "not wider than the shaft"),
        (lambda: replace(BENCH.rig, front=Seat(0.2, film=9.0)), "runs over a bearing"),
        (lambda: full_model(BENCH.rig).at({Path.SCREW_FILM: -1.0}), "screw_film"),
        (lambda: full_model(BENCH.rig).at({}).gain(), "nothing leads heat away"),
        (lambda: full_model(BENCH.rig).at(conductances(500)).column("spindle"), 'no input "spindle"'),
        (lambda: Body("motor", "middle", 1.0, 1.0), 'no port "middle"'),
        (lambda: Body("motor", "front", 1.0, -1.0), "motor.conductance"),
        (lambda: full_model(BENCH.rig).with_body(Body("nut", "front", 1.0, 1.0)), '"nut" is in use'),
        (lambda: run_explicitly(bench_parts(), conductances(500), {}, 0.04, 60.0, step=0.2), "is not stable"),
        (lambda: run_explicitly(bench_parts(), conductances(500), {}, 0.04, 1.0), "less than a period"),
        (lambda: run_explicitly(bench_parts(), conductances(500), {"spindle": 1.0}, 0.04, 60.0), 'no input "spindle"'),
        (lambda: full_model(BENCH.rig).at(conductances(500)).simulate(np.zeros((2, 3)), 1.0), "give one column each"),
        (lambda: Steel(conductivity=math.nan), "conductivity"),
    ],
)  # fmt: skip
def test_bad_input_is_refused_with_its_mend(make: object, message: str) -> None:
    with pytest.raises(InputError, match=message):
        make()  # type: ignore[operator]
