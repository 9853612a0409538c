"""The one friction law of a port, in which all friction effects there meet.

    F = (sum declared levels * factors + increments) * shape + factors * declared viscous + viscous increments

Declared friction carries level, viscous force and shape; the others act on it. Where a bristle is, it takes the place
of level times shape.
"""

from __future__ import annotations

from feeddrive.effects.base import BristleEffect, FrictionEffect, Motion, Port, SourceEffect
from feeddrive.plant.plant import Plant
from feeddrive.plant.structure import Symbols
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
    return force + source_force(plant, symbols, port, motion), rates


def friction_force(plant: Plant, symbols: Symbols, port: Port, motion: Motion) -> Expression:
    """Friction at a port that depends on the motion alone: all of it, or all but the Coulomb part where a bristle is.

    Positive when it resists + motion [N, or N m at a shaft].
    """
    force: Expression = 0.0
    for part in friction_parts(plant, symbols, port, motion).values():
        force += part
    return force


def friction_parts(plant: Plant, symbols: Symbols, port: Port, motion: Motion) -> dict[str, Expression]:
    """What each friction effect of a port has of `friction_force`, by label [N, or N m at a shaft].

    Declared friction has its own level and viscous force with the factors of the others, which have what they add.
    """
    effects = _friction_effects(plant, port)
    others = [effect for effect in effects if not effect.declared]
    factor: Expression = 1.0
    for effect in others:
        factor *= effect.viscous_factor(motion, symbols.effects[effect.label])
    parts: dict[str, Expression] = {}
    for effect in effects:
        viscous = effect.viscous(motion, symbols.effects[effect.label])
        parts[effect.label] = factor * viscous if effect.declared else viscous
    if any(isinstance(effect, BristleEffect) for effect in effects):
        return parts
    shapes = {
        effect.label: effect.shape(motion, symbols.effects[effect.label]) for effect in effects if effect.declared
    }
    for effect in effects:
        level = effect.level(motion, symbols.effects[effect.label])
        if effect.declared:
            parts[effect.label] += _level_factor(others, motion, symbols) * level * shapes[effect.label]
        elif shapes:
            parts[effect.label] += level * next(iter(shapes.values()))
    return parts


def bristle_energy(plant: Plant, symbols: Symbols, port: Port, z: Expression) -> Expression:
    """Energy in the bristle of a port [J]; 0 where none is."""
    energy: Expression = 0.0
    for effect in plant.effects:
        if isinstance(effect, BristleEffect) and effect.port == port:
            energy += effect.energy(z[0], symbols.effects[effect.label])
    return energy


def source_force(plant: Plant, symbols: Symbols, port: Port, motion: Motion) -> Expression:
    """Sum of the sources of a port, positive when it resists + motion [N, or N m at a shaft]."""
    force: Expression = 0.0
    for effect in plant.effects:
        if isinstance(effect, SourceEffect) and effect.port == port:
            force += effect.force(motion, symbols.effects[effect.label])
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
