"""Made once per structure: plants that differ in values alone share their equations and their compiled loop.

Symbols of a plant's parameters, and their values in the same order.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import TypeVar, TypeVarTuple

import casadi as ca

from feeddrive.effects.base import ChainEffect, Effect
from feeddrive.plant.plant import Plant
from feeddrive.symbolic_turn import SYMBOLS, Holder
from feeddrive.typing import Expression


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


def parameter_symbols(plant: Plant) -> Symbols:
    """Symbols for every parameter of the plant."""
    chain = {key: ca.SX.sym(key) for key in plant.chain.values}
    effects: dict[str, dict[str, Expression]] = {}
    for effect in plant.motion_effects:
        effects[effect.label] = {}
        for key, value in effect.values.items():
            effects[effect.label][key] = ca.SX.sym(f"{effect.label}.{key}", _length(value))
    columns = [*chain.values(), *(symbol for group in effects.values() for symbol in group.values())]
    return Symbols(chain, effects, ca.vertcat(*columns), parameter_names(plant))


def parameter_names(plant: Plant) -> tuple[str, ...]:
    """Names in the order of `Symbols.vector`, for who needs no symbols."""
    names = list(plant.chain.values)
    for effect in plant.motion_effects:
        for key, value in effect.values.items():
            name, length = f"{effect.label}.{key}", _length(value)
            names += [name] if length == 1 else [f"{name}[{i}]" for i in range(length)]
    return tuple(names)


def _length(value: float | tuple[float, ...]) -> int:
    return len(value) if isinstance(value, tuple) else 1


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


Options = TypeVarTuple("Options")
Machine = TypeVar("Machine")


_CACHES: list[Callable[[], None]] = []


def per_structure(build: Callable[[Plant, *Options], Machine]) -> Callable[[Plant, *Options], Machine]:
    """`build`, run once per structure of plant and further hashable options; it must not use the plant's values."""

    @lru_cache(maxsize=256)
    def cached(key: tuple[object, ...], holder: Holder[Plant], options: tuple[*Options]) -> Machine:
        with SYMBOLS.taken():
            return build(holder.held, *options)

    _CACHES.append(cached.cache_clear)

    def machine(plant: Plant, *options: *Options) -> Machine:
        return cached(structure_key(plant), Holder(plant), options)

    return machine


def forget_machines() -> None:
    """Make all of them anew at their next use, for instance because another compiler is to be used."""
    for forget in _CACHES:
        forget()


def structure_key(plant: Plant) -> tuple[object, ...]:
    """What makes two plants the same equations: chain; per effect name, port, place, table lengths, parts left out.

    The order of the values is part of it, since it is that of the columns which the equations read.
    """
    return (plant.chain.key, tuple(plant.chain.values), *(_effect_key(effect) for effect in plant.motion_effects))


def _effect_key(effect: Effect) -> tuple[object, ...]:
    lengths = tuple(len(value) if isinstance(value, tuple) else 1 for value in effect.values.values())
    place = (str(effect.port), effect.place)
    return (effect.name, place, effect.label, tuple(effect.values), lengths, left_out(effect))


def left_out(effect: Effect) -> tuple[str, ...]:
    """Keys of an effect that may be left out, and are: their value is the default, 0."""
    return tuple(
        p.key for p in effect.parameters if p.default == 0.0 and not p.table and effect.values.get(p.key) == 0.0
    )


def without_left_out(plant: Plant, symbols: Symbols) -> Symbols:
    """The symbols with a plain 0 for what is left out, so that nothing is computed for it; the vector stays."""
    effects = {
        effect.label: {**symbols.effects[effect.label], **dict.fromkeys(left_out(effect), ca.SX(0))}
        for effect in plant.motion_effects
    }
    return replace(symbols, effects=effects)
