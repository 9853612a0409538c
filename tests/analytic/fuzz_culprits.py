"""A fuzz module whose cases break the promise of the command line, each in its own way, for the test of the harness."""

from __future__ import annotations

import itertools
import os
import random
import sys
import time
import warnings
from collections.abc import Callable
from pathlib import Path

from feeddrive.errors import InputError
from tests.fuzz.harness import Attempt

LONGEST, MOST_MEMORY = 1.0, 100_000_000


def attempt(generator: random.Random, folder: Path) -> Attempt:
    """Return one culprit, drawn by the generator."""
    name = generator.choice(list(CULPRITS))
    return Attempt(name, CULPRITS[name])


def _raised(error: BaseException) -> Callable[[], object]:
    def run() -> object:
        raise error

    return run


def _two_lines() -> int:
    print("error: one\nerror: two", file=sys.stderr)
    return 2


def _hidden() -> int:
    print("error: \x1b[31m", file=sys.stderr)
    return 2


def _long() -> int:
    print("error: " + "x" * 300_000, file=sys.stderr)
    return 2


def _hang() -> None:
    for _ in itertools.count():
        pass


CULPRITS: dict[str, Callable[[], object]] = {
    "answers": lambda: 0,
    "refuses": _raised(InputError("no number", "a.csv", "write one")),
    "hangs": _hang,
    "waits": lambda: time.sleep(600),
    "dies": lambda: os._exit(9),
    "raises": _raised(ZeroDivisionError("division by zero")),
    "exits": _raised(SystemExit(1)),
    "swallows": lambda: len(bytearray(200_000_000)) and 0,
    "wants_all": lambda: bytearray(10**12),
    "warns": lambda: warnings.warn("overflow", RuntimeWarning, stacklevel=1),
    "two_lines": _two_lines,
    "hidden": _hidden,
    "long": _long,
    "other_status": lambda: 1,
}
