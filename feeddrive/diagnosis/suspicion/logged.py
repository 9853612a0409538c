"""A torque logged more slowly than the drive holds it: how long it is held, read off the delay that would be named.

Taken as held for a whole row h where it is held for h / m, a torque comes late by

    lag = (1 - 1/m) h / 2,    m = 2, 3, 4, ...

A delay of the recorded torque that is one of these is the recorder's way to write, not a fault of the machine. Asked
only where rows are so far apart that loops are mostly faster. Where the plant declares its controller the cycle is
known and taken from it. Where it does not, a delay d that is none of these is one of a machine and a recorder together:
the rows alone do not tell m, and the machine's own part is from d - h/2 to d, which is stated.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from feeddrive.diagnosis.certainty.uncertainty import Interval
from feeddrive.diagnosis.motion.slow_rows import is_slow
from feeddrive.effects.base import Effect
from feeddrive.effects.timing.channel_delay import ChannelDelay
from feeddrive.plant.plant import DeclaredCascade, Plant
from feeddrive.recording import Recording
from feeddrive.schema.table import Origins, Table
from feeddrive.simulate.scenario.scenario_controller import read_cascade

FASTEST_LOG = 0.9e-3
"""Time between rows [s] below which a recording is taken as one row a cycle."""

MOST_CYCLES = 40
"""Cycles in a row at most; more are not distinguished."""

NEAR = 0.02
"""Share of a row by which a lag may miss one of these where its interval is narrower: what the hold's shape leaves."""


def may_be_logged(recordings: Sequence[Recording]) -> bool:
    """Whether recordings are all written at one rate, at which loops are mostly faster, if not all of them."""
    return _is_of_one_rate(recordings) and not any(map(is_slow, recordings))


def _is_of_one_rate(recordings: Sequence[Recording]) -> bool:
    steps = [recording.sample_time for recording in recordings]
    return min(steps) >= FASTEST_LOG and max(steps) <= 1.001 * min(steps)


def hold_of(
    effects: Sequence[Effect], spans: Sequence[Mapping[str, Sequence[Interval] | None]], recordings: Sequence[Recording]
) -> float | None:
    """How long the torque of these recordings is held [s]; None where a whole row is as good or nothing is known.

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


def declared_hold(plant: Plant, recordings: Sequence[Recording]) -> float | None:
    """Cycle of the declared controller [s], which holds the torque; None where a row is no longer, or none is declared.

    However far the rows are apart: a torque of the instant at which it is written acts for a cycle from then on, and
    is that of the motion half a cycle later.

    Raises:
        InputError: a declared cascade that cannot be read.
    """
    if not isinstance(plant.controller, DeclaredCascade):
        return None
    if not _is_of_one_rate(recordings):
        return None
    cascade, _ = read_cascade(Table(plant.controller.entries, plant.controller.where, Origins()), plant)
    cycle = cascade.sample_time
    return cycle if cycle < (1 - NEAR) * recordings[0].sample_time else None


def open_lag(effects: Sequence[Effect], recordings: Sequence[Recording]) -> tuple[str, ...]:
    """Remarks on a delay of the torque, part of which may be the recorder's."""
    if not may_be_logged(recordings):
        return ()
    step = recordings[0].sample_time
    delays = [effect.values["delay"] for effect in effects
              if isinstance(effect, ChannelDelay) and effect.place == "motor_torque"]  # fmt: skip
    return tuple(
        f"the delay of the motor torque of {1e3 * delay:.3g} ms is that of a drive that holds it for a whole row of "
        f"{1e3 * step:.3g} ms; of a faster loop the recorder makes up to {0.5e3 * step:.3g} ms of it, so that the "
        f"machine's own is {max(0.0, 1e3 * (delay - 0.5 * step)):.3g} to {1e3 * delay:.3g} ms: declare the controller "
        "with its velocity_rate to tell them apart"
        for delay in delays
        if isinstance(delay, float)
    )


def sentence(hold: float, step: float) -> str:
    """Remarks on it; both [s]."""
    return (
        f"a torque is logged every {step * 1e3:.3g} ms, and comes as from a drive that holds it for "
        f"{hold * 1e3:.2g} ms; it is taken so, and no delay is named for it"
    )


def declared_sentence(hold: float, step: float) -> str:
    """Remarks on a cycle that is declared; both [s]."""
    return (
        f"a torque is logged every {step * 1e3:.3g} ms; the declared controller holds it for {hold * 1e3:.2g} ms, and "
        "it is taken so"
    )
