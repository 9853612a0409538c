"""State feedback with an observer of the state and of the load, as a sampled controller.

    x^+ = A x^ + B u + E d^ + L_x (y - C x^),    d^+ = d^ + L_d (y - C x^)
    u   = u_r - K (x^ - x_r),   limited to +- T_max
    x_r = X_p p + X_v v + X_a a + X_d d^,        u_r = u_v v + u_a a + u_d d^

| symbol | meaning | unit |
|---|---|---|
| A, B, E, C | plant and torque loop, sampled (`servo.sampled_plant`): torque, force on the table, measured | SI |
| K | gain of the state feedback, by whatever method: `control.place`, `control.dlqr` | SI |
| L_x, L_d | gain of the observer, likewise from the dual system (`with_load`) | SI |
| d^ | estimate of the force on the table along + motion: friction beyond the linear slope, cutting force | N |
| p, v, a | set-point of the table: position, velocity, acceleration | m, m/s, m/s^2 |
| X_., u_. | state and torque that belong to standing at p, moving at v, accelerating at a, carrying d | SI |

The columns X and u solve the sampled plant exactly with the table on its set-point, so that neither a ramp, nor a
parabola, nor a constant force leaves an error of the linear plant. Source: Franklin, Powell, Workman, Digital Control
of Dynamic Systems, 3rd ed., chapter 8 (reference and disturbance with estimators).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import casadi as ca
import numpy as np

from feeddrive.errors import InputError
from feeddrive.plant.analysis.ode import OUTPUTS
from feeddrive.servo.sampled_plant import Matrices, SampledController
from feeddrive.symbolic_turn import SYMBOLS
from feeddrive.typing import FloatArray

if TYPE_CHECKING:
    import control

MEASURED = ("motor_angle", "table_position")
"""What the observer reads: encoder and linear scale."""

REFERENCES = ("position", "velocity", "acceleration")
SIGNALS = ("load", "table_estimate", "unlimited_torque")
"""d^ [N], table position as estimated [m], u before its limit [N m]."""

_TABLE = OUTPUTS.index("table_position")


@dataclass(frozen=True)
class Steady:
    """States and torques that belong to a set-point and a load; see the module.

    Attributes:
        states: columns X_p, X_v, X_a, X_d, shape (n, 4).
        torques: u_p = 0, u_v, u_a, u_d, shape (4,).
    """

    states: FloatArray
    torques: FloatArray


def measured_rows(machine: Matrices) -> FloatArray:
    """C of `MEASURED`, shape (2, n)."""
    return machine.c[[OUTPUTS.index(name) for name in MEASURED]]


def with_load(machine: Matrices) -> tuple[FloatArray, FloatArray]:
    """A and C of the plant with the load as a further, constant state; what an observer is designed for.

    Returns:
        Shapes (n + 1, n + 1) and (2, n + 1).
    """
    n = len(machine.a)
    a = np.block([[machine.a, machine.b[:, 1:2]], [np.zeros((1, n)), np.ones((1, 1))]])
    return a, np.hstack([measured_rows(machine), np.zeros((len(MEASURED), 1))])


def steady_columns(machine: Matrices, tick: float) -> Steady:
    """States and torques of standing, moving, accelerating and carrying a load, the table on its set-point.

    The machine is sampled at the tick [s]. Raises InputError where the torque cannot move the table.
    """
    n = len(machine.a)
    system = np.block([
        [machine.a - np.eye(n), machine.b[:, :1]],
        [machine.c[_TABLE : _TABLE + 1], np.zeros((1, 1))],
    ])  # fmt: skip
    if not np.linalg.matrix_rank(system) == n + 1:
        raise InputError("the torque does not determine the table position", "state feedback", "check the plant")

    def solve(onward: FloatArray, table: float) -> FloatArray:
        solution: FloatArray = np.linalg.solve(system, np.append(onward, table))
        return solution

    place = solve(np.zeros(n), 1.0)
    speed = solve(tick * place[:n], 0.0)
    acceleration = solve(tick * speed[:n] + 0.5 * tick**2 * place[:n], 0.0)
    load = solve(-machine.b[:, 1], 0.0)
    columns = np.column_stack([place, speed, acceleration, load])
    return Steady(columns[:n], columns[n])


def open_loop(
    machine: Matrices, tick: float, gain: FloatArray, observer: FloatArray, actual: Matrices | None = None
) -> control.StateSpace:
    """The loop of state feedback and observer cut at the torque, for its margins, shapes as in `state_feedback`.

    `actual` is another plant with the same states, such as at another position; `machine` if None.
    """
    import control  # takes half a second, with the plotting that it brings

    plant, n = actual or machine, len(machine.a)
    steady = steady_columns(machine, tick)
    by_load = -(steady.torques[3] + gain @ steady.states[:, 3:4])
    back = np.hstack([gain, by_load])
    a, c = with_load(machine)
    inner = a - observer @ c - np.vstack([machine.b[:, :1], np.zeros((1, 1))]) @ back
    whole = np.block([[plant.a, np.zeros((n, n + 1))], [observer @ measured_rows(plant), inner]])
    return control.ss(
        whole, np.vstack([plant.b[:, :1], np.zeros((n + 1, 1))]), np.hstack([np.zeros((1, n)), back]), 0, tick
    )


def state_feedback(
    machine: Matrices, tick: float, gain: FloatArray, observer: FloatArray, torque_limit: float = math.inf,
    position: float = 0.0,
) -> SampledController:  # fmt: skip
    """State feedback with its observer as a sampled controller.

    Args:
        machine: the sampled plant, n states.
        tick: its sample time [s].
        gain: K, shape (n,) or (1, n).
        observer: L_x above L_d, shape (n + 1, 2), in predicting form.
        torque_limit: T_max [N m]; the observer knows the limited torque.
        position: of the table at the start, where it stands without load [m].

    Returns:
        Controller with references `REFERENCES`, measurements `MEASURED` and signals `SIGNALS`.

    Raises:
        InputError: gains of another size.
    """
    n, K, L = len(machine.a), np.atleast_2d(np.asarray(gain, dtype=float)), np.asarray(observer, dtype=float)
    if K.shape != (1, n) or L.shape != (n + 1, len(MEASURED)):
        what = f"gains of shape {K.shape} and {L.shape} for {n} states"
        raise InputError(what, "state feedback", f"give (1, {n}) and ({n + 1}, {len(MEASURED)})")
    if not (np.isfinite(K).all() and np.isfinite(L).all()):
        raise InputError("a gain is no finite number", "state feedback", "check the poles or weights that it is of")
    steady = steady_columns(machine, tick)
    function = _function(machine, K, L, steady, torque_limit)
    initial = np.append(position * steady.states[:, 0], 0.0)
    return SampledController(function, initial, np.zeros(0), tick, REFERENCES, MEASURED, SIGNALS)


@SYMBOLS.taken()
def _function(machine: Matrices, K: FloatArray, L: FloatArray, steady: Steady, limit: float) -> ca.Function:
    n = len(machine.a)
    state, reference = ca.SX.sym("state", n + 1), ca.SX.sym("reference", len(REFERENCES))
    measurement, tick, parameters = (
        ca.SX.sym("measurement", len(MEASURED)),
        ca.SX.sym("tick"),
        ca.SX.sym("parameters", 0),
    )
    estimate, load = state[:n], state[n]
    wanted = ca.vertcat(reference, load)
    torque = ca.dot(steady.torques, wanted) - ca.mtimes(K, estimate - ca.mtimes(steady.states, wanted))
    acting = ca.fmin(ca.fmax(torque, -limit), limit) if math.isfinite(limit) else torque
    error = measurement - ca.mtimes(measured_rows(machine), estimate)
    correction = ca.mtimes(L, error)
    onward = ca.mtimes(machine.a, estimate) + machine.b[:, 0] * acting + machine.b[:, 1] * load + correction[:n]
    after = ca.vertcat(onward, load + correction[n])
    signals = ca.vertcat(load, ca.mtimes(machine.c[_TABLE : _TABLE + 1], estimate), torque)
    return ca.Function(
        "state_feedback", [state, reference, measurement, tick, parameters], [after, acting, signals],
        ["state", "reference", "measurement", "tick", "parameters"], ["after", "torque", "signals"],
    )  # fmt: skip
