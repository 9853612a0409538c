"""Runs of a chain that varies with the table position: against Runge and Kutta, and whatever the cells are."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest

from feeddrive.effects.friction.guide_friction import GuideFriction
from feeddrive.engine import compiled, engine, interpreted
from feeddrive.engine.step.linear_part import SimulationError
from feeddrive.plant.analysis.ode import ode
from feeddrive.plant.plant import Plant
from feeddrive.plant.structure import parameter_values
from feeddrive.simulate.controlled.controlled import simulate_controlled
from feeddrive.simulate.driven import motor_motion, simulate_driven
from feeddrive.simulate.held_torque import initial_state, simulate_torque
from tests.convergence.test_chain_against_elements import plant_of
from tests.convergence.test_controlled import cascade, reference

SAMPLE = 1e-3


@pytest.fixture(scope="module")
def plant() -> Plant:
    """The drive of the source, damped, with friction; a screw of 1.2 m."""
    bare = plant_of(first_nut_position=0.1, damping_time=1e-5, nut_damping=2e4, drive_damping=0.1)
    return bare.with_effects(GuideFriction.of(coulomb=60.0, smoothing_velocity=5e-3, viscous=300.0))


def runge_kutta(plant: Plant, torque: np.ndarray, position: float, velocity: float) -> np.ndarray:
    """Table position at the samples from the plant's own differential equation, in steps of 1 us [m]."""
    function, values, steps = ode(plant), parameter_values(plant), 1000
    y, u = ca.SX.sym("y", function.size1_in(0)), ca.SX.sym("u")
    h, slopes = SAMPLE / steps, []
    for share in (0.0, 0.5, 0.5, 1.0):
        at = y + share * h * slopes[-1] if slopes else y
        slopes.append(function(at, ca.vertcat(u, 0), values)[0])
    after = y + h / 6 * (slopes[0] + 2 * slopes[1] + 2 * slopes[2] + slopes[3])
    sample = ca.Function("step", [y, u], [after]).mapaccum("sample", steps)
    state, found = initial_state(plant, position, velocity), []
    for held in torque:
        found.append(state[len(plant.chain.coordinates) - 1])
        state = np.array(sample(state, np.full((1, steps), held)))[:, -1]
    return np.array(found)


def test_against_runge_kutta(plant: Plant) -> None:
    time = np.arange(40) * SAMPLE
    torque = 8 * np.sign(np.sin(2 * np.pi * 60 * time)) + 3
    run = simulate_torque(plant, time, torque, 0.3, 0.4)
    assert np.ptp(run.position) > 0.015  # several cells
    # 0.1 nm, a hundredth of a good scale's step
    assert np.abs(run.position - runge_kutta(plant, torque, 0.3, 0.4)).max() < 1e-10


def test_cells_do_not_show(plant: Plant, monkeypatch: pytest.MonkeyPatch) -> None:
    count, positions = 400, []
    for width in (2e-3, 5e-3, 20e-3):
        for module in (engine, compiled, interpreted):
            monkeypatch.setattr(module, "CELL", width)
        engine.forget_constants()
        run = simulate_controlled(plant, cascade(), 5 * reference(count))
        positions.append(run.table_position)
    monkeypatch.undo()
    engine.forget_constants()
    assert np.ptp(positions[0]) > 0.1
    # 0.1 nm: what the steps' own tolerance of 0.01 nm leaves; M frozen without its force would leave 30 nm
    assert max(np.abs(p - positions[0]).max() for p in positions[1:]) < 1e-10


def test_driven_motion_gives_back_the_torque(plant: Plant) -> None:
    """A smooth torque moves the axis; its motor motion asks for that torque again, hub and moving inertia included."""
    time = np.arange(2000) * 2.5e-4
    torque = 3 * np.sin(2 * np.pi * 4 * time)
    run = simulate_torque(plant, time, torque, 0.3)
    load = simulate_driven(plant, motor_motion(time, run.motor_angle, 4))
    inner = slice(800, -400)  # the driven run starts without stretch
    acting = 0.5 * (run.torque[1:] + run.torque[:-1])  # the torque is held: a sample sees the mean of the two
    assert np.abs(load.torque[1:] - acting)[inner].max() < 2e-3
    assert np.abs(load.table_position - run.position)[inner].max() < 1e-9  # a tenth of a good scale's step


def test_leaving_the_screw_is_refused(plant: Plant) -> None:
    time = np.arange(2000) * SAMPLE
    with pytest.raises(SimulationError, match="leaves the screw"):
        simulate_torque(plant, time, np.full(2000, 10.0), 0.9)
