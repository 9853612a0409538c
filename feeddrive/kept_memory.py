"""Memory that is given back is kept for what comes next: a diagnosis fills and leaves the same megabytes all the time.

The GNU C library returns every large array to the system when it is left, and the system clears each page anew when it
is asked for again: an eighth of a short diagnosis. Threads that each keep memory of their own would keep twice as much.
"""

from __future__ import annotations

import ctypes

_TRIM_THRESHOLD, _MMAP_THRESHOLD, _ARENA_MAX = -1, -3, -8
"""Numbers of the options in the library's malloc.h."""

KEPT = 1 << 30
"""Bytes at the end of the heap beyond which memory goes back to the system."""

LARGE = 1 << 22
"""Bytes from which an array has pages of its own, which go back when it is left: few are as large, and kept they would
stand in each other's way. Tables of which little is used have pages that nobody asks for."""


def keep_freed_memory() -> None:
    """For this process from now on; nothing where the C library is another one. To be called before threads begin."""
    try:
        mallopt = ctypes.CDLL(None).mallopt
    except (AttributeError, OSError, TypeError):
        return
    for option, value in ((_ARENA_MAX, 1), (_MMAP_THRESHOLD, LARGE), (_TRIM_THRESHOLD, KEPT)):
        mallopt(option, value)
