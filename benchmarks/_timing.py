"""Ratios of processor time from interleaved calls: what else runs on the machine then weighs on both alike."""

from __future__ import annotations

import time
from collections.abc import Callable

import numpy as np


def interleaved(calls: dict[str, Callable[[], object]], rounds: int = 15, warm: bool = True) -> dict[str, list[float]]:
    """Processor times of each call [s], one a round; all are called in turn.

    Args:
        calls: name to call.
        rounds: how often.
        warm: call all once before the first round.
    """
    taken: dict[str, list[float]] = {name: [] for name in calls}
    for call in calls.values() if warm else ():
        call()
    for _ in range(rounds):
        for name, call in calls.items():
            taken[name].append(once(call))
    return taken


def median(times: list[float]) -> float:
    """Median of some times [s]."""
    return float(np.median(times))


def ratio(above: list[float], below: list[float]) -> float:
    """Median over the rounds of one time over the other of the same round."""
    return float(np.median(np.array(above) / np.array(below)))


def once(call: Callable[[], object]) -> float:
    """Processor time of one call [s]."""
    begin = time.process_time()
    call()
    return time.process_time() - begin
