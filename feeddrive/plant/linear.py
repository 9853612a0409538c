"""The plant as an ordinary differential equation, and linearised exactly about a moving point.

    x' = f(x, u, p),  y = g(x, p),  A = df/dx, B = df/du, C = dg/dx, D = 0

x: coordinates, their rates, bristle deflections. u: motor torque [N m], cutting force on the table, along + motion [N].
y: motor angle [rad], motor speed [rad/s], table position [m], table velocity [m/s].

At rest the slope of tanh (level over smoothing velocity) is many thousand times that of sliding friction and swamps
everything, so the point moves unless asked otherwise.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca
import control
import numpy as np

from feeddrive.effects.backlash import Backlash
from feeddrive.effects.base import BristleEffect, Effect, Motion
from feeddrive.errors import InputError
from feeddrive.plant.chain import symbolic
from feeddrive.plant.equations import (
    bristle_count,
    chain_symbols,
    effect_forces,
    friction_level,
    parameter_symbols,
    parameter_values,
    travel_deviation,
)
from feeddrive.plant.plant import Plant
from feeddrive.plant.symbols import Symbols
from feeddrive.typing import Expression, FloatArray

INPUTS = ("motor_torque", "cutting_force")
OUTPUTS = ("motor_angle", "motor_speed", "table_position", "table_velocity")
MOVING = 0.05
"""Velocity of the point about which is linearised by default [m/s]."""

_ALONG = ("axial", "far_axial", "table")
"""Coordinates that are positions; the others are angles."""
_START_STRETCH = 1e-6  # beyond the free play [m]: Newton must start on a flank, inside the gap there is no slope
_NEWTON_STEPS = 30
_ROUNDING = 1e-12  # of the largest spring force: what the difference of two positions leaves


@dataclass(frozen=True)
class SteadyMotion:
    """Motion at constant velocity.

    Attributes:
        state: x in the order of `state_names`.
        torque: motor torque that keeps it up [N m].
    """

    state: FloatArray
    torque: float


def state_names(plant: Plant) -> tuple[str, ...]:
    """Names of the states: positions, rates, bristle deflections."""
    pairs = [_state_pair(coordinate) for coordinate in plant.chain.coordinates]
    bristles = [f"bristle_{i}" if i else "bristle" for i in range(bristle_count(plant))]
    return (*(pair[0] for pair in pairs), *(pair[1] for pair in pairs), *bristles)


def _state_pair(coordinate: str) -> tuple[str, str]:
    if coordinate in _ALONG:
        return f"{coordinate}_position", f"{coordinate}_velocity"
    return f"{coordinate}_angle", f"{coordinate}_speed"


def ode(plant: Plant) -> ca.Function:
    """The equations of motion as a function (x, u, p) -> (xdot, y).

    A chain that depends on the table position is followed: M, C and K are those of the present position.

    Args:
        plant: its structure and effects; its values come in through p. Timing effects are not in it.

    Returns:
        CasADi function with inputs `x`, `u`, `p` and outputs `xdot`, `y`, all SI columns; rows of x are named by
        `state_names`, of u by `INPUTS`, of y by `OUTPUTS`, of p by the keys of `ode_parameters`.
    """
    function = timed_ode(plant)
    x, u, p = (ca.SX.sym(name, function.size1_in(name)) for name in ("x", "u", "p"))
    xdot, y = function(0.0, x, u, p)
    return ca.Function("ode", [x, u, p], [xdot, y], ["x", "u", "p"], ["xdot", "y"])


def timed_ode(plant: Plant) -> ca.Function:
    """The equations of motion as a function (time, x, u, p) -> (xdot, y), with what changes as time goes on.

    As `ode`, which is this at the start; `time` [s] counts from there. Warm-up and thermal growth read it.
    """
    n, symbols = len(plant.chain.coordinates), parameter_symbols(plant)
    time = ca.SX.sym("time")
    x = ca.SX.sym("x", 2 * n + bristle_count(plant))
    u = ca.SX.sym("u", len(INPUTS))
    q, rate, z = x[:n], x[n : 2 * n], x[2 * n :]
    p = chain_symbols(plant, symbols)
    motor, table = symbolic([plant.chain.motor(p)]), symbolic([plant.chain.table(p)])
    forces = effect_forces(plant, symbols, q, rate, z, time, reference=None)
    at = table @ q
    mass, damping, stiffness = (
        symbolic(m(p, at)) for m in (plant.chain.mass, plant.chain.damping, plant.chain.stiffness)
    )
    pushed = motor.T * u[0] + table.T * u[1] + forces.on_coordinates - (damping @ rate + stiffness @ q)
    acceleration = ca.inv_minor(ca.sparsify(mass)) @ pushed
    xdot = ca.vertcat(rate, acceleration, forces.bristle_rates)
    shown = at if plant.chain.elastic else at + _rigid_deviation(plant, symbols, at, time)
    y = ca.vertcat(motor @ q, motor @ rate, shown, ca.jacobian(shown, q) @ rate + ca.jacobian(shown, time))
    return ca.Function("ode", [time, x, u, symbols.vector], [xdot, y], ["time", "x", "u", "p"], ["xdot", "y"])


def _rigid_deviation(plant: Plant, symbols: Symbols, x: Expression, time: Expression) -> Expression:
    """Travel deviation [m] by which the table of a rigid plant stands beside where its motor says it is."""
    phi = symbolic([plant.chain.screw(chain_symbols(plant, symbols))]) @ x
    return travel_deviation(plant, symbols, phi, x, time)


def ode_parameters(plant: Plant) -> dict[str, float]:
    """Name to SI value of every row of p in `ode`, in their order."""
    return dict(zip(parameter_symbols(plant).names, parameter_values(plant), strict=True))


def steady_motion(plant: Plant, velocity: float = MOVING, position: float = 0.0) -> SteadyMotion:
    """The state in which the plant moves at constant velocity, its springs and bristles loaded by friction.

    Args:
        plant: the machine.
        velocity: of the table [m/s].
        position: of the table [m].

    Raises:
        InputError: no such state is found, for instance inside a free play that nothing loads, or the nut would not
            be on the screw.
    """
    return steady_motions(plant, (velocity,), position)[0]


def steady_motions(plant: Plant, velocities: Sequence[float], position: float = 0.0) -> tuple[SteadyMotion, ...]:
    """Steady motion at several velocities [m/s], the equations made once; otherwise as `steady_motion`.

    Raises:
        InputError: as `steady_motion`.
    """
    plant.chain.refuse_off_screw(position, plant.name)
    if not (math.isfinite(position) and all(math.isfinite(velocity) for velocity in velocities)):
        raise InputError("velocity and position must be finite numbers", plant.name, "give e.g. 0.05 m/s at 0 m")
    function = ode(plant)
    return tuple(_steady(plant, function, velocity, position) for velocity in velocities)


def _steady(plant: Plant, function: ca.Function, velocity: float, position: float) -> SteadyMotion:
    side = -1.0 if velocity < 0 else 1.0
    for flank in (side, -side):
        found = _solve(plant, function, velocity, position, flank)
        if found is not None:
            return found
    raise InputError(f"no steady motion at {velocity:g} m/s", plant.name, "choose another velocity or position")


def state_space(plant: Plant, velocity: float = MOVING, position: float = 0.0) -> control.StateSpace:
    """The plant linearised exactly about a steady motion.

    By default the point moves: at rest the slope of the friction swamps everything (see the module). Where a delay
    (`drive_delay`) is declared it is not in the result, since it is no finite state space.

    Args:
        plant: the machine.
        velocity: of the table at the point [m/s].
        position: of the table at the point [m].

    Returns:
        State space with named states, inputs (`INPUTS`) and outputs (`OUTPUTS`), SI.

    Raises:
        InputError: no steady motion is found there.
    """
    function, point = ode(plant), steady_motion(plant, velocity, position)
    x, u, p = (ca.SX.sym(name, function.size1_in(name)) for name in ("x", "u", "p"))
    xdot, y = function(x, u, p)
    pairs = [(xdot, x), (xdot, u), (y, x), (y, u)]
    jacobians = ca.Function("jacobians", [x, u, p], [ca.jacobian(of, to) for of, to in pairs])
    at = jacobians(point.state, [point.torque, 0.0], parameter_values(plant))
    matrices = [np.array(matrix.full()) for matrix in at]
    return control.ss(*matrices, states=list(state_names(plant)), inputs=list(INPUTS), outputs=list(OUTPUTS))


def _solve(plant: Plant, function: ca.Function, velocity: float, position: float, flank: float) -> SteadyMotion | None:
    """Newton from one flank of the free play: positions but that of the table, torque and bristles are unknown."""
    n = len(plant.chain.coordinates)
    unknown = ca.SX.sym("unknown", n + bristle_count(plant))
    x = _moving_state(plant, velocity, position, unknown)
    xdot, _ = function(x, ca.vertcat(unknown[n - 1], 0), parameter_values(plant))
    mass = symbolic(plant.chain.mass(plant.chain_values(), position))
    residual = ca.vertcat(mass @ xdot[n : 2 * n], xdot[2 * n :])
    newton = ca.Function("newton", [unknown], [residual, ca.jacobian(residual, unknown)])
    values = _start(plant, velocity, position, flank)
    for _ in range(_NEWTON_STEPS):
        error, slope = (np.array(part.full()) for part in newton(values))
        if not (np.isfinite(error).all() and np.isfinite(slope).all()):
            return None
        if np.max(np.abs(error)) <= _tolerance(plant, values, position):
            return SteadyMotion(_state_at(x, unknown, values), float(values[n - 1]))
        if velocity == 0:
            slope[:, n:] = 0.0  # at rest any deflection is steady: the bristles stay unloaded
        values = values - _scaled_solution(slope, error[:, 0])
    return None


def _moving_state(plant: Plant, velocity: float, position: float, unknown: Expression) -> Expression:
    """x with the table at `position` and every coordinate at the rate that belongs to `velocity`."""
    n = len(plant.chain.coordinates)
    rates = [velocity * rate for rate in plant.chain.rigid_motion(plant.chain_values())]
    unknowns = [unknown[i] for i in range(unknown.numel())]  # a slice of length zero is not empty in CasADi
    return ca.vertcat(*unknowns[: n - 1], position, *rates, *unknowns[n:])


def _start(plant: Plant, velocity: float, position: float, flank: float) -> FloatArray:
    widths = [effect.values["width"] for effect in plant.effects if isinstance(effect, Backlash)]
    play = float(np.sum(np.array(widths, dtype=float)))
    travel = position + flank * (0.5 * play + _START_STRETCH)
    rigid = [travel * rate for rate in plant.chain.rigid_motion(plant.chain_values())]
    bristles = [_sliding_deflection(plant, bristle, velocity, position) for bristle in plant.effects_of(BristleEffect)]
    return np.array([*rigid[:-1], 0.0, *bristles])


def _sliding_deflection(plant: Plant, bristle: Effect, velocity: float, position: float) -> float:
    """Deflection of a bristle that slides [m]; a smaller one may stick, where Newton finds no slope."""
    symbols = parameter_symbols(plant)
    level = friction_level(plant, symbols, bristle.port, Motion(ca.SX(position), ca.SX(velocity)))
    deflection = np.sign(velocity) * level / symbols.effects[bristle.label]["stiffness"]
    return float(ca.Function("deflection", [symbols.vector], [deflection])(parameter_values(plant)))


def _tolerance(plant: Plant, values: FloatArray, position: float) -> float:
    """Residual force [N or N m] that rounding leaves."""
    stiffness = np.max(np.abs(np.array(plant.chain.stiffness(plant.chain_values(), position), dtype=float)))
    return float(1e-9 + _ROUNDING * stiffness * (np.max(np.abs(values[:-1]), initial=0.0) * plant.chain.radius + 1e-3))


def _state_at(x: Expression, unknown: Expression, values: FloatArray) -> FloatArray:
    state: FloatArray = np.array(ca.Function("state", [unknown], [x])(values).full())[:, 0]
    return state


def _scaled_solution(slope: FloatArray, error: FloatArray) -> FloatArray:
    """Least-squares solution with columns of like size; a bristle at rest has no slope and stays."""
    size = np.max(np.abs(slope), axis=0)
    size[size == 0] = 1.0
    solution: FloatArray = np.linalg.lstsq(slope / size, error, rcond=None)[0] / size
    return solution
