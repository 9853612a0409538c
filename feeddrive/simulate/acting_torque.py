"""The motor torque that a drive would show: the command through dead time and lag of the current loop, averaged.

    T' = (u(t - d) - T) / tau,    mean over a tick h = mean of u(t - d) - tau (T_end - T_start) / h

| symbol | meaning | unit |
|---|---|---|
| u, T | torque command, held over a tick, and torque | N m |
| d = k h + f h, tau | dead time and lag of the current loop | s |

Both are exact. A delay that the plant declares beyond the current loop is not seen by the drive and not in it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import accumulate

import numpy as np

from feeddrive.servo.cascade import Cascade
from feeddrive.simulate.timing import SPLIT
from feeddrive.typing import FloatArray


@dataclass(frozen=True)
class ActingTorque:
    """State between ticks: torque at the tick, then the commands still under way, oldest first; shape (k + 2,)."""

    state: FloatArray

    @classmethod
    def at_rest(cls, cascade: Cascade) -> ActingTorque:
        """No torque, none under way."""
        return cls(np.zeros(_late(cascade)[0] + 2))

    def means(self, cascade: Cascade, command: FloatArray) -> tuple[FloatArray, ActingTorque]:
        """Mean torque of every tick [N m], shape (n,), and the state after the last.

        Args:
            cascade: its tick, lag and dead time.
            command: per tick [N m], shape (n,).
        """
        _, part = _late(cascade)
        waiting = np.concatenate([self.state[1:], command])
        older, newer = waiting[: len(command)], waiting[1 : 1 + len(command)]
        entered = part * older + (1 - part) * newer
        after = waiting[len(command) :]
        if not cascade.current_lag:
            return entered, ActingTorque(np.concatenate([entered[-1:], after]))
        h = cascade.sample_time / cascade.current_lag
        driven = math.exp(-(1 - part) * h) * -math.expm1(-part * h) * older - math.expm1(-(1 - part) * h) * newer
        decay = math.exp(-h)
        lagged = accumulate(driven.tolist(), lambda torque, new: decay * torque + new, initial=float(self.state[0]))
        torques = np.fromiter(lagged, dtype=float, count=len(driven) + 1)
        starts, ends = torques[:-1], torques[1:]
        return entered - (ends - starts) / h, ActingTorque(np.concatenate([ends[-1:], after]))


def _late(cascade: Cascade) -> tuple[int, float]:
    """Whole ticks of dead time and the rest as part of a tick."""
    dead = cascade.dead_time / cascade.sample_time
    late = math.floor(dead + SPLIT)
    return late, dead - late if dead - late > SPLIT else 0.0
