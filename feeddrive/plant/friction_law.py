"""The one friction law of a port, in which all friction effects there meet.

    F = (sum declared levels * factors + increments) * shape + factors * declared viscous + viscous increments

Declared friction carries level, viscous force and shape; the others act on it. Where a bristle is, it takes the place
of level times shape.
"""

from __future__ import annotations

from feeddrive.effects.base import BristleEffect, FrictionEffect, Motion, Port, SourceEffect
from feeddrive.plant.plant import Plant
from feeddrive.plant.symbols import Symbols
from feeddrive.typing import Expression


def resisting_force(
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
    declared = [effect for effect in effects if effect.declared]
    others = [effect for effect in effects if not effect.declared]
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
    shapes = [effect.shape(motion, symbols.effects[effect.label]) for effect in declared]
    for effect, shape in zip(declared, shapes, strict=True):
        force += _level_factor(others, motion, symbols) * effect.level(motion, symbols.effects[effect.label]) * shape
    if shapes:
        force += _level_increment(others, motion, symbols) * shapes[0]
    return force


def friction_level(plant: Plant, symbols: Symbols, port: Port, motion: Motion) -> Expression:
    """Coulomb level of a port [N, or N m at a shaft]: declared levels times factors, plus increments."""
    effects = _friction_effects(plant, port)
    others = [effect for effect in effects if not effect.declared]
    level: Expression = 0.0
    for effect in effects:
        if effect.declared:
            level += effect.level(motion, symbols.effects[effect.label])
    return level * _level_factor(others, motion, symbols) + _level_increment(others, motion, symbols)


def _friction_effects(plant: Plant, port: Port) -> list[FrictionEffect]:
    return [effect for effect in plant.effects if isinstance(effect, FrictionEffect) and effect.port == port]


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
