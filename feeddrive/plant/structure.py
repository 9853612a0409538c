"""Made once per structure: plants that differ in values alone share their equations and their compiled loop."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import lru_cache
from typing import TypeVar, TypeVarTuple

import casadi as ca

from feeddrive.effects.base import Effect
from feeddrive.plant.plant import Plant
from feeddrive.plant.symbols import Symbols
from feeddrive.symbolic_turn import SYMBOLS, Holder

Options = TypeVarTuple("Options")
Machine = TypeVar("Machine")


_CACHES: list[Callable[[], None]] = []


def per_structure(build: Callable[[Plant, *Options], Machine]) -> Callable[[Plant, *Options], Machine]:
    """`build`, run once per structure of plant and further options; it must not use the plant's values.

    Args:
        build: maker of equations or of what runs them, from a plant and hashable options.

    Returns:
        The same maker with a memory.
    """

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
