"""The one place where chain and effects become equations.

    M q'' + C q' + K q = B u + f(q, q', z, t),     z' = g(q, q', z, t)

f collects what is not linear elasticity or inertia: friction at table and screw, sources, and what the transmission
with its travel errors and free play does beyond the linear spring. Simulation, linearisation, fitting and export all
evaluate these expressions. Where the chain depends on the table position, M, C and K are those of a reference position,
and f holds what the springs do beyond it (see `feeddrive.plant.chain.varying_chain`).

| symbol | meaning | unit |
|---|---|---|
| q, q' | coordinates of the chain and their rates | rad, m, and per second |
| z | bristle deflections | m |
| e | nut stretch r phi + delta - x | m |
| F | force of the transmission on the table | N |
| u | motor torque, cutting force on the table | N m, N |
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import casadi as ca

from feeddrive.effects.base import BristleEffect, Motion, Port
from feeddrive.plant.chain.varying_chain import force_beyond_reference
from feeddrive.plant.friction_law import friction_force, friction_level, resisting_force
from feeddrive.plant.plant import Plant
from feeddrive.plant.symbols import Symbols, chain_symbols, parameter_names, parameter_symbols, parameter_values
from feeddrive.plant.transmission_law import nut_force, travel_deviation
from feeddrive.typing import Expression

__all__ = [
    "Forces",
    "Symbols",
    "bristle_count",
    "chain_symbols",
    "effect_forces",
    "friction_force",
    "friction_level",
    "parameter_names",
    "parameter_symbols",
    "parameter_values",
    "transmitted_force",
    "travel_deviation",
]


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
        motion = Motion(ca.mtimes(row, q), ca.mtimes(row, rate), time, at_nut, p["lead"] / (2 * math.pi))
        force, port_rates = resisting_force(plant, symbols, port, motion, z)
        total -= row.T * force
        rates += port_rates
    return Forces(total, ca.vertcat(*rates) if rates else ca.SX.zeros(0, 1), transmitted)


def transmitted_force(plant: Plant, symbols: Symbols, q: Expression, rate: Expression, time: Expression) -> Expression:
    """F of the nut on the table [N], travel errors and free play included; for an elastic structure."""
    p = chain_symbols(plant, symbols)
    rows = (ca.horzcat(*plant.chain.screw(p)), ca.horzcat(*plant.chain.table(p)))
    return nut_force(plant, symbols, plant.chain.nut(p), rows, q, rate, time).force
