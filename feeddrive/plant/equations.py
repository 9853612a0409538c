"""The one place where chain and effects become equations.

    M q'' + C q' + K q = B u + f(q, q', z, t),     z' = g(q, q', z, t)

f collects what is not linear elasticity or inertia: friction at table and screw, sources, and what the transmission
with its travel errors and free play does beyond the linear spring. Simulation, linearisation, fitting and export all
evaluate these expressions. Where the chain depends on the table position, M, C and K are those of a reference position,
and f holds what the springs do beyond it (see `feeddrive.plant.equations`).

| symbol | meaning | unit |
|---|---|---|
| q, q' | coordinates of the chain and their rates | rad, m, and per second |
| z | bristle deflections | m |
| e | nut stretch r phi + delta - x | m |
| F | force of the transmission on the table | N |
| u | motor torque, cutting force on the table | N m, N |

What a chain whose springs depend on the table position x does beyond the chain frozen at a reference x_ref.

    V(q) = 1/2 sum_i k_i(x) s_i^2,     f = -dV/dq - sum_i w_i' c_i(x) s_i'  beyond  -K(x_ref) q - C(x_ref) q':

    f = -sum_i w_i' [ (k_i(x) - k_i(x_ref)) s_i + (c_i(x) - c_i(x_ref)) s_i' ] - L_x' 1/2 sum_i k_i'(x) s_i^2

which is -(K(x) - K(x_ref)) q - (C(x) - C(x_ref)) q' and, on the table, -1/2 q' K'(x) q. The last term is what a
spring that softens along the stroke gives back to the table as it moves there; without it energy is not kept. It is
small: at 10 kN and 330 N/µm (40 mm, 0.5 m) it is 0.2 N. Written with stretches and not with matrices, since q holds
angles of thousands of radians and the stretches are microns.

The nut's own spring is the same everywhere; the law of the transmission has it.

| symbol | meaning | unit |
|---|---|---|
| w_i, s_i = w_i q | row and stretch of spring i | m, or rad |
| k_i, c_i | stiffness and damping of spring i with the table at x | N/m, N s/m, or N m/rad, N m s/rad |
| L_x | row of the table position | 1 |
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import casadi as ca

from feeddrive.effects.base import BristleEffect, Motion, Port
from feeddrive.plant.chain.linear_chain import Chain, Spring, Values
from feeddrive.plant.friction_law import resisting_force
from feeddrive.plant.plant import Plant
from feeddrive.plant.structure import Symbols, chain_symbols
from feeddrive.plant.transmission_law import nut_force
from feeddrive.typing import Expression


@dataclass(frozen=True)
class Forces:
    """Forces of effects as expressions.

    Attributes:
        on_coordinates: generalised force per coordinate of the chain, shape (n, 1) [N m or N].
        bristle_rates: z', shape (nz, 1) [m/s].
        transmitted: F of the nut on the table [N]; 0 where the structure is rigid.
    """

    on_coordinates: Expression
    bristle_rates: Expression
    transmitted: Expression


def bristle_count(plant: Plant) -> int:
    """Number of bristle states."""
    return len(plant.effects_of(BristleEffect))


def effect_forces(
    plant: Plant,
    symbols: Symbols,
    q: Expression,
    rate: Expression,
    z: Expression,
    time: Expression,
    reference: Expression | None = 0.0,
) -> Forces:
    """Generalised forces of all effects, and the rates of their states.

    Args:
        plant: which effects there are; their values come from `symbols`.
        symbols: parameters.
        q: coordinates, shape (n, 1).
        rate: their rates, shape (n, 1).
        z: bristle deflections, shape (nz, 1) [m].
        time: [s] from the start.
        reference: table position of the caller's K and C [m], or None where they follow the table; without meaning
            for a chain that does not vary.

    Returns:
        Forces and bristle rates.
    """
    p = chain_symbols(plant, symbols)
    rows = {
        Port.MOTOR: ca.horzcat(*plant.chain.motor(p)),
        Port.SCREW: ca.horzcat(*plant.chain.screw(p)),
        Port.TABLE: ca.horzcat(*plant.chain.table(p)),
    }
    total = ca.SX.zeros(len(plant.chain.coordinates), 1)
    rates: list[Expression] = []
    transmitted: Expression = 0.0
    if plant.chain.elastic:
        nut = nut_force(plant, symbols, plant.chain.nut(p), (rows[Port.SCREW], rows[Port.TABLE]), q, rate, time)
        total += nut.beyond_linear + force_beyond_reference(plant.chain, p, q, rate, reference)
        transmitted = nut.force
    for port, row in rows.items():
        at_nut = transmitted if port in (Port.SCREW, Port.TABLE) else 0.0
        mass = plant.chain.moving_mass(p) if port is Port.TABLE else 0.0
        motion = Motion(ca.mtimes(row, q), ca.mtimes(row, rate), time, at_nut, p["lead"] / (2 * math.pi), mass)
        force, port_rates = resisting_force(plant, symbols, port, motion, z)
        total -= row.T * force
        rates += port_rates
    return Forces(total, ca.vertcat(*rates) if rates else ca.SX.zeros(0, 1), transmitted)


def force_beyond_reference(
    chain: Chain, p: Values, q: Expression, rate: Expression, reference: Expression | None
) -> Expression:
    """Generalised force beyond the chain frozen at `reference`, shape (n, 1) [N or N m].

    Args:
        chain: the chain; zero is returned where it does not vary.
        p: its values.
        q, rate: coordinates and rates, shape (n, 1).
        reference: table position at which the caller's K and C are frozen [m]; None where they follow the table, so
            that only the term on the table is left.
    """
    force = ca.SX.zeros(len(chain.coordinates), 1)
    if not chain.varies:
        return force
    table = ca.horzcat(*chain.table(p))
    x = ca.mtimes(table, q)
    at = ca.SX.sym("position")
    for spring in chain.springs(p, at):
        if not ca.depends_on(ca.SX(spring.stiffness), at):
            continue
        row = ca.horzcat(*spring.row)
        stretch = ca.mtimes(row, q)
        slope = ca.substitute(ca.jacobian(spring.stiffness, at), at, x)
        force -= table.T * (0.5 * slope * stretch * stretch)
        if reference is not None:
            force -= row.T * _beyond(spring, at, x, reference, stretch, ca.mtimes(row, rate))
    return force


def _beyond(
    spring: Spring, at: Expression, x: Expression, reference: Expression, stretch: Expression, rate: Expression
) -> Expression:
    """Force of the spring at x beyond its force at the reference [N or N m]."""
    parts = [ca.SX(spring.stiffness), ca.SX(spring.damping)]
    k, c = (
        here - there
        for here, there in zip(
            ca.substitute(parts, [at], [x]), ca.substitute(parts, [at], [ca.SX(reference)]), strict=True
        )
    )
    return k * stretch + c * rate
