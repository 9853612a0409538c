"""The chain with a distributed screw against 60 finite elements, and against the numbers of the source."""

from __future__ import annotations

import math

import casadi as ca
import numpy as np
import pytest

from feeddrive.effects.base import Effect
from feeddrive.effects.catalogue import EFFECTS
from feeddrive.errors import InputError
from feeddrive.plant.analysis.linear import state_space
from feeddrive.plant.analysis.modes import braked_modes, free_modes
from feeddrive.plant.analysis.ode import ode, ode_parameters
from feeddrive.plant.analysis.steady import steady_motion
from feeddrive.plant.chain.chain import DistributedScrew
from feeddrive.plant.equations import effect_forces
from feeddrive.plant.plant import Plant
from feeddrive.plant.structure import parameter_symbols, parameter_values
from tests.analytic.screw_fem import ScrewDrive, frequencies, static_stiffness
from tests.claims.book import CLAIMS

DRIVE = ScrewDrive()
PLACES = np.linspace(0.1, 1.1, 11)
"""Nut from the bearing at the motor's end [m]."""


def chain_of(drive: ScrewDrive, elements: int = 1, **others: float) -> DistributedScrew:
    """The chain of a drive of the oracle; the table stands at 0 where the nut is at the bearing."""
    area, polar = math.pi * drive.diameter**2 / 4, math.pi * drive.diameter**4 / 32
    shaft = 1 / (1 / drive.coupling + 1 / drive.motor_shaft)
    hub, share = drive.coupling_inertia / 2, 1 - shaft / drive.coupling
    values = {
        "lead": drive.lead,
        "motor_inertia": drive.rotor_inertia + hub * (1 - share) ** 2,
        "ratio": 1.0,
        "drive_stiffness": shaft,
        "drive_damping": 0.0,
        "shared_inertia": hub * share * (1 - share),
        "drive_end_inertia": hub * (1 + share**2),
        "drive_length": drive.stub,
        "bearing_distance": drive.length,
        "screw_length": drive.length,
        "axial_rigidity": drive.young * area,
        "torsional_rigidity": drive.shear * polar,
        "mass_per_length": drive.density * area,
        "inertia_per_length": drive.density * polar,
        "damping_time": 0.0,
        "bearing_stiffness": drive.bearing,
        "far_bearing_stiffness": drive.far_bearing,
        "nut_stiffness": drive.nut,
        "nut_damping": 0.0,
        "table_mass": drive.table,
        "first_nut_position": 0.0,
    }
    return DistributedScrew({**values, **others}, elements)


def plant_of(drive: ScrewDrive = DRIVE, elements: int = 1, **others: float) -> Plant:
    return Plant("drive of the source", chain_of(drive, elements, **others))


def worst(drive: ScrewDrive, elements: int, braked: bool) -> np.ndarray:
    """Largest relative error of the first two frequencies over the stroke."""
    plant = plant_of(drive, elements)
    modes = braked_modes if braked else free_modes
    first = 0 if braked else 1
    errors = [
        modes(plant, x).frequencies[first : first + 2] / frequencies(drive, x, braked=braked, count=2) - 1
        for x in PLACES
    ]
    return np.max(np.abs(errors), axis=0)


def test_six_coordinates_free() -> None:
    # The source's digest allows 1 %; the first frequency is an order better.
    first, second = 100 * worst(DRIVE, 1, braked=False)
    CLAIMS["chain.first"].check(first)
    CLAIMS["chain.free"].check(second)


def test_six_coordinates_braked() -> None:
    # The source's digest allows 1.3 %, which is needed near the far end.
    first, second = 100 * worst(DRIVE, 1, braked=True)
    CLAIMS["chain.first"].check(first)
    CLAIMS["chain.braked"].check(second)


def test_six_coordinates_fixed_at_both_ends() -> None:
    # As the docstring says; what is missing is a coordinate inside the long main span.
    for braked in (True, False):
        assert (worst(ScrewDrive(far_bearing=780e6), 1, braked) < [0.007, 0.021]).all()


@pytest.mark.parametrize("braked", [True, False])
@pytest.mark.parametrize("far_bearing", [0.0, 780e6])
def test_main_span_split_in_two(braked: bool, far_bearing: float) -> None:
    # Asked for are 0.2 %.
    assert (worst(ScrewDrive(far_bearing=far_bearing), 2, braked) < [0.0010, 0.0015]).all()


@pytest.mark.parametrize("braked", [True, False])
@pytest.mark.parametrize("far_bearing", [0.0, 780e6])
@pytest.mark.parametrize("change", [{"length": 1.5}, {"length": 0.9, "coupling_inertia": 0.0}, {"diameter": 0.025}])
def test_main_span_split_in_two_on_other_drives(braked: bool, far_bearing: float, change: dict[str, float]) -> None:
    drive = ScrewDrive(far_bearing=far_bearing, **change)
    plant, modes = plant_of(drive, 2), braked_modes if braked else free_modes
    for x in np.linspace(0.1, drive.length - 0.1, 7):
        found = modes(plant, x).frequencies[0 if braked else 1 :][:2]
        # The worst is a screw of 25 mm, 1.2 m long: its second frequency is 0.52 % off.
        assert found == pytest.approx(frequencies(drive, x, braked=braked, count=2), rel=0.006)


def test_static_stiffness_is_exact() -> None:
    """Springs alone decide it: 202.76 N/µm where the source has 202.7."""
    for elements in (1, 2):
        for far_bearing in (0.0, 780e6):
            drive = ScrewDrive(far_bearing=far_bearing)
            for x in (0.1, 0.564, 1.1):
                # Elements of a bar give exact static stiffness; the rest is the rounding of 150 unknowns.
                assert static_at_table(chain_of(drive, elements), x) == pytest.approx(
                    static_stiffness(drive, x), rel=1e-7
                )
    assert static_at_table(chain_of(DRIVE), 0.564) / 1e6 == pytest.approx(202.7, abs=0.1)


def static_at_table(chain: DistributedScrew, x: float) -> float:
    K = np.array(chain.stiffness(chain.values, x), dtype=float)[1:, 1:]
    load = np.zeros(len(K))
    load[-1] = 1.0
    return float(1 / np.linalg.solve(K, load)[-1])


@pytest.mark.parametrize(
    ("x", "supported", "fixed"),
    [
        (0.1, (229, 272), (239, 294)),
        (0.3, (207, 239), (226, 272)),
        (0.564, (186, 209), (217, 259)),
        (0.9, (166, 184), (216, 259)),
        (1.1, (157, 173), (220, 267)),
    ],
)
def test_first_frequencies_of_the_digest(x: float, supported: tuple[int, int], fixed: tuple[int, int]) -> None:
    """Printed to 1 Hz, of finite elements: half a digit, and what the chain of six may be off (fixed-fixed: 0.7 %)."""
    for far_bearing, printed in ((0.0, supported), (780e6, fixed)):
        plant = plant_of(ScrewDrive(far_bearing=far_bearing))
        assert braked_modes(plant, x).frequencies[0] == pytest.approx(printed[0], abs=0.5 + 0.003 * printed[0])
        assert free_modes(plant, x).frequencies[1] == pytest.approx(printed[1], abs=0.5 + 0.007 * printed[1])


def test_frozen_inertia_moves_frequencies_little() -> None:
    """M of a cell 10 mm beside the nut, K of the nut's place: what an engine that freezes M does."""
    chain = chain_of(DRIVE)
    for x in (0.2, 0.6, 1.0):
        K = np.array(chain.stiffness(chain.values, x), dtype=float)[1:, 1:]
        squared = [
            np.sort(np.linalg.eigvals(np.linalg.solve(np.array(chain.mass(chain.values, at), float)[1:, 1:], K)).real)
            for at in (x, x + 0.01)
        ]
        shift = np.sqrt(squared[1] / squared[0])[:2] - 1
        # As stated beside the equations.
        assert shift == pytest.approx([0.0002, 0.0011], rel=0.25)


def test_forces_beyond_a_reference_are_those_of_the_matrices() -> None:
    plant = plant_of(elements=2, damping_time=1e-5, first_nut_position=0.2)
    chain, p = plant.chain, plant.chain.values
    generator = np.random.default_rng(3)
    n = len(chain.coordinates)
    q = 1e-4 * generator.normal(size=n)
    q[-1] = 0.31
    rate = generator.normal(size=n)
    at, beside = 0.31, 0.27

    def matrix(of, x: float) -> np.ndarray:
        return np.array(of(p, x), dtype=float)

    slope = (matrix(chain.stiffness, at + 1e-5) - matrix(chain.stiffness, at - 1e-5)) / 2e-5
    # The nut's own spring does not vary, so that the table's place in K and C drops out of the differences.
    expected = -(matrix(chain.stiffness, at) - matrix(chain.stiffness, beside)) @ q
    expected -= (matrix(chain.damping, at) - matrix(chain.damping, beside)) @ rate
    expected[-1] -= 0.5 * q @ slope @ q
    symbols = parameter_symbols(plant)
    forces = effect_forces(plant, symbols, ca.SX(q), ca.SX(rate), ca.SX.zeros(0, 1), 0.0, reference=ca.SX(beside))
    found = ca.Function("f", [symbols.vector], [forces.on_coordinates])(parameter_values(plant))
    # Central differences of 1 / z over 1e-5 of 0.5 m.
    assert np.array(found).ravel() == pytest.approx(expected, rel=1e-6, abs=1e-6 * np.max(np.abs(expected)))


@pytest.mark.parametrize("elements", [1, 2])
def test_energy_is_kept_along_the_stroke(elements: int) -> None:
    """The axis flies along its stroke under the stress of a held force, without dampers: the energy does not change.

    Kinetic energy is counted with the inertia of the place: what the freezing of M leaves out is of second order in the
    relative motion of the shaft's ends.
    """
    plant = plant_of(elements=elements)
    chain, steps, step = plant.chain, 16000, 2.5e-6  # 40 ms, some eight periods of the first mode
    n = len(chain.coordinates)

    def energy(x: np.ndarray) -> float:
        q, rate, at = x[:n], x[n:], x[n - 1]
        M = np.array(chain.mass(chain.values, at), dtype=float)
        stretches = [
            (float(spring.stiffness), float(np.dot(np.array(spring.row, dtype=float), q)))
            for spring in chain.springs(chain.values, at)
        ]
        return float(0.5 * rate @ M @ rate + 0.5 * sum(k * s**2 for k, s in stretches))

    rigid = np.array(chain.rigid_motion(chain.values), dtype=float)
    x = np.concatenate([0.3 * rigid, 0.5 * rigid])
    x[n - 1] += 40e-6  # of stretch: 8 kN
    before = energy(x)
    stored = before - 0.5 * 0.25 * float(rigid @ np.array(chain.mass(chain.values, 0.3), dtype=float) @ rigid)
    run = _runge_kutta(plant, step).mapaccum("run", steps)
    end = np.array(run(x)).reshape(2 * n, -1)[:, -1]
    assert end[n - 1] - 0.3 > 0.015
    # Without the term on the table 0.5 % of the energy stored would be lost; with it the rest is what M leaves out.
    assert energy(end) == pytest.approx(before, abs=0.001 * stored)


def _runge_kutta(plant: Plant, step: float) -> ca.Function:
    function, p = ode(plant), list(ode_parameters(plant).values())
    x = ca.SX.sym("x", function.size1_in(0))
    slopes: list[ca.SX] = []
    for share in (0.0, 0.5, 0.5, 1.0):
        at = x + share * step * slopes[-1] if slopes else x
        slopes.append(function(at, [0.0, 0.0], p)[0])
    return ca.Function("step", [x], [x + step / 6 * (slopes[0] + 2 * slopes[1] + 2 * slopes[2] + slopes[3])])


ADDED: dict[str, Effect | None] = {
    "chain alone": None,
    "lead error": EFFECTS["lead_error_periodic"].of(amplitude=2e-6, order=1.0, phase=0.3),
    "friction": EFFECTS["guide_friction"].of(coulomb=60.0, smoothing_velocity=5e-4, viscous=300.0),
}


@pytest.mark.parametrize("name", ADDED)
@pytest.mark.parametrize("elements", [1, 2])
def test_linearised_about_a_moving_point(name: str, elements: int) -> None:
    plant = plant_of(elements=elements, damping_time=1e-5, nut_damping=1e4)
    effect = ADDED[name]
    plant = plant if effect is None else plant.with_effects(effect)
    system, point = state_space(plant, 0.05, 0.4), steady_motion(plant, 0.05, 0.4)
    function, p = ode(plant), list(ode_parameters(plant).values())
    u = [point.torque, 0.0]
    for column in range(len(point.state)):
        step = np.zeros(len(point.state))
        step[column] = 1e-9
        numeric = np.array(function(point.state + step, u, p)[0] - function(point.state - step, u, p)[0]) / 2e-9
        # Rounding of spring forces at an angle of 100 rad over the step, beside the largest entry.
        assert numeric.ravel() == pytest.approx(system.A[:, column], rel=1e-3, abs=1e-4 * np.max(np.abs(system.A)))


def test_chain_alone_is_passive() -> None:
    chain = chain_of(ScrewDrive(far_bearing=500e6), 2, damping_time=2e-5, nut_damping=5e3, drive_damping=0.1)
    for x in PLACES:
        for of in (chain.damping, chain.stiffness, chain.mass):
            matrix = np.array(of(chain.values, x), dtype=float)
            assert np.allclose(matrix, matrix.T, rtol=1e-15, atol=0)  # products in another order
            # Rounding beside the largest entry; the free motion has the eigenvalue zero.
            assert np.min(np.linalg.eigvalsh(matrix)) >= -1e-15 * len(matrix) * np.max(np.abs(matrix))


def test_gear_between_motor_and_screw() -> None:
    """A ratio i is a motor of inertia i^2 J whose angle is counted i times: the frequencies are the same."""
    geared, direct = plant_of(ratio=2.0, motor_inertia=1.5e-3), plant_of(motor_inertia=6e-3)
    # One eigenvalue problem with its rows scaled.
    assert free_modes(geared, 0.5).frequencies[1:] == pytest.approx(free_modes(direct, 0.5).frequencies[1:], rel=1e-9)
    assert geared.chain.motor_radius == pytest.approx(direct.chain.motor_radius / 2, rel=1e-15)


def test_nut_off_the_screw_is_refused() -> None:
    plant = plant_of(first_nut_position=0.1)
    for position in (-0.1, 1.15):
        with pytest.raises(InputError, match="not on the screw; choose a position from -100 mm to 1"):
            braked_modes(plant, position)
        with pytest.raises(InputError, match="not on the screw"):
            steady_motion(plant, 0.05, position)
