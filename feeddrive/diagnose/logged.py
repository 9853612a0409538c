"""A torque logged more slowly than the drive holds it: how long it is held, read off the delay that would be named.

Taken as held for a whole row h where it is held for h / m, a torque comes late by

    lag = (1 - 1/m) h / 2,    m = 2, 3, 4, ...

A delay of the recorded torque that is one of these is the recorder's way to write, not a fault of the machine. Asked
only where rows are so far apart that loops are mostly faster.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from feeddrive.diagnose.certainty.uncertainty import Interval
from feeddrive.diagnose.slow_rows import is_slow
from feeddrive.effects.base import Effect
from feeddrive.effects.channel_delay import ChannelDelay
from feeddrive.recording import Recording

FASTEST_LOG = 0.9e-3
"""Time between rows [s] below which a recording is taken as one row a cycle."""

MOST_CYCLES = 40
"""Cycles in a row at most; more are not told apart."""

NEAR = 0.02
"""Of a row, by which a lag may miss one of these where its interval is narrower: what the shape of the hold leaves."""


def may_be_logged(recordings: Sequence[Recording]) -> bool:
    """Whether recordings are all written at one rate, at which loops are mostly faster."""
    steps = [recording.sample_time for recording in recordings]
    return min(steps) >= FASTEST_LOG and max(steps) <= 1.001 * min(steps) and not any(map(is_slow, recordings))


def hold_of(
    effects: Sequence[Effect], spans: Sequence[Mapping[str, Sequence[Interval] | None]], recordings: Sequence[Recording]
) -> float | None:
    """How long the torque of these recordings is held [s]; None where a whole row is as good or nothing is told.

    Args:
        effects: that were found with the torque held for a whole row.
        spans: intervals of their values, see `intervals`.
        recordings: all that were fitted or judged, which `may_be_logged`.
    """
    step = recordings[0].sample_time
    for effect, span in zip(effects, spans, strict=False):
        delay, ends = effect.values.get("delay"), span.get("delay")
        if isinstance(effect, ChannelDelay) and effect.place == "motor_torque" and isinstance(delay, float) and ends:
            return _nearest(delay / step, 0.5 * (ends[0][1] - ends[0][0]) / step, step)
    return None


def _nearest(share: float, half: float, step: float) -> float | None:
    """The hold whose lag is the nearest to a share of a row, known to a half width; None where none is near."""
    cycles = min(range(2, MOST_CYCLES + 1), key=lambda m: abs((1 - 1 / m) / 2 - share))
    return step / cycles if abs((1 - 1 / cycles) / 2 - share) <= max(NEAR, half) else None


def sentence(hold: float, step: float) -> str:
    """What is to be said of it; both [s]."""
    return (
        f"a torque is logged every {step * 1e3:.3g} ms, and comes as from a drive that holds it for "
        f"{hold * 1e3:.2g} ms; it is taken so, and no delay is named for it"
    )
