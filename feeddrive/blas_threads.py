"""One thread for linear algebra: results that do not depend on how many processors there are, and no slower ones.

Sums over several threads are taken in another order, and a search of many steps makes of the last digit another figure.
On matrices as small as these several threads are slower than one, too.
"""

from __future__ import annotations

import ctypes
import os
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import lru_cache
from importlib.util import find_spec
from pathlib import Path

VARIABLES = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS", "VECLIB_MAXIMUM_THREADS")
"""Environment from which libraries for linear algebra read their number of threads when they are loaded."""

Get = Callable[[], int]
Set = Callable[[int], None]

_lock = threading.Lock()
_within = 0
_before: list[int] = []


def one_thread_from_now_on() -> None:
    """For this process and those that it starts; numpy must not be imported yet."""
    os.environ.update(dict.fromkeys(VARIABLES, "1"))


@contextmanager
def one_thread() -> Iterator[None]:
    """One thread while this holds, where numpy and scipy are those of the Python package index; also a decorator.

    They bring OpenBLAS with them, whose number of threads is that of the whole process: what its other threads compute
    meanwhile has one, too. A numpy with another library, such as MKL, keeps the number of its environment.
    """
    global _within
    with _lock:
        if not _within:
            _before[:] = [get() for get, _ in _libraries()]
            for _, put in _libraries():
                put(1)
        _within += 1
    try:
        yield
    finally:
        with _lock:
            _within -= 1
            if not _within:
                for (_, put), count in zip(_libraries(), _before, strict=True):
                    put(count)


@lru_cache(maxsize=1)
def _libraries() -> tuple[tuple[Get, Set], ...]:
    """How many threads every OpenBLAS of numpy and scipy takes, read and set."""
    found = []
    for file in _files():
        try:
            library = ctypes.CDLL(str(file))  # the one that is loaded: files are loaded once
        except OSError:
            continue
        for suffix in ("64_", ""):  # of integers of 8 bytes, and of 4
            get, put = (getattr(library, f"scipy_openblas_{verb}_num_threads{suffix}", None) for verb in ("get", "set"))
            if get is not None and put is not None:
                get.restype, put.restype, put.argtypes = ctypes.c_int, None, [ctypes.c_int]
                found.append((get, put))
    return tuple(found)


def _files() -> list[Path]:
    """Libraries that lie in or beside the packages: Linux and Windows beside, macOS in them."""
    files: list[Path] = []
    for package in ("numpy", "scipy"):
        spec = find_spec(package)
        for place in (spec.submodule_search_locations if spec is not None else None) or ():
            folders = (Path(place).parent / f"{package}.libs", Path(place) / ".dylibs")
            files += sorted(file for folder in folders for file in folder.glob("*openblas*"))
    return files
