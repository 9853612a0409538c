"""Runs under a sampled controller: against closed forms of a linear plant, resumed runs, sensors, refusals."""

from __future__ import annotations

import dataclasses
import math

import casadi as ca
import numpy as np
import pytest
from scipy.linalg import expm

from feeddrive.effects.friction.presliding import Presliding
from feeddrive.effects.timing.drive_delay import DriveDelay
from feeddrive.effects.transmission.backlash import Backlash
from feeddrive.errors import InputError
from feeddrive.plant.plant import Plant, Sensor
from feeddrive.servo.sampled_plant import SampledController
from feeddrive.simulate.controlled.controlled import (
    ControlledRun,
    TorqueLoop,
    resting_state,
    simulate_controlled,
    state_from,
)
from feeddrive.typing import FloatArray
from tests.convergence.test_simulate import BENCH, bench

SAMPLE = 5e-4
QUIET = Plant("quiet", BENCH)


def cascade(gain: float = 60.0) -> SampledController:
    """Position loop every second tick around a velocity loop with integral action; shows the speed wanted."""
    state, reference, measured, tick, p = (
        ca.SX.sym("s", 2),
        ca.SX.sym("r", 2),
        ca.SX.sym("m", 2),
        ca.SX.sym("k"),
        ca.SX.sym("p", 3),
    )
    held = ca.if_else(ca.fmod(tick, 2) == 0, p[0] * (reference[0] - measured[0]) + reference[1], state[1])
    error = held / BENCH.radius - measured[1]
    integral = state[0] + p[2] * error
    function = ca.Function(
        "cascade", [state, reference, measured, tick, p], [ca.vertcat(integral, held), p[1] * error + integral, held]
    )
    parameters = np.array([gain, 0.8, 0.8 * SAMPLE / 0.02])
    fed, read = ("position", "velocity"), ("table_position", "motor_speed")
    return SampledController(function, np.zeros(2), parameters, SAMPLE, fed, read, ("wanted",))


def reference(count: int) -> FloatArray:
    """Position [m] and velocity [m/s] of a smooth stroke."""
    time = SAMPLE * np.arange(count)
    turn = 2 * math.pi * 3
    return np.column_stack([0.02 * (1 - np.cos(turn * time)), 0.02 * turn * np.sin(turn * time)])


def by_hand(loop: TorqueLoop, count: int, load: FloatArray) -> FloatArray:
    """Table position [m] of the linear axis, the torque switched exactly where it arrives, by matrix exponentials."""
    v, r = BENCH.values, BENCH.radius
    kt, ct, ka, da = (v[k] for k in ("torsional_stiffness", "torsional_damping", "axial_stiffness", "axial_damping"))
    twist, stretch = np.array([1.0, -1.0, 0.0]), np.array([0.0, r, -1.0])
    K = kt * np.outer(twist, twist) + ka * np.outer(stretch, stretch)
    C = ct * np.outer(twist, twist) + da * np.outer(stretch, stretch)
    inverse = np.diag([1 / v["motor_inertia"], 1 / v["screw_inertia"], 1 / v["table_mass"]])
    A = np.zeros((9, 9))  # q, q', torque, command, load
    A[:3, 3:6], A[3:6, :3], A[3:6, 3:6] = np.eye(3), -inverse @ K, -inverse @ C
    A[3, 6 if loop.lag else 7], A[5, 8] = inverse[0, 0], inverse[2, 2]
    if loop.lag:
        A[6, 6], A[6, 7] = -1 / loop.lag, 1 / loop.lag
    whole, rest = divmod(loop.dead_time, SAMPLE)
    x, integral, wanted, positions, sent = np.zeros(9), 0.0, 0.0, [], [0.0] * (int(whole) + 2)
    controller, ref = cascade(), reference(count)
    for k in range(count):
        positions.append(x[2])
        if k % 2 == 0:
            wanted = controller.parameters[0] * (ref[k, 0] - x[2]) + ref[k, 1]
        error = wanted / r - x[3]
        integral += controller.parameters[2] * error
        sent.append(controller.parameters[1] * error + integral)
        for age, span in ((2, rest), (1, SAMPLE - rest)):
            x[7], x[8] = sent[-int(whole) - age], load[k]
            x = expm(span * A) @ x
    return np.array(positions)


@pytest.mark.parametrize(
    "loop", [TorqueLoop(), TorqueLoop(lag=2.5e-4), TorqueLoop(1e-4, 1e-4), TorqueLoop(3e-4, 7e-4)], ids=str
)
def test_linear_axis_against_matrix_exponentials(loop: TorqueLoop) -> None:
    count = 300
    load = np.where(np.arange(count) > 150, -200.0, 0.0)
    run = simulate_controlled(QUIET, cascade(), reference(count), load, loop)
    # rounding of spring forces: 1e-16 of 40 mm at 245 N/um moves the table by less than 1e-14 m a step
    assert np.abs(run.table_position - by_hand(loop, count, load)).max() < 1e-12
    assert run.report.steps == count * (2 if loop.dead_time % SAMPLE else 1)


def joined(first: ControlledRun, second: ControlledRun, name: str) -> FloatArray:
    """A series over two runs."""
    return np.concatenate([getattr(first, name), getattr(second, name)])


def test_resumed_run_is_the_same_run() -> None:
    plant = bench(Presliding.of(stiffness=5e7, damping=2e3, break_away=0.7), Backlash.of(width=5e-6))
    loop, wanted = TorqueLoop(2e-4, 7e-4), reference(200)
    whole = simulate_controlled(plant, cascade(20.0), wanted, None, loop)
    first = simulate_controlled(plant, cascade(20.0), wanted[:77], None, loop)
    again = state_from(first.end.vector)
    second = simulate_controlled(plant, cascade(20.0), wanted[77:], None, loop, again)
    for name in ("time", "command", "torque", "table_position", "motor_speed"):
        assert np.array_equal(joined(first, second, name), getattr(whole, name)), name
    assert second.end.tick == 200
    assert np.array_equal(second.end.vector, whole.end.vector)


def test_torque_limit_and_signals() -> None:
    plant = dataclasses.replace(bench(), torque_limit=3.0)
    run = simulate_controlled(plant, cascade(), reference(400))
    assert np.abs(run.command).max() == 3.0
    assert np.array_equal(run.torque, run.command)
    assert np.array_equal(run.signals["wanted"][::2], run.signals["wanted"][1::2])  # every second tick
    names = dict(zip(run.state_names, run.states.T, strict=True))
    assert np.array_equal(names["table_position"], run.table_position)


def test_resolution_of_sensors() -> None:
    """A controller that reads the table in steps of 10 um drives the axis as if the reading were rounded."""
    plant = dataclasses.replace(bench(), sensors=(Sensor("table_position", "scale", "table", 1e-5),))
    coarse = simulate_controlled(plant, cascade(), reference(300))
    exact = simulate_controlled(plant, cascade(), reference(300), quantised=False)
    expected = np.floor(coarse.table_position / 1e-5 + 0.5) * 1e-5
    wanted = 60.0 * (reference(300)[:, 0] - expected) + reference(300)[:, 1]
    assert np.abs(coarse.signals["wanted"] - wanted)[::2].max() < 1e-12  # rounding
    assert 1e-7 < np.abs(coarse.table_position - exact.table_position).max() < 2e-5  # felt, and no more than two steps


def test_delay_of_the_drive_and_dead_time_add() -> None:
    together = simulate_controlled(bench(), cascade(), reference(200), None, TorqueLoop(dead_time=9e-4))
    apart = simulate_controlled(
        bench(DriveDelay.of(delay=4e-4)), cascade(), reference(200), None, TorqueLoop(dead_time=5e-4)
    )
    assert np.abs(together.table_position - apart.table_position).max() < 1e-12  # rounding of the sum of the two


def test_unusable_input_is_refused() -> None:
    with pytest.raises(InputError, match="one column for each of position, velocity"):
        simulate_controlled(QUIET, cascade(), np.zeros(10))
    with pytest.raises(InputError, match="10 references and a load"):
        simulate_controlled(QUIET, cascade(), reference(10), np.zeros(9))
    with pytest.raises(InputError, match="not a number"):
        simulate_controlled(QUIET, cascade(), np.full((10, 2), np.nan))
    with pytest.raises(InputError, match="another plant"):
        foreign = resting_state(QUIET, cascade(), TorqueLoop(lag=1e-3))
        simulate_controlled(QUIET, cascade(), reference(10), start=foreign)
    with pytest.raises(InputError, match="lag"):
        TorqueLoop(lag=-1.0)
