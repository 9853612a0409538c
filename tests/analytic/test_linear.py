"""Linearisation and modes against closed forms, differences and an independent eigenvalue problem."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from feeddrive.effects.base import Effect
from feeddrive.effects.catalogue import EFFECTS
from feeddrive.errors import InputError
from feeddrive.files import plants_folder
from feeddrive.plant.analysis.linear import state_space
from feeddrive.plant.analysis.modes import braked_modes, free_modes
from feeddrive.plant.analysis.ode import INPUTS, OUTPUTS, ode, ode_parameters, state_names
from feeddrive.plant.analysis.steady import steady_motion
from feeddrive.plant.analysis.summary import summarise
from feeddrive.plant.chain.chain import Rigid, ThreeInertias
from feeddrive.plant.file.plant_file import read_plant
from feeddrive.plant.plant import Plant

BENCH = read_plant(plants_folder() / "bench_axis.toml")
EMPS = read_plant(plants_folder() / "emps.toml")
CHAIN = Plant("chain alone", BENCH.chain)
R = BENCH.chain.radius

ADDED: dict[str, Effect | None] = {
    "declared": None,
    "presliding": EFFECTS["presliding"].of(stiffness=5.5e6, damping=4000.0, break_away=0.8),
    "dahl": EFFECTS["presliding"].of(stiffness=5.5e6),
    "backlash": EFFECTS["backlash"].of(width=7.5e-6),
    "stribeck": EFFECTS["stribeck"].of(delta_force=-22.0, velocity=0.05),
    "lead_error": EFFECTS["lead_error_periodic"].of(amplitude=2e-6, order=1.0, phase=0.3),
    "ripple": EFFECTS["torque_ripple"].of(amplitude=0.1, order=6.0, phase=0.7),
    "payload": EFFECTS["payload"].of(mass=22.0),
}


def _with(name: str) -> Plant:
    effect = ADDED[name]
    return BENCH if effect is None else BENCH.with_effects(effect)


def _replaced(plant: Plant, **values: float) -> Plant:
    return dataclasses.replace(plant, mechanics=type(plant.chain)({**plant.chain.values, **values}))


def test_names() -> None:
    system = state_space(BENCH)
    assert tuple(system.input_labels) == INPUTS
    assert tuple(system.output_labels) == OUTPUTS
    assert tuple(system.state_labels) == state_names(BENCH)
    assert list(ode_parameters(BENCH))[:2] == ["lead", "motor_inertia"]


def test_two_masses_closed_form() -> None:
    """A very stiff axial spring leaves motor and screw with table on one torsional spring."""
    plant = _replaced(CHAIN, axial_stiffness=1e13)
    v = plant.chain.values
    load = v["screw_inertia"] + v["table_mass"] * R**2
    braked = math.sqrt(v["torsional_stiffness"] / load) / (2 * math.pi)
    free = braked * math.sqrt(1 + load / v["motor_inertia"])
    # The neglected axial compliance is 1e-4 of the torsional one; a frequency moves by half of that.
    assert braked_modes(plant).frequencies[0] == pytest.approx(braked, rel=1e-4)
    assert free_modes(plant).frequencies[1] == pytest.approx(free, rel=1e-4)


def test_frequencies_against_a_general_eigenvalue_problem() -> None:
    v = BENCH.chain.values
    kt, ka = v["torsional_stiffness"], v["axial_stiffness"]
    K = np.array([[kt, -kt, 0], [-kt, kt + R**2 * ka, -R * ka], [0, -R * ka, ka]])
    A = np.diag([1 / v["motor_inertia"], 1 / v["screw_inertia"], 1 / v["table_mass"]]) @ K
    free = np.sqrt(np.sort(np.linalg.eigvals(A).real)[1:]) / (2 * math.pi)
    braked = np.sqrt(np.sort(np.linalg.eigvals(A[1:, 1:]).real)) / (2 * math.pi)
    # Eigenvalues of a matrix whose entries span nine decades: rounding of 1e-16 times the condition of scaling.
    assert free_modes(BENCH).frequencies[1:] == pytest.approx(free, rel=1e-9)
    assert braked_modes(BENCH).frequencies == pytest.approx(braked, rel=1e-9)
    assert free_modes(BENCH).frequencies[0] == 0.0


def test_braked_axis_without_rotary_inertia_is_that_of_the_source() -> None:
    """Paper 004: 202.7 N/µm and 134 kg give 195.7 Hz; printed to four digits."""
    plant = _replaced(CHAIN, screw_inertia=1e-9)
    assert braked_modes(plant).frequencies[0] == pytest.approx(195.7, abs=0.1)


def test_poles_of_modes_are_those_of_the_state_space() -> None:
    poles = state_space(CHAIN).poles()
    oscillating = sorted((pole for pole in poles if pole.imag > 1), key=abs)
    # Two eigenvalue solvers on matrices of other scaling.
    assert np.array(free_modes(CHAIN).poles[-2:]) == pytest.approx(np.array(oscillating), rel=1e-8)


@pytest.mark.parametrize("name", ADDED)
@pytest.mark.parametrize("velocity", [0.05, -0.2])
def test_jacobians_against_central_differences(name: str, velocity: float) -> None:
    plant = _with(name)
    system, point = state_space(plant, velocity, 0.11), steady_motion(plant, velocity, 0.11)
    function, p = ode(plant), list(ode_parameters(plant).values())

    def value(x: np.ndarray, u: np.ndarray) -> np.ndarray:
        xdot, y = function(x, u, p)
        return np.concatenate([np.array(xdot.full())[:, 0], np.array(y.full())[:, 0]])

    u = np.array([point.torque, 0.0])
    n = len(point.state)
    exact = np.block([[system.A, system.B], [system.C, system.D]])
    for column in range(n + 2):
        # Of a bristle small beside its deflection (1e-5 m), since its slip has a kink in the curvature where it slides.
        step = 1e-4 if column >= n else 1e-11 if column >= 2 * len(plant.chain.coordinates) else 1e-8
        dx, du = np.zeros(n), np.zeros(2)
        (dx if column < n else du)[column if column < n else column - n] = step
        numeric = (value(point.state + dx, u + du) - value(point.state - dx, u - du)) / (2 * step)
        # Rounding of spring forces at a position of 0.1 m (1e-8 N) over the step, beside the largest entry.
        assert numeric == pytest.approx(exact[:, column], rel=1e-4, abs=1e-6 * np.max(np.abs(exact)))


@pytest.mark.parametrize("name", ADDED)
def test_steady_motion_is_steady(name: str) -> None:
    plant = _with(name)
    point = steady_motion(plant, 0.05, 0.2)
    xdot, y = ode(plant)(point.state, [point.torque, 0.0], list(ode_parameters(plant).values()))
    rates = np.array(xdot.full())[:, 0]
    n = len(plant.chain.coordinates)
    # Rounding of the spring force (1e-6 N) over the smallest inertia (2.4e-3 kg m^2).
    assert np.max(np.abs(rates[n:])) < 1e-3
    assert np.array(y.full())[2:, 0] == pytest.approx([0.2, 0.05])


def test_torque_of_steady_motion_is_the_declared_friction() -> None:
    v, w = 0.05, 0.05 / R
    expected = R * (60 + 300 * v) + 0.35 + 0.02 * w ** (2 / 3)
    # The lubricant torque is smoothed at 0.01 rad/s: (0.01 / 16)^2 / 6 of it.
    assert steady_motion(BENCH, v).torque == pytest.approx(expected, rel=1e-6)


@given(
    st.floats(-0.3, 0.3), st.floats(-50, 50), st.floats(-50, 50),
    st.floats(-1e-3, 1e-3), st.floats(-1e-3, 1e-3), st.sampled_from(["declared", "stribeck", "backlash", "payload"]),
)  # fmt: skip
def test_unforced_motion_loses_energy(
    table_rate: float, motor_rate: float, screw_rate: float, twist: float, stretch: float, name: str
) -> None:
    """Power of all forces less that stored in linear springs is never positive; without the free play."""
    plant = _with("declared" if name == "backlash" else name)
    v = plant.chain_values()
    state = np.array([twist, 0.0, -stretch, motor_rate, screw_rate, table_rate])
    xdot = np.array(ode(plant)(state, [0.0, 0.0], list(ode_parameters(plant).values()))[0].full())[:, 0]
    rate = state[3:]
    kinetic = np.array([v["motor_inertia"], v["screw_inertia"], v["table_mass"]]) * rate @ xdot[3:]
    spring = v["torsional_stiffness"] * twist * (motor_rate - screw_rate)
    spring += v["axial_stiffness"] * stretch * (R * screw_rate - table_rate)
    # Difference of two powers of the size of the spring's.
    assert kinetic + spring <= 1e-12 * (abs(kinetic) + abs(spring) + 1e-12)


def test_rigid_plant_is_the_published_first_order_model() -> None:
    system = state_space(EMPS, 0.05)
    mass, viscous, r = 95.1089, 203.5034, 0.0025 / (2 * math.pi)
    assert pytest.approx(np.array([[0, 1], [0, -viscous / mass]])) == system.A
    assert pytest.approx(np.array([[0, 0], [1 / (r * mass), 1 / mass]])) == system.B
    assert pytest.approx(np.array([[1 / r, 0], [0, 1 / r], [1, 0], [0, 1]])) == system.C


def test_stiff_axis_becomes_the_rigid_one() -> None:
    stiff = _replaced(BENCH, axial_stiffness=1e13, torsional_stiffness=1e9)
    values = {value.key: BENCH.chain.values[value.key] for value in Rigid.required}
    rigid = dataclasses.replace(BENCH, mechanics=Rigid(values))
    at = 2j * math.pi * 20  # far below the first mode of the stiff axis
    # The ratio of the frequencies squared, below 1e-6.
    assert stiff_response(stiff, at) == pytest.approx(stiff_response(rigid, at), rel=1e-5)


def stiff_response(plant: Plant, s: complex) -> np.ndarray:
    return np.asarray(state_space(plant)(s))


def test_at_rest_friction_swamps_everything() -> None:
    """Slope Fc / v0 of the tanh: 60 N over 0.5 mm/s on 134 kg, and the viscous part."""
    slope = state_space(BENCH, velocity=0.0).A[5, 5]
    moving = state_space(BENCH).A[5, 5]
    assert slope - moving == pytest.approx(-60 / 0.5e-3 / 134, rel=1e-9)


def test_inertias_and_stiffness_seen_from_both_ends() -> None:
    summary = summarise(BENCH)
    assert summary.inertia_at_motor == pytest.approx(2.6e-3 + 2.37e-3 + 134 * R**2)
    assert summary.mass_at_table == pytest.approx(summary.inertia_at_motor / R**2)
    assert summary.stiffness is not None
    assert summary.stiffness.axial_share + summary.stiffness.torsional_share == pytest.approx(1)


def test_rigid_has_no_braked_mode() -> None:
    assert braked_modes(EMPS).frequencies.size == 0
    assert free_modes(EMPS).frequencies.tolist() == [0.0]


def test_backlash_with_nothing_to_load_it() -> None:
    plant = Plant("loose", ThreeInertias(BENCH.chain.values), (EFFECTS["backlash"].of(width=1e-5),))
    point = steady_motion(plant, 0.1)
    assert point.torque == pytest.approx(0.0, abs=1e-6)  # residual that Newton leaves, times r


@pytest.mark.parametrize("velocity", [math.nan, math.inf])
def test_velocity_that_is_no_number_is_refused(velocity: float) -> None:
    with pytest.raises(InputError, match="finite"):
        state_space(BENCH, velocity)
