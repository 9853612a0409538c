"""Symbols of a plant's parameters, and their values in the same order."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from feeddrive.effects.base import ChainEffect
from feeddrive.plant.plant import Plant
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
