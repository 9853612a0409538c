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
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import accumulate

import numpy as np

from feeddrive.servo.sampled_plant import whole_and_rest
from feeddrive.simulate.controlled.controlled_machine import TorqueLoop
from feeddrive.typing import FloatArray


@dataclass(frozen=True)
class ActingTorque:
    """State between ticks: torque at the tick, then the commands still under way, oldest first; shape (k + 2,)."""

    state: FloatArray

    @classmethod
    def at_rest(cls, loop: TorqueLoop, tick: float) -> ActingTorque:
        """No torque, none under way."""
        return cls(np.zeros(_late(loop, tick)[0] + 2))

    def means(self, loop: TorqueLoop, tick: float, command: FloatArray) -> tuple[FloatArray, ActingTorque]:
        """Mean torque of every tick [N m], shape (n,), and the state after the last.

        Args:
            loop: lag and dead time.
            tick: h [s].
            command: per tick [N m], shape (n,).
        """
        _, part = _late(loop, tick)
        waiting = np.concatenate([self.state[1:], command])
        older, newer = waiting[: len(command)], waiting[1 : 1 + len(command)]
        acting = entered(waiting, (part, 1 - part), len(command))
        after = waiting[len(command) :]
        if not loop.lag:
            return acting, ActingTorque(np.concatenate([acting[-1:], after]))
        h = tick / loop.lag
        driven = math.exp(-(1 - part) * h) * -math.expm1(-part * h) * older - math.expm1(-(1 - part) * h) * newer
        decay = math.exp(-h)
        lagged = accumulate(driven.tolist(), lambda torque, new: decay * torque + new, initial=float(self.state[0]))
        torques = np.fromiter(lagged, dtype=float, count=len(driven) + 1)
        means = mean_torque(acting, torques, loop.lag, tick)
        return means, ActingTorque(np.concatenate([torques[-1:], after]))


def entered(asked: FloatArray, parts: Sequence[float], count: int) -> FloatArray:
    """Command that enters the current loop over each tick, averaged over it [N m], shape (count,).

    Args:
        asked: commands, the oldest that still acts in the first tick first [N m].
        parts: of a tick in which the older and the newer ones act; their sum is 1.
        count: of ticks.
    """
    acting: FloatArray = np.zeros(count)
    for i, part in enumerate(parts):
        acting = acting + part * asked[i : i + count]
    return acting


def mean_torque(acting: FloatArray, ends: FloatArray, lag: float, tick: float) -> FloatArray:
    """Torque averaged over each tick [N m], (n,), by lag ΔT = ∫ (u - T) dt; lag and tick in s.

    `acting` is the command that enters, averaged over the tick, (n,); `ends` the torque at its ends, (n + 1,) [N m].
    """
    return acting - lag / tick * np.diff(ends)


def _late(loop: TorqueLoop, tick: float) -> tuple[int, float]:
    """Whole ticks of dead time and the rest as part of a tick."""
    return whole_and_rest(loop.dead_time / tick)
