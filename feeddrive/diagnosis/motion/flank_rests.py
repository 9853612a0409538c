"""Where a recording shows that the load rides on one flank of a play, pushed by the motor.

    e = x - r θ,   ρ = e - mean of e over a period of the load against the held motor

| symbol | meaning | unit |
|---|---|---|
| x, θ | measured table position and motor angle | m, rad |
| r | travel per angle of the motor | m/rad |
| ρ | bounces and ringing, without the travel errors, which are slower | m |

Where it lies is told without the lead errors that both ways have at the same place, as far as they are slow.

The load rests where ρ has been no more than noise for as long as the contact takes to forget (1 / |Re p|, p its pole
with the motor held), while the motor has gone further one way than the lost motion is wide: a load that rings less than
is seen rings less than a third of that when its rest is told, and one that is not pushed is left behind by then. Where
e is then says which flank: a motor that brakes harder than friction does is pushed by the load. Nothing is told unless
every rest is nearer to one flank than to the other by far: of a play as small as the travel errors it cannot be seen.
"""

from __future__ import annotations

import math

import numpy as np
from scipy.ndimage import binary_dilation, maximum_filter1d, uniform_filter1d

from feeddrive.diagnosis.motion.band import Band
from feeddrive.diagnosis.motion.slow_rows import ROUGH
from feeddrive.plant.analysis.modes import held_modes
from feeddrive.plant.plant import Plant
from feeddrive.recording import Recording
from feeddrive.simulate.driven import FlankRests
from feeddrive.typing import BoolArray, FloatArray

QUIETEST = 0.1
"""Share of the pushed rows that rest for sure: a load that bounces at nine tenths of them is not predicted at all."""

NEAR = 0.25
"""Distance of a rest from the middle of its flank over that from both at most: three times as far from the other. A
load that is driven hard stretches away from the other flank, which makes no rest doubtful."""

SLOW = 3
"""Half waves of a travel error over the stroke at most: a line, and a lead map (`lead_map.HALF_WAVES`)."""

TURNS = 10
"""Times that rows are told apart by flank at most: each changes those between the flanks alone."""

FEWEST = 8
"""Rows over which ρ is taken at least: five of them are independent, as `ROUGH` asks for."""


def flank_rests(recording: Recording, plant: Plant, band: Band) -> tuple[FlankRests, BoolArray] | None:
    """First samples at which each rest is told, and rows (n,) that bounce before it; None where no rest can be told.

    Args:
        recording: with a motor angle.
        plant: whose lead and stiffness apply.
        band: of the comparison, whose filter carries bounces to rows about them.
    """
    if "table_position" not in recording or not plant.chain.elastic:
        return None
    poles = [pole for pole in held_modes(plant, plant.middle).poles if pole.imag > 0 and pole.real < 0]
    if not poles:
        return None
    slowest = min(poles, key=lambda pole: pole.imag)
    turned = plant.chain.motor_radius * recording["motor_angle"]
    behind = recording["table_position"] - turned
    period = max(FEWEST, math.ceil(2 * math.pi / (slowest.imag * recording.sample_time)))
    length = max(period, math.ceil(1 / (-slowest.real * recording.sample_time)))
    if len(turned) <= 2 * length:
        return None
    gone = np.zeros(len(turned))
    gone[length:] = turned[length:] - turned[:-length]
    fast = np.abs(gone) > 0.5 * np.max(np.abs(gone))
    if not (np.any(fast & (gone > 0)) and np.any(fast & (gone < 0))):
        return None
    behind = _without_travel_errors(behind, turned, gone)
    flanks = {side: float(np.median(behind[fast & (side * gone > 0)])) for side in (1.0, -1.0)}
    lost = flanks[-1.0] - flanks[1.0]
    pushed = np.abs(gone) > max(lost, 0.0)
    ringing = behind - uniform_filter1d(behind, period)
    if not pushed.any():
        return None
    quiet = np.quantile(_power(ringing, length)[pushed], QUIETEST)
    loud = _power(ringing, period) > ROUGH**2 * quiet
    rests = pushed & ~maximum_filter1d(loud, length, origin=(length - 1) // 2)  # in what is past
    samples = np.flatnonzero(rests & ~np.concatenate([[True], rests[:-1]]))
    sides = _sides(behind[samples], flanks)
    if not len(samples) or not np.all(sides):
        return None
    last_rest, last_loud = (np.maximum.accumulate(np.where(one, np.arange(len(one)), -1)) for one in (rests, loud))
    reach = math.ceil(band.sample_rate / band.edge)
    told = FlankRests(samples, sides, length, period, ROUGH * math.sqrt(quiet))
    return told, np.asarray(binary_dilation(last_loud > last_rest, iterations=reach))


def _without_travel_errors(behind: FloatArray, place: FloatArray, gone: FloatArray) -> FloatArray:
    """How far the table is behind the motor, (n,) [m], without what the same places have on both flanks.

    A load that is braked hard is not on the flank that the way says: from that on, each row is of the flank that it is
    nearer to, until all stay.

    Args:
        behind, place: of the table against the motor, and of the motor in travel, (n,) [m].
        gone: of the motor, one way or the other, (n,) [m].
    """
    low, stroke = float(np.min(place)), float(np.ptp(place))
    curves = np.polynomial.legendre.legvander(2 * (place - low) / stroke - 1, SLOW)
    side, travel = np.where(gone > 0, 1.0, -1.0), np.zeros(len(place))
    for _ in range(TURNS):
        shares = np.linalg.lstsq(np.column_stack([curves, side]), behind, rcond=None)[0]
        travel = curves @ shares[:-1]
        nearer = np.where(behind < travel, 1.0, -1.0)
        if np.array_equal(nearer, side):
            break
        side = nearer
    left: FloatArray = behind - travel
    return left


def _sides(behind: FloatArray, flanks: dict[float, float]) -> FloatArray:
    """Flank, 1 or -1, on which the load rests at places (k,) [m]; 0 for one that is not far nearer to one of them."""
    if flanks[1.0] >= flanks[-1.0]:
        return np.zeros(len(behind))
    ahead, back = (np.abs(behind - flanks[side]) for side in (1.0, -1.0))
    is_near = np.minimum(ahead, back) <= NEAR * (ahead + back)
    return np.where(is_near, np.where(ahead < back, 1.0, -1.0), 0.0)


def _power(series: FloatArray, length: int) -> FloatArray:
    """Mean square of a series about every sample, (n,)."""
    power: FloatArray = np.maximum(uniform_filter1d(series**2, length), 0.0)  # a running sum may end below zero
    return power
