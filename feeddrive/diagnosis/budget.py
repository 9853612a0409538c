"""Time that a diagnosis may take, and what is left out where it is spent.

Whoever is about to do what may be left out asks; what is under way ends with the best that it has. Nothing depends on
the clock where no time is given.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from threading import Lock

SEARCH = 0.5
"""Share of the time in which effects are searched. What is under way ends after it, and the questions to what was found
take as long as a round or two of the search."""

DOUBTS = 0.75
"""Share of the time after which no further question is asked: what is under way ends, and judging and the report take
some seconds of a minute."""


class Budget:
    """A time, and what was left out when it was spent; may be asked by several threads at once."""

    def __init__(self, seconds: float = math.inf, clock: Callable[[], float] = time.monotonic) -> None:
        """Begin now.

        Args:
            seconds: that the diagnosis may take; infinite for as long as it takes.
            clock: tells the time [s].
        """
        self.seconds = seconds
        self._clock, self._began, self._share, self._lock = clock, clock(), SEARCH, Lock()
        self._untried: dict[str, list[str]] = {}

    @property
    def is_spent(self) -> bool:
        """Whether nothing more may be begun."""
        return self._clock() - self._began > self._share * self.seconds

    def end_of_search(self) -> None:
        """From now on the time that was kept for questions to what was found may be used."""
        self._share = DOUBTS

    def skips(self, what: str, name: str = "") -> bool:
        """Whether something is to be left out; it is then noted.

        Args:
            what: is left out, such as "which other names do as well".
            name: of one of several.
        """
        if not self.is_spent:
            return False
        with self._lock:
            names = self._untried.setdefault(what, [])
            if name and name not in names:
                names.append(name)
        return True

    @property
    def sentence(self) -> str:
        """What was left out; empty where nothing was."""
        left = [f"{what}: {', '.join(sorted(names))}" if names else what for what, names in self._untried.items()]
        return f"Not all was tried within {self.seconds:g} s. Left out: {'; '.join(left)}." if left else ""
