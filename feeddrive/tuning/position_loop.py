"""Position gain: the largest K_v whose margins hold in every case and that magnifies no set-point.

    x = K_v G_x / (1 + K_v L) x_set,   |x / x_set| <= 1 + a few thousandths, for the encoder and for the table

| symbol | meaning | unit |
|---|---|---|
| L | open position loop at K_v = 1/s, the velocity loop closed | 1 |
| G_x | from the position error to a position, at K_v = 1/s | 1 |

A loop of its margins alone may overshoot a contour; a machine tool's may not. Feed-forward is not in it. A contour is
run in motion, so that magnification is looked at there; the margins hold at rest too.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from feeddrive.errors import InputError
from feeddrive.plant.plant import Plant
from feeddrive.servo.cascade import Cascade, FeedForward
from feeddrive.servo.linear_loop import closed_loop
from feeddrive.servo.margins import frequency_response
from feeddrive.servo.mechanics_response import Case, grid, transfer
from feeddrive.servo.resonances import Resonance, resonances
from feeddrive.tuning.demand import Demand
from feeddrive.tuning.largest_gain import GainLimit, Limit, largest_gain
from feeddrive.typing import BoolArray, ComplexArray, FloatArray

_LOWEST = 0.05
"""[Hz]; far below any position loop."""
_BISECTIONS = 24


@dataclass(frozen=True)
class _Loops:
    """Grid [Hz] (n,), open loops L and paths G_x to what is measured and to the table (cases, n), at K_v = 1/s.

    `moving` tells the cases in which a contour is run (cases,); all where none moves.
    """

    frequency: FloatArray
    open: ComplexArray
    paths: tuple[ComplexArray, ComplexArray]
    moving: BoolArray


def position_gain(plant: Plant, cascade: Cascade, cases: Sequence[Case], demand: Demand) -> GainLimit:
    """The largest K_v [1/s] and what holds it back.

    Args:
        plant: the machine.
        cascade: with the gains of its velocity loop; its position gain and feed-forward are not looked at.
        cases: in which it must hold.
        demand: margins and magnification.

    Raises:
        InputError: no gain holds.
    """
    loops = _loops(plant, cascade, cases)
    found = largest_gain(loops.frequency, loops.open, 0.0, demand)
    if not found.gain:
        what = f"no position gain keeps {demand.phase:g}° and {demand.gain:g} dB in every case"
        raise InputError(what, plant.name, "ask for less, or make the drive faster (rates, dead time)")
    over, case, frequency = _magnified(loops, found.gain)
    if over <= demand.magnification:
        return found
    low, high = 0.0, found.gain
    for _ in range(_BISECTIONS):
        middle = 0.5 * (low + high)
        over, case, frequency = _magnified(loops, middle)
        low, high = (middle, high) if over <= demand.magnification else (low, middle)
    _, case, frequency = _magnified(loops, high)
    return GainLimit(low, case, frequency, Limit.MAGNIFICATION)


def _loops(plant: Plant, cascade: Cascade, cases: Sequence[Case]) -> _Loops:
    slow = replace(cascade, position_gain=1.0, feed_forward=FeedForward(), balancing_time=0.0)
    highest = 0.5 / (slow.sample_time * slow.position_divider)
    roots: list[Resonance] = []
    for case in cases:
        roots += resonances(transfer(plant, "motor_torque", "table_position", case), _LOWEST, highest)
    frequency = grid(_LOWEST, highest * (1 - 1e-9), tuple(roots))
    opened, measured, table = [], [], []
    for case in cases:
        system = closed_loop(case.on(plant), slow, case.velocity, case.position)
        own, there = (
            frequency_response(system[name, "position"], frequency) for name in ("measured_position", "table_position")
        )
        opened.append(own / (1 - own))
        measured.append(own / (1 - own))
        table.append(there / (1 - own))
    moving = np.array([case.velocity != 0 for case in cases])
    return _Loops(frequency, np.array(opened), (np.array(measured), np.array(table)), moving | ~moving.any())


def _magnified(loops: _Loops, gain: float) -> tuple[float, int, float]:
    """Largest magnification of the set-point [dB], in which case, at which frequency [Hz]."""
    closed = [np.abs(gain * path / (1 + gain * loops.open)) for path in loops.paths]
    worst = np.where(loops.moving[:, None], np.maximum(*closed), 0.0)
    case, place = np.unravel_index(int(np.argmax(worst)), worst.shape)
    return float(20 * np.log10(worst[case, place])), int(case), float(loops.frequency[place])
