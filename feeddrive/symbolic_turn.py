"""Whose turn it is to make expressions: CasADi's symbols crash, once in thousands of times, where two threads do.

A search tries two effects at once, and both may need equations that were not made yet.
"""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Generic, TypeVar

Held = TypeVar("Held")


class SymbolicTurn:
    """A lock that its holder may take again, and may lay down for work that needs no symbols."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._holder = 0
        self._depth = 0

    @property
    def mine(self) -> bool:
        """Whether this thread has the turn."""
        return self._holder == threading.get_ident()

    @contextmanager
    def taken(self) -> Iterator[None]:
        """Alone with the symbols."""
        if not self.mine:
            self._take(1)
        else:
            self._depth += 1
        try:
            yield
        finally:
            self._depth -= 1
            if not self._depth:
                self._give_back()

    @contextmanager
    def laid_down(self) -> Iterator[None]:
        """Another may have its turn meanwhile, such as while a compiler runs; nothing where it is not held."""
        if not self.mine:
            yield
            return
        depth, self._depth = self._depth, 0
        self._give_back()
        try:
            yield
        finally:
            self._take(depth)

    def _take(self, depth: int) -> None:
        self._lock.acquire()
        self._holder, self._depth = threading.get_ident(), depth

    def _give_back(self) -> None:
        self._holder = 0
        self._lock.release()


SYMBOLS = SymbolicTurn()
"""The one turn of this process."""


class Holder(Generic[Held]):
    """Carries what expressions are made from past a cache whose key is its structure alone."""

    def __init__(self, held: Held) -> None:
        self.held = held

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Holder)

    def __hash__(self) -> int:
        return 0
