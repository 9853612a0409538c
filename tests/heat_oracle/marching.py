"""Many explicit steps x' = s + A x, in C where a compiler is found, else by scipy's sparse product.

A is sparse and nearly constant along its diagonals, so that bands, one coefficient a row and offset, need no column
numbers: a step of 4400 nodes takes some microseconds. Sums are taken in another order than scipy takes them, so both
ways agree to rounding, not bit for bit.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np
import scipy.sparse as sparse

from feeddrive.compiler import compiled_library
from feeddrive.typing import Expression, FloatArray

_SOURCE = Path(__file__).with_name("explicit.c")


@dataclass(frozen=True, eq=False)
class Step:
    """One explicit step of n nodes at one place of the nut.

    Attributes:
        inner: A, (n, n) sparse [1].
        source: s, (n,) [K].
        leak: heat that a step takes to the air per rise of each node, (n,) [J/K].
        gained: heat that a step takes from the air at rise zero [J].
    """

    inner: Expression
    source: FloatArray
    leak: FloatArray
    gained: float


@dataclass(eq=False)
class Progressing:
    """State that a march changes: rises, (n,) [K], and the heat lost to the air so far [J]."""

    rises: FloatArray
    lost: float = 0.0


March = Callable[[int, int, Progressing, FloatArray | None], None]
"""(which step, how many times, state, sum of the states after each step or None); changes the state and the sum."""


def march_of(steps: Sequence[Step]) -> March:
    """How to take the steps: compiled where that is possible."""
    return compiled_march(steps) or interpreted_march(steps)


def interpreted_march(steps: Sequence[Step]) -> March:
    """By sparse products; the constant 1 and the heat lost ride along as two more states."""
    products = [_augmented(step) for step in steps]

    def march(which: int, count: int, at: Progressing, total: FloatArray | None) -> None:
        state, product = np.concatenate([at.rises, [1.0, at.lost]]), products[which]
        for _ in range(count):
            state = product @ state
            if total is not None:
                total += state[:-2]
        at.rises, at.lost = state[:-2], float(state[-1])

    return march


def compiled_march(steps: Sequence[Step]) -> March | None:
    """By the C of `explicit.c`; None where it cannot be compiled."""
    library = _library()
    if library is None:
        return None
    places = [_place(step) for step in steps]
    work = np.empty(len(steps[0].source))

    def march(which: int, count: int, at: Progressing, total: FloatArray | None) -> None:
        rises, lost = at.rises.copy(), ctypes.c_double(at.lost)
        sums = None if total is None else total.ctypes.data
        library.feeddrive_march(
            ctypes.byref(places[which][0]), count, rises.ctypes.data, work.ctypes.data, ctypes.byref(lost), sums
        )
        at.rises, at.lost = rises, lost.value

    return march


def _augmented(step: Step) -> Expression:
    """The step's matrix on (x, 1, heat lost)."""
    return sparse.block_array(
        [
            [step.inner, sparse.csr_array(step.source[:, None]), None],
            [None, np.ones((1, 1)), None],
            [sparse.csr_array(step.leak[None, :]), np.array([[-step.gained]]), np.ones((1, 1))],
        ]
    ).tocsr()


class _Band(ctypes.Structure):
    """`band` of explicit.c."""

    _fields_ = [
        ("offset", ctypes.c_longlong),
        ("first", ctypes.c_longlong),
        ("count", ctypes.c_longlong),
        ("value", ctypes.c_void_p),
    ]


class _Place(ctypes.Structure):
    """`place` of explicit.c."""

    _fields_ = [("nodes", ctypes.c_longlong), ("bands", ctypes.c_longlong), ("leaks", ctypes.c_longlong),
                ("band", ctypes.c_void_p), ("source", ctypes.c_void_p), ("leak_at", ctypes.c_void_p),
                ("leak", ctypes.c_void_p), ("gained", ctypes.c_double)]  # fmt: skip


@lru_cache(maxsize=1)
def _library() -> ctypes.CDLL | None:
    library = compiled_library(_SOURCE.read_text(encoding="utf-8"))
    if library is not None:
        library.feeddrive_march.argtypes = [ctypes.c_void_p, ctypes.c_longlong, *[ctypes.c_void_p] * 4]
        library.feeddrive_march.restype = None
    return library


def _place(step: Step) -> tuple[_Place, list[object]]:
    """The step as the C reads it, and the arrays that must live as long."""
    bands = bands_of(step.inner)
    table = (_Band * len(bands))(
        *[_Band(offset, first, len(values), values.ctypes.data) for offset, first, values in bands]
    )
    at = np.flatnonzero(step.leak).astype(np.int64)
    leak, source = step.leak[at].copy(), np.ascontiguousarray(step.source)
    place = _Place(len(source), len(bands), len(at), ctypes.addressof(table), source.ctypes.data, at.ctypes.data,
                   leak.ctypes.data, step.gained)  # fmt: skip
    return place, [bands, table, at, leak, source]


def bands_of(matrix: Expression) -> list[tuple[int, int, FloatArray]]:
    """A square sparse matrix by its diagonals: offset, first row and coefficients; the main one first, whole."""
    entries = matrix.tocoo()
    row, offset = entries.row.astype(np.int64), entries.col.astype(np.int64) - entries.row
    found = [(0, 0, np.asarray(matrix.diagonal(), dtype=float))]
    for one in np.unique(offset[(offset != 0) & (entries.data != 0)]):
        kept = (offset == one) & (entries.data != 0)
        first, last = int(row[kept].min()), int(row[kept].max())
        values = np.zeros(last - first + 1)
        np.add.at(values, row[kept] - first, entries.data[kept])
        found.append((int(one), first, values))
    return found
