"""Reduced models against the full one: accuracy, stability, passivity, validity; the moving nut against the oracle."""

from __future__ import annotations

import numpy as np
import pytest

from feeddrive.errors import InputError, ValidityWarning
from feeddrive.thermal.full.full_model import full_model
from feeddrive.thermal.full.grid import Cells
from feeddrive.thermal.reduced.network import network
from feeddrive.thermal.reduced.parametric_model import HeatModel, Path
from feeddrive.thermal.reduced.reduction import Sizes, compressed, reduce_model
from feeddrive.thermal.rig import Body, Travel
from tests.analytic.thermal_cases import BENCH, QUICK, conductances
from tests.heat_oracle.reduction_error import reduced_system, reduction_error

WORKING = Sizes(heats=(("nut", 1.3), ("front", 1.0), ("rear", 0.17)))
"""Nut of a small axis, heat of the motor at the front end, of a bearing at the rear one [W]; 2 K of the air."""
NUT_ALONE = Sizes(heats=(("nut", 1.3),), other_heat=1e-9, surroundings=1e-9)
FULL = full_model(BENCH.rig, QUICK)


@pytest.fixture(scope="module")
def reduced() -> HeatModel:
    """The bench reduced for its whole range."""
    return reduce_model([FULL], BENCH.limits())[0]


def test_nut_heat_alone_needs_four_states() -> None:
    full = FULL.at(conductances(500))
    error = reduction_error(full, reduced_system(full, 4, NUT_ALONE), NUT_ALONE)
    assert error.largest(growth=False, inputs=("nut",)) < 0.01
    assert error.largest(growth=True, inputs=("nut",)) < 0.02e-6


@pytest.mark.parametrize("speed", [0, 250, 750, 1400])
def test_all_inputs_need_ten_states(speed: float) -> None:
    full = FULL.at(conductances(speed))
    error = reduction_error(full, reduced_system(full, 10, WORKING), WORKING)
    assert error.largest(growth=False) < 0.01
    assert f"order {10}" in error.text()


def test_balanced_model_is_stable_at_every_order() -> None:
    full = compressed(FULL.at(conductances(500)), WORKING)
    for order in range(1, 15):
        assert reduced_system(full, order, WORKING).poles(order).max() < 0


@pytest.mark.parametrize("speed", [20, 50, 100, 250, 500, 750, 1000, 1500])
def test_parametric_model_is_the_full_one_at_every_speed(reduced: HeatModel, speed: float) -> None:
    g = conductances(speed)
    error = reduction_error(FULL.at(g), reduced.at(g), WORKING)
    # What is asked for. Measured 0.6 mK and 0.5 nm; without a rate of 1/s in the basis the seat's skin cost 3.7 mK.
    assert error.largest(growth=False) < 3e-3
    assert error.largest(growth=True) < 10e-9


@pytest.mark.parametrize("speed", [30, 400, 1400])
def test_parametric_model_holds_over_its_range(reduced: HeatModel, speed: float) -> None:
    g = {**conductances(speed), Path.CONTACT: 700.0, Path.COOLING: 0.8}
    error = reduction_error(FULL.at(g), reduced.at(g), WORKING)
    assert reduced.order == 36
    # Measured 3 mK and 7 nm; asked for is a tenth of the sensors' noise.
    assert error.largest(growth=False) < 6e-3
    assert error.largest(growth=True) < 15e-9


def test_one_basis_serves_several_travels() -> None:
    travels = (Travel(0.2, 0.3), Travel(0.1, 0.4))
    models = [full_model(BENCH.rig, Cells(50, 2, 10, 3), travel) for travel in travels]
    small = reduce_model(models, BENCH.limits(), 50)
    for full, model in zip(models, small, strict=True):
        error = reduction_error(full.at(conductances(500)), model.at(conductances(500)), WORKING)
        assert error.largest(growth=False) < 0.02


def test_parametric_model_is_passive_everywhere(reduced: HeatModel, generator: np.random.Generator) -> None:
    heats = np.vstack([reduced.ports["front"], reduced.ports["rear"]])
    for _ in range(10):
        g = {path: generator.uniform(*ends) for path, ends in reduced.limits.items()}
        system = reduced.at(g)
        assert np.linalg.eigvalsh(system.conductance)[0] > 0
        for frequency in (1e-5, 1e-3, 0.1):
            answer = heats @ system.shifted_solve(2j * np.pi * frequency, heats.T)
            # Heat in and temperature at the same places: the real part is a resistance.
            assert np.linalg.eigvalsh(answer + answer.conj().T)[0] > 0


def test_outside_its_range_it_says_so(reduced: HeatModel) -> None:
    with pytest.warns(ValidityWarning, match="screw_film of 185.* lies outside"):
        reduced.at({Path.SCREW_FILM: 185.0, Path.NUT_FILM: 10.0, Path.CONTACT: 1250.0})


def test_full_and_reduced_answer_the_same_methods() -> None:
    full = FULL.at(conductances(500))
    small = compressed(full)
    # Matched to 1e-5 K per watt at the rates of interest.
    np.testing.assert_allclose(small.poles(3), full.poles(3), rtol=1e-5)
    np.testing.assert_allclose(small.frequency_response(np.array([1e-4])), full.frequency_response(np.array([1e-4])),
                               atol=1e-6)  # fmt: skip
    shown, truth = (system.step_response("front", 1.0, 100, 10.0) for system in (small, full))
    # The full model is stepped implicitly, 10 s beside a local time constant of a second.
    np.testing.assert_allclose(shown[5:], truth[5:], atol=0.01)


def test_a_step_of_a_reduced_system_is_its_simulation() -> None:
    system = compressed(FULL.at(conductances(500)))
    given = np.zeros((50, len(system.input_names)))
    given[:, system.column("front")] = 2.0
    # both exact: what differs is rounding of the largest temperature, 1e-16 of it, through some thousand operations
    stepped = system.outputs(system.simulate(given, 10.0))
    bound = 1e-12 * np.abs(stepped).max()
    np.testing.assert_allclose(system.step_response("front", 2.0, 50, 10.0), stepped, rtol=1e-8, atol=bound)


def test_network_reads_well_and_is_near_the_full_model() -> None:
    g = conductances(500)
    net = network(BENCH.rig, g, 12)
    assert "nut      - shaft_" in net.text() and "W/K to air" in net.text()
    full, lumped = FULL.at(g), net.system()
    assert lumped.order == 13
    truth, shown = (s.step_response("nut", 3.4, 180, 60.0) for s in (full, lumped))
    nut, end = full.row("nut"), full.row("growth_end")
    # Twelve segments: some per cent.
    assert np.abs(shown[:, nut] - truth[:, nut]).max() < 0.04 * truth[-1, nut]
    assert np.abs(shown[:, end] - truth[:, end]).max() < 0.04 * truth[-1, end]
    assert lumped.gain()[0, 3] == pytest.approx(1.0)


def test_body_on_the_reduced_model_is_one_on_the_full_one(reduced: HeatModel) -> None:
    body = Body("heat_sink", "nut", 500.0, 2.0, 0.3)
    full, small = (model.with_body(body).at(conductances(500)) for model in (FULL, reduced))
    error = reduction_error(full, small, WORKING)
    assert error.largest(growth=False) < 10e-3
    assert "heat_sink" in error.input_names and "heat_sink" in error.output_names


def test_network_takes_bodies_too() -> None:
    g, motor = conductances(500), Body("motor", "front", 900.0, 0.5, 0.2)
    net = network(BENCH.rig, g, 10, (motor,))
    assert "motor    - shaft_1" in net.text()
    lumped, full = net.system(), FULL.with_body(motor).at(g)
    assert lumped.input_names == full.input_names
    assert set(lumped.output_names) == set(full.output_names)
    rises = [system.gain()[system.row("motor"), system.column("motor")] for system in (lumped, full)]
    # A segment's mean in place of the seat's surface.
    assert rises[0] == pytest.approx(rises[1], rel=0.05)


def test_order_that_is_not_possible_is_refused() -> None:
    with pytest.raises(InputError, match="order 0"):
        reduced_system(FULL.at(conductances(500)), 0)
