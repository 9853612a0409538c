"""Ratios of processor time from interleaved calls: what else runs on the machine then weighs on both alike."""

from __future__ import annotations

import time
from collections.abc import Callable

import numpy as np


def interleaved(calls: dict[str, Callable[[], object]], rounds: int = 15) -> dict[str, float]:
    """Median processor time of each call [s]; all are called in turn, once before the first round."""
    taken: dict[str, list[float]] = {name: [] for name in calls}
    for call in calls.values():
        call()
    for _ in range(rounds):
        for name, call in calls.items():
            begin = time.process_time()
            call()
            taken[name].append(time.process_time() - begin)
    return {name: float(np.median(times)) for name, times in taken.items()}


def once(call: Callable[[], object]) -> float:
    """Processor time of one call [s]."""
    begin = time.process_time()
    call()
    return time.process_time() - begin
