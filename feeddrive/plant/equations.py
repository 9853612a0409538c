"""The one place where chain and effects become equations.

    M q'' + C q' + K q = B u + f(q, q', z, t),     z' = g(q, q', z, t)

f collects what is not linear elasticity or inertia: friction at table and screw, sources, and what the transmission
with its travel errors and free play does beyond the linear spring. Simulation, linearisation, fitting and export all
evaluate these expressions.

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
from collections.abc import Mapping
from dataclasses import dataclass

import casadi as ca

from feeddrive.effects.base import (
    BristleEffect,
    ChainEffect,
    Effect,
    FrictionEffect,
    Motion,
    Port,
    SourceEffect,
    TransmissionEffect,
    TravelEffect,
)
from feeddrive.effects.guide_friction import GuideFriction
from feeddrive.effects.shaft_drag import ShaftDrag
from feeddrive.plant.plant import Plant
from feeddrive.typing import Expression

CONTACT_SMOOTHING = 1e-9
"""Stretch over which the flank of a free play takes up its damper [m]; a tenth of a good scale's resolution."""


@dataclass(frozen=True)
class Symbols:
    """CasADi symbols of a plant's parameters.

    Attributes:
        chain: key of the chain to symbol, without chain effects.
        effects: effect label to (key to symbol).
        vector: all of them in one column, in the order of `names`.
        names: `key` for chain values, `label.key` for effects; tables take one name per entry, `label.key[i]`.
    """

    chain: dict[str, Expression]
    effects: dict[str, dict[str, Expression]]
    vector: Expression
    names: tuple[str, ...]


@dataclass(frozen=True)
class Forces:
    """Forces of effects as expressions.

    Attributes:
        on_coordinates: generalised force per coordinate of the chain, shape (n, 1) [N m or N].
        bristle_rates: z', shape (nz, 1) [m/s].
    """

    on_coordinates: Expression
    bristle_rates: Expression


def parameter_symbols(plant: Plant) -> Symbols:
    """Symbols for every parameter of the plant."""
    chain = {key: ca.SX.sym(key) for key in plant.chain.values}
    names = list(chain)
    effects: dict[str, dict[str, Expression]] = {}
    for effect in plant.effects:
        effects[effect.label] = {}
        for key, value in effect.values.items():
            length = len(value) if isinstance(value, tuple) else 1
            name = f"{effect.label}.{key}"
            effects[effect.label][key] = ca.SX.sym(name, length)
            names += [name] if length == 1 else [f"{name}[{i}]" for i in range(length)]
    columns = [*chain.values(), *(symbol for group in effects.values() for symbol in group.values())]
    return Symbols(chain, effects, ca.vertcat(*columns), tuple(names))


def parameter_values(plant: Plant) -> list[float]:
    """Values in the order of `Symbols.vector`, SI."""
    values = [float(value) for value in plant.chain.values.values()]
    for value in plant.effect_values().values():
        values += list(value) if isinstance(value, tuple) else [float(value)]
    return values


def chain_symbols(plant: Plant, symbols: Symbols) -> dict[str, Expression]:
    """Chain values with the chain effects in."""
    chain = dict(symbols.chain)
    for effect in plant.effects:
        if isinstance(effect, ChainEffect):
            chain = effect.chain(chain, symbols.effects[effect.label])
    return chain


def bristle_count(plant: Plant) -> int:
    """Number of bristle states."""
    return len(plant.effects_of(BristleEffect))


def effect_forces(
    plant: Plant, symbols: Symbols, q: Expression, rate: Expression, z: Expression, time: Expression
) -> Forces:
    """Generalised forces of all effects, and the rates of their states.

    Args:
        plant: which effects there are; their values come from `symbols`.
        symbols: parameters.
        q: coordinates, shape (n, 1).
        rate: their rates, shape (n, 1).
        z: bristle deflections, shape (nz, 1) [m].
        time: [s] from the start.

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
    for port, row in rows.items():
        motion = Motion(ca.mtimes(row, q), ca.mtimes(row, rate), time)
        force, port_rates = _friction_and_sources(plant, symbols, port, motion, z)
        total -= row.T * force
        rates += port_rates
    if plant.chain.elastic:
        total += _transmission_beyond_linear(plant, symbols, p, q, rate, time)
    return Forces(total, ca.vertcat(*rates) if rates else ca.SX.zeros(0, 1))


def _friction_and_sources(
    plant: Plant, symbols: Symbols, port: Port, motion: Motion, z: Expression
) -> tuple[Expression, list[Expression]]:
    """Resisting force at one port and the rates of its bristle: the one friction law, plus the sources."""
    force: Expression = friction_force(plant, symbols, port, motion)
    rates: list[Expression] = []
    bristle = next((e for e in plant.effects if isinstance(e, BristleEffect) and e.port == port), None)
    if bristle is not None:
        values = symbols.effects[bristle.label]
        level = friction_level(plant, symbols, port, motion)
        rates = [bristle.deflection_rate(z[0], motion, level, values)]
        force += bristle.force(z[0], rates[0], motion, level, values)
    for effect in plant.effects:
        if isinstance(effect, SourceEffect) and effect.port == port:
            force += effect.force(motion, symbols.effects[effect.label])
    return force, rates


def friction_force(plant: Plant, symbols: Symbols, port: Port, motion: Motion) -> Expression:
    """Friction at a port that depends on the motion alone: all of it, or all but the Coulomb part where a bristle is.

    Positive when it resists + motion [N, or N m at a shaft].
    """
    effects = _friction_effects(plant, port)
    declared = [effect for effect in effects if _is_declared(effect)]
    others = [effect for effect in effects if not _is_declared(effect)]
    factor: Expression = 1.0
    for effect in others:
        factor *= effect.viscous_factor(motion, symbols.effects[effect.label])
    force: Expression = 0.0
    for effect in declared:
        force += factor * effect.viscous(motion, symbols.effects[effect.label])
    for effect in others:
        force += effect.viscous(motion, symbols.effects[effect.label])
    if any(isinstance(effect, BristleEffect) for effect in effects):
        return force
    shapes = [_shape(effect, motion, symbols) for effect in declared]
    for effect, shape in zip(declared, shapes, strict=True):
        force += _level_factor(others, motion, symbols) * effect.level(motion, symbols.effects[effect.label]) * shape
    if shapes:
        force += _level_increment(others, motion, symbols) * shapes[0]
    return force


def friction_level(plant: Plant, symbols: Symbols, port: Port, motion: Motion) -> Expression:
    """Coulomb level of a port [N, or N m at a shaft]: declared levels times factors, plus increments."""
    effects = _friction_effects(plant, port)
    others = [effect for effect in effects if not _is_declared(effect)]
    level: Expression = 0.0
    for effect in effects:
        if _is_declared(effect):
            level += effect.level(motion, symbols.effects[effect.label])
    return level * _level_factor(others, motion, symbols) + _level_increment(others, motion, symbols)


def _friction_effects(plant: Plant, port: Port) -> list[FrictionEffect]:
    return [effect for effect in plant.effects if isinstance(effect, FrictionEffect) and effect.port == port]


def _is_declared(effect: Effect) -> bool:
    """Whether the effect carries a level of its own, to which factors and increments of others apply."""
    return isinstance(effect, GuideFriction | ShaftDrag)


def _shape(effect: FrictionEffect, motion: Motion, symbols: Symbols) -> Expression:
    values = symbols.effects[effect.label]
    width = values["smoothing_velocity"] if isinstance(effect, GuideFriction) else values["smoothing_speed"]
    return ca.tanh(motion.velocity / width)


def _level_factor(effects: list[FrictionEffect], motion: Motion, symbols: Symbols) -> Expression:
    factor: Expression = 1.0
    for effect in effects:
        factor *= effect.level_factor(motion, symbols.effects[effect.label])
    return factor


def _level_increment(effects: list[FrictionEffect], motion: Motion, symbols: Symbols) -> Expression:
    increment: Expression = 0.0
    for effect in effects:
        increment += effect.level(motion, symbols.effects[effect.label])
    return increment


def _transmission_beyond_linear(
    plant: Plant, symbols: Symbols, p: Mapping[str, Expression], q: Expression, rate: Expression, time: Expression
) -> Expression:
    """What the transmission does beyond k (r phi - x) + c (r phi' - x'), on the coordinates [theta, phi, x].

    The travel deviation delta(phi) enters the stretch; by virtual work its reaction on the screw is
    F (r + d delta/d phi).
    """
    if not plant.has_travel and not plant.effects_of(TransmissionEffect):
        return ca.SX.zeros(3, 1)
    r = p["lead"] / (2 * math.pi)
    linear_stretch, linear_rate = r * q[1] - q[2], r * rate[1] - rate[2]
    delta, slope_angle, slope_position = _travel(plant, symbols, q, time)
    stretch = linear_stretch + delta
    stretch_rate = linear_rate + slope_angle * rate[1] + slope_position * rate[2]
    force = spring_force(plant, symbols, p, stretch, stretch_rate)
    linear = p["axial_stiffness"] * linear_stretch + p["axial_damping"] * linear_rate
    return ca.vertcat(0, -(r + slope_angle) * force + r * linear, (1 - slope_position) * force - linear)


def _travel(
    plant: Plant, symbols: Symbols, q: Expression, time: Expression
) -> tuple[Expression, Expression, Expression]:
    """delta [m] and its slopes with screw angle [m/rad] and table position [1]."""
    phi, x = ca.SX.sym("phi"), ca.SX.sym("x")
    delta = travel_deviation(plant, symbols, phi, x, time)
    parts = [delta, ca.jacobian(delta, phi), ca.jacobian(delta, x)]
    at = ca.substitute(parts, [phi, x], [q[1], q[2]])
    return at[0], at[1], at[2]


def travel_deviation(plant: Plant, symbols: Symbols, phi: Expression, x: Expression, time: Expression) -> Expression:
    """Sum of the travel deviations [m] at screw angle phi [rad] and table position x [m]."""
    delta = ca.SX(0)
    for effect in plant.effects:
        if isinstance(effect, TravelEffect):
            delta += effect.travel(phi, x, time, symbols.effects[effect.label])
    return delta


def spring_force(
    plant: Plant, symbols: Symbols, p: Mapping[str, Expression], stretch: Expression, rate: Expression
) -> Expression:
    """The one spring law of the transmission [N] at nut stretch [m] and its rate [m/s]; free plays add."""
    play: Expression = 0.0
    gaps = [effect for effect in plant.effects if isinstance(effect, TransmissionEffect)]
    for effect in gaps:
        play += effect.free_play(symbols.effects[effect.label])
    if not gaps:
        return p["axial_stiffness"] * stretch + p["axial_damping"] * rate
    beyond = ca.fabs(stretch) - 0.5 * play
    contact = ca.fmin(ca.fmax(beyond / CONTACT_SMOOTHING, 0), 1)
    return p["axial_stiffness"] * ca.sign(stretch) * ca.fmax(beyond, 0) + contact * p["axial_damping"] * rate
