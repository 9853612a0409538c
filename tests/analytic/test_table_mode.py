"""A further resonance on the table: frequencies, limits and motion in closed form, on every elastic chain."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from feeddrive.effects.chain.payload import Payload
from feeddrive.effects.chain.structural_mode import StructuralMode
from feeddrive.errors import InputError
from feeddrive.files import plants_folder
from feeddrive.plant.analysis.linear import linear_matrices
from feeddrive.plant.analysis.modes import braked_modes, free_modes
from feeddrive.plant.analysis.ode import state_names
from feeddrive.plant.analysis.steady import steady_motion
from feeddrive.plant.analysis.summary import summarise
from feeddrive.plant.chain.chain import Rigid, ThreeInertias
from feeddrive.plant.file.lumped_text import plant_text_with_effects
from feeddrive.plant.file.plant_file import read_plant
from feeddrive.plant.plant import Plant
from feeddrive.simulate.driven import motor_motion, simulate_driven
from tests.analytic.test_energy import free_run
from tests.convergence.test_simulate import BENCH

MODE = StructuralMode.of(mass=16.0, frequency=70.0, damping=0.03)
ELASTIC = ("bench_axis", "kimm_testbed", "hsr_axis", "vertical_axis")


def test_frequencies_of_two_masses() -> None:
    """With the screw held, the table on k and the mass on it: w^4 - w^2 (k/M + w0^2 (1 + m/M)) + k w0^2/M = 0."""
    stiff = ThreeInertias({**BENCH.values, "torsional_stiffness": 1e9})
    found = braked_modes(Plant("held", stiff, (MODE,))).frequencies
    m_over, k_over, w0 = 16.0 / 134.0, 244.7e6 / 134.0, 2 * math.pi * 70.0
    squared = np.sort(np.roots([1.0, -(k_over + w0**2 * (1 + m_over)), k_over * w0**2]).real)
    assert found[:2] == pytest.approx(np.sqrt(squared) / (2 * math.pi), rel=1e-5)  # the screw gives way by 2e-6


@pytest.mark.parametrize("name", ELASTIC)
def test_it_is_one_more_coordinate_before_the_table(name: str) -> None:
    declared = read_plant(plants_folder() / f"{name}.toml")
    plant = declared.with_effects(MODE)
    assert plant.chain.coordinates == (*declared.chain.coordinates[:-1], "structural_mode", "table")
    assert len(state_names(plant)) == len(state_names(declared)) + 2
    at = plant.middle
    M = np.array(plant.chain.mass(plant.chain_values(), at), dtype=float)
    assert np.array_equal(M, M.T) and np.linalg.eigvalsh(M)[0] > 0
    # moved together it weighs 16 kg more; its own frequency lies near 70 Hz, the others move little
    assert summarise(plant, at).mass_at_table == pytest.approx(summarise(declared, at).mass_at_table + 16.0)
    before, after = free_modes(declared, at).frequencies, free_modes(plant, at).frequencies
    assert np.any(np.abs(after - 70.0) < 1.5) and len(after) == len(before) + 1
    assert plant.with_effects(Payload.of(mass=1.0)).chain.coordinates == plant.chain.coordinates


def test_table_stands_still_at_its_frequency() -> None:
    """An absorber without damper: a force on the table at its own frequency moves the mass alone."""
    plant = Plant("absorber", BENCH, (StructuralMode.of(mass=16.0, frequency=70.0, damping=0.0),))
    A, B, C, _ = linear_matrices(plant)
    for frequency, still in ((70.0, True), (60.0, False)):
        response = C @ np.linalg.solve(2j * math.pi * frequency * np.eye(len(A)) - A, B[:, 1])
        per_rigid = abs(response[2]) * 134.0 * (2 * math.pi * frequency) ** 2
        assert (per_rigid < 1e-9) == still


def test_deflection_under_constant_acceleration() -> None:
    """d = -a / w^2: 3 m/s^2 leave 15.5 um at 70 Hz."""
    time = np.arange(4000) * 5e-4
    motion = motor_motion(time, 0.5 * 3.0 / BENCH.radius * time**2)
    heavy, bare = (simulate_driven(Plant("driven", BENCH, e), motion) for e in ((Payload.of(mass=16.0),), ()))
    moved = simulate_driven(Plant("driven", BENCH, (MODE,)), motion)
    # once the swinging has died down the table lags and the motor pulls as with 16 kg more
    late = slice(-200, -20)
    assert moved.force[late] == pytest.approx(heavy.force[late], rel=1e-4)
    assert moved.torque[late] == pytest.approx(heavy.torque[late], rel=1e-4)
    assert np.mean(moved.force[late] - bare.force[late]) == pytest.approx(16.0 * 3.0, rel=1e-3)


def test_payload_is_its_limit() -> None:
    """What is left of the difference to a payload falls with the square of the frequency: 26 nm at 400 Hz."""
    time = np.arange(2000) * 5e-4
    motion = motor_motion(time, 0.2 * np.sin(2 * np.pi * 40 * time))
    payload = simulate_driven(Plant("driven", BENCH, (Payload.of(mass=16.0),)), motion).table_position
    apart = []
    for frequency in (400.0, 800.0, 1600.0):
        mode = StructuralMode.of(mass=16.0, frequency=frequency, damping=0.1)
        position = simulate_driven(Plant("driven", BENCH, (mode,)), motion).table_position
        apart.append(float(np.abs(position - payload)[1200:1900].max()))
    # 4 per octave; the next order is (w/w0)^2, a hundredth at 400 Hz
    assert apart[0] / apart[1] == pytest.approx(4.0, rel=0.05)
    assert apart[1] / apart[2] == pytest.approx(4.0, rel=0.05)


def test_it_vanishes_with_its_mass() -> None:
    time = np.arange(400) * 5e-4
    motion = motor_motion(time, 20.0 * np.sin(2 * np.pi * 4 * time))
    nothing = StructuralMode.of(mass=1e-6, frequency=70.0, damping=0.03)
    with_it, without = (simulate_driven(Plant("driven", BENCH, e), motion) for e in ((nothing,), ()))
    # 1e-8 of the table's 134 kg, which 100 m/s^2 move: 0.4 pm of lag
    assert with_it.table_position == pytest.approx(without.table_position, abs=2e-12)


def test_energy_is_kept_without_dampers() -> None:
    bare = ThreeInertias({**BENCH.values, "torsional_damping": 0.0, "axial_damping": 0.0})
    plant = Plant("free", bare, (StructuralMode.of(mass=16.0, frequency=70.0, damping=0.0),))
    run = free_run(plant, np.array([0.0, 0.0, 1e-5, -1e-5, 1.0, 0.0, 0.0, 0.02]), 400)
    values = plant.chain_values()
    M, K = (np.array(matrix(values), dtype=float) for matrix in (plant.chain.mass, plant.chain.stiffness))
    q, rate = run.states[:, :4], run.states[:, 4:]
    energy = 0.5 * (np.einsum("ti,ij,tj->t", q, K, q) + np.einsum("ti,ij,tj->t", rate, M, rate))
    assert np.ptp(q[:, 2]) > 1e-5
    assert np.ptp(energy) < 1e-8 * energy[0]  # a linear chain is propagated exactly, but for rounding in 400 samples


def test_two_of_them_and_its_plant_file(tmp_path: Path) -> None:
    source = plants_folder() / "bench_axis.toml"
    second = StructuralMode.of(mass=5.0, frequency=120.0, damping=0.02)
    path = tmp_path / "after.toml"
    path.write_text(plant_text_with_effects(source.read_text(encoding="utf-8"), (MODE, second)), encoding="utf-8")
    again, direct = read_plant(path), read_plant(source).with_effects(MODE, second)
    assert again.chain.coordinates == ("motor", "screw", "structural_mode", "structural_mode_2", "table")
    assert steady_motion(again).torque == pytest.approx(steady_motion(read_plant(source)).torque, rel=1e-9)
    time = np.arange(400) * 5e-4
    motion = motor_motion(time, 20.0 * np.sin(2 * np.pi * 4 * time))
    one, other = simulate_driven(again, motion), simulate_driven(direct, motion)
    assert np.array_equal(one.torque, other.torque) and np.array_equal(one.table_position, other.table_position)


def test_rigid_structure_refuses_it() -> None:
    rigid = Rigid({"lead": 0.02, "motor_inertia": 1e-3, "screw_inertia": 1e-3, "table_mass": 100.0})
    with pytest.raises(InputError, match="structural_mode needs an elastic transmission"):
        Plant("rigid", rigid, (MODE,))
