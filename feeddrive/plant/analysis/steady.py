"""Motion at constant velocity: the state that keeps it up, and the motor torque."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca
import numpy as np

from feeddrive.effects.base import BristleEffect, Effect, Motion, TransmissionEffect
from feeddrive.errors import InputError
from feeddrive.plant.analysis.ode import ode
from feeddrive.plant.chain.chain import symbolic
from feeddrive.plant.equations import bristle_count
from feeddrive.plant.friction_law import friction_level
from feeddrive.plant.plant import Plant
from feeddrive.plant.structure import parameter_symbols, parameter_values
from feeddrive.symbolic_turn import SYMBOLS
from feeddrive.typing import Expression, FloatArray

MOVING = 0.05
"""Velocity of the point about which is linearised by default [m/s]."""

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


def steady_motion(plant: Plant, velocity: float = MOVING, position: float = 0.0) -> SteadyMotion:
    """The state in which the table moves at `velocity` [m/s], at `position` [m], springs and bristles loaded.

    Raises InputError where there is none, for instance inside a free play that nothing loads, or the nut is off the
    screw.
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


@SYMBOLS.taken()
def _steady(plant: Plant, function: ca.Function, velocity: float, position: float) -> SteadyMotion:
    side = -1.0 if velocity < 0 else 1.0
    for flank in (side, -side):
        found = _solve(plant, function, velocity, position, flank)
        if found is not None:
            return found
    raise InputError(f"no steady motion at {velocity:g} m/s", plant.name, "choose another velocity or position")


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
    slots = [effect for effect in plant.effects if isinstance(effect, TransmissionEffect)]
    play = float(sum(effect.free_play(effect.values) for effect in slots))
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
