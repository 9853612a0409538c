"""The plant as an ordinary differential equation.

    x' = f(t, x, u, p),  y = g(t, x, p)

x: coordinates, their rates, bristle deflections. u: motor torque as asked for [N m], cutting force on the
table, along + motion [N].
y: motor angle [rad], motor speed [rad/s], table position [m], table velocity [m/s].
"""

from __future__ import annotations

import casadi as ca

from feeddrive.effects.chain.structural_mode import StructuralMode
from feeddrive.plant.chain.chain import symbolic
from feeddrive.plant.chain.linear_chain import is_travel
from feeddrive.plant.equations import bristle_count, effect_forces
from feeddrive.plant.motor_torque import acting_torque
from feeddrive.plant.plant import Plant
from feeddrive.plant.structure import (
    Symbols,
    chain_symbols,
    parameter_names,
    parameter_symbols,
    parameter_values,
    per_structure,
)
from feeddrive.plant.transmission_law import travel_deviation
from feeddrive.typing import Expression

INPUTS = ("motor_torque", "cutting_force")
OUTPUTS = ("motor_angle", "motor_speed", "table_position", "table_velocity")

_FEW = 10  # coordinates: a chain of a plant file, with a mode or two on its table


def state_names(plant: Plant) -> tuple[str, ...]:
    """Names of the states: positions, rates, bristle deflections."""
    pairs = [_state_pair(coordinate) for coordinate in plant.chain.coordinates]
    bristles = [f"bristle_{i}" if i else "bristle" for i in range(bristle_count(plant))]
    return (*(pair[0] for pair in pairs), *(pair[1] for pair in pairs), *bristles)


def _state_pair(coordinate: str) -> tuple[str, str]:
    if is_travel(coordinate) or coordinate.startswith(StructuralMode.name):
        return f"{coordinate}_position", f"{coordinate}_velocity"
    return f"{coordinate}_angle", f"{coordinate}_speed"


@per_structure
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


@per_structure
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
    acting = acting_torque(plant, symbols, u[0])
    pushed = motor.T * acting + table.T * u[1] + forces.on_coordinates - (damping @ rate + stiffness @ q)
    acceleration = _solved(ca.sparsify(mass), pushed)
    xdot = ca.vertcat(rate, acceleration, forces.bristle_rates)
    shown = at if plant.chain.elastic else at + _rigid_deviation(plant, symbols, at, time)
    y = ca.vertcat(motor @ q, motor @ rate, shown, ca.jacobian(shown, q) @ rate + ca.jacobian(shown, time))
    return ca.Function("ode", [time, x, u, symbols.vector], [xdot, y], ["time", "x", "u", "p"], ["xdot", "y"])


def _solved(mass: Expression, pushed: Expression) -> Expression:
    """M^-1 f; by minors, which are short where M is nearly diagonal, and by elimination where it is large."""
    return ca.inv_minor(mass) @ pushed if mass.shape[0] <= _FEW else ca.solve(mass, pushed)


def _rigid_deviation(plant: Plant, symbols: Symbols, x: Expression, time: Expression) -> Expression:
    """Travel deviation [m] by which the table of a rigid plant stands beside where its motor says it is."""
    phi = symbolic([plant.chain.screw(chain_symbols(plant, symbols))]) @ x
    return travel_deviation(plant, symbols, phi, x, time)


def ode_parameters(plant: Plant) -> dict[str, float]:
    """Name to SI value of every row of p in `ode`, in their order."""
    return dict(zip(parameter_names(plant), parameter_values(plant), strict=True))
