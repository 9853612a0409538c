"""Samples that a slow bus held in a fast file: a channel that changes only every k-th row.

Read as they stand they are a staircase, late by half its step on average, and their derivative is a comb. So the
channel is read at its updates alone, with their times.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from feeddrive.recording.traces.trace import Signal

_FEWEST = 30  # updates; fewer can stand k rows apart by chance
_REGULAR = 0.8  # of the steps between changes; an update that brings the same value doubles one
_STEPS = 5  # different sizes of change; an encoder that moves evenly steps by one count in even times


def held_rows(signal: Signal) -> int:
    """Return every how many rows a signal is updated; 1 where it is in every row or nothing tells."""
    changes = np.flatnonzero(np.diff(signal.values) != 0.0) + 1
    if changes.size < _FEWEST:
        return 1
    between = np.diff(changes)
    counts = np.bincount(between[between <= 1000], minlength=2)
    rows = int(np.argmax(counts))
    if rows < 2 or counts[rows] < _REGULAR * between.size or int(between.min()) < rows:
        return 1
    if np.any(between % rows):  # out of step: a clock of its own, and no grid of rows
        return 1
    sizes = np.abs(np.diff(signal.values)[changes - 1])
    distinct = np.unique(np.round(sizes / float(np.max(sizes)), 6)).size
    return rows if distinct >= _STEPS else 1


def at_updates(signal: Signal) -> tuple[Signal, str]:
    """Return a signal at its updates alone, and a note; the signal itself and nothing where none is held."""
    rows = held_rows(signal)
    if rows == 1:
        return signal, ""
    first = int(np.flatnonzero(np.diff(signal.values) != 0.0)[0] + 1) % rows
    kept = slice(first, None, rows)
    every = f"{rows} rows, {rows * signal.step * 1e3:.6g} ms"
    note = f"{signal.name} is updated every {every}: held samples of a slow bus; read at its updates"
    return replace(signal, time=signal.time[kept], values=signal.values[kept]), note
