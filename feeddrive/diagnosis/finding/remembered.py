"""Results that a search comes back to, kept within so many bytes."""

from __future__ import annotations

from collections import Counter, OrderedDict
from collections.abc import Callable, Hashable, Sequence
from threading import Lock
from typing import Generic, TypeVar

from feeddrive.effects.base import Effect
from feeddrive.plant.plant import Plant

Value = TypeVar("Value")

ROOM = 256_000_000
"""Bytes kept in any case: 44 motions of the load side of a minute at 2 kHz. A fit comes back to the plant that it moves
away from, a round to what it began with; older ones are asked for by the way."""

LEAST = 4
"""Results kept of every source, however large: the plant as it is and as it is changed, for each of the two candidates
that are tried at the same time."""


class Remembered(Generic[Value]):
    """The latest results, by what they were made from; may be asked by several threads at once.

    A key holds its source, so that no other object can take its place while the result is kept.
    """

    def __init__(self, size_of: Callable[[Value], int], room: int = ROOM) -> None:
        """Remember nothing yet.

        Args:
            size_of: bytes of a result.
            room: bytes kept in any case.
        """
        self._size_of, self._room = size_of, room
        self._kept: OrderedDict[tuple[Hashable, Hashable], tuple[Value, int]] = OrderedDict()
        self._sources: Counter[Hashable] = Counter()
        self._least: dict[Hashable, int] = {}
        self._lock = Lock()
        self.size = 0

    def found(self, source: Hashable, values: Hashable, make: Callable[[], Value]) -> Value:
        """The result for a source and values, made if it is not there.

        Args:
            source: such as a motion, known by its identity.
            values: what else the result depends on.
            make: makes it; two threads that ask at once may both do so.
        """
        key = (source, values)
        with self._lock:
            if key in self._kept:
                self._kept.move_to_end(key)
                return self._kept[key][0]
        made = make()
        with self._lock:
            if key in self._kept:  # by another thread meanwhile
                return self._kept[key][0]
            size = self._size_of(made)
            self._kept[key] = made, size
            self._sources[source] += 1
            self._least[source] = LEAST * size
            self.size += size
            while self.size > max(self._room, sum(self._least.values())):
                self._forget_oldest()
        return made

    def _forget_oldest(self) -> None:
        (source, _), (_, size) = self._kept.popitem(last=False)
        self.size -= size
        self._sources[source] -= 1
        if not self._sources[source]:
            del self._sources[source], self._least[source]


def effects_key(effects: Sequence[Effect]) -> tuple[object, ...]:
    """What a prediction depends on of effects: names, places and values."""
    return tuple((e.name, str(e.port), e.place, tuple(e.values.items())) for e in effects)


def plant_key(plant: Plant, effects: Sequence[Effect]) -> tuple[object, ...]:
    """What tells a plant with some effects from another one: its chain, by kind and values, and the effects."""
    return plant.chain.key, tuple(plant.chain.values.items()), effects_key(effects)
