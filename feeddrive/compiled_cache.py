"""Compiled libraries that are kept between runs: what is old or too much is deleted, and nothing that is in use.

A library is marked as used before it is loaded, and what was used within a day is never deleted, however much there is.
So whoever has just found a library still finds it when loading it; should it be gone all the same, it is made again. On
Linux and macOS a library that is loaded outlives its file, Windows does not let it be deleted.
"""

from __future__ import annotations

import shutil
import time
from collections.abc import Iterator
from contextlib import suppress
from functools import lru_cache
from pathlib import Path

DAY = 86400.0

IN_USE = DAY
"""Time after its last use in which a library is kept in any case [s]: longer than a search or a sweep goes on."""

LONGEST_UNUSED = 90 * DAY
"""Time without use after which a library is deleted [s]."""

MOST_BYTES = 100_000_000
"""Bytes of all libraries, beyond which those that were not used for longest are deleted: some 4000 machines of 25 kB,
ten times as many as all tests of this project make."""


def used(library: Path) -> bool:
    """Mark a library as used now; whether it is there."""
    if not library.exists():
        return False
    with suppress(OSError):  # a folder that can be read alone is not pruned by this person either
        library.touch()
    return library.exists()


@lru_cache(maxsize=8)
def prune_once(folder: Path) -> None:
    """Prune a folder, the first time that this process asks for it."""
    prune(folder, time.time())


def prune(folder: Path, now: float) -> None:
    """Delete libraries that are old or too much, and what processes have left that were ended while they compiled.

    Args:
        folder: of the libraries.
        now: present time [s since 1970].
    """
    for left in folder.glob("tmp*"):
        if left.is_dir() and now - (_last_used(left) or now) > IN_USE:
            shutil.rmtree(left, ignore_errors=True)
    total = 0
    for last_used, size, library in sorted(_libraries(folder), reverse=True):  # the latest first
        total += size
        unused = now - last_used
        # asked again just before: another process may have marked it since
        if (unused > LONGEST_UNUSED or (total > MOST_BYTES and unused > IN_USE)) and _last_used(library) == last_used:
            with suppress(OSError):
                library.unlink()


def _libraries(folder: Path) -> Iterator[tuple[float, int, Path]]:
    """Last use, bytes and path of every library."""
    for library in folder.glob("*.so"):
        with suppress(OSError):  # another process prunes, too
            status = library.stat()
            yield status.st_mtime, status.st_size, library


def _last_used(path: Path) -> float | None:
    try:
        return path.stat().st_mtime
    except OSError:
        return None
