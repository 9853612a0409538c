"""The largest gain of a loop whose margins hold in every case.

    L = k G,   |k G| <= 10^(-A/20) wherever arg G = -180 deg,   |k G| != 1 wherever arg G is nearer than P to -180 deg

| symbol | meaning | unit |
|---|---|---|
| G | response of the open loop at gain 1, one per case | 1 |
| A, P | gain margin, phase margin | dB, deg |

At low frequencies, where the integrator turns the phase back to -180 deg, the loop gain must stay above 1; beyond the
first frequency above the integrator's corner where the phase is far enough from -180 deg, below 1. So the gains that
hold are one interval, found without a search.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from feeddrive.tuning.demand import Demand
from feeddrive.typing import BoolArray, ComplexArray, FloatArray


class Limit(StrEnum):
    """What holds a gain back."""

    GAIN = "gain margin"
    PHASE = "phase margin"
    MAGNIFICATION = "magnification of the set-point"


@dataclass(frozen=True)
class GainLimit:
    """The largest gain and what holds it back.

    Attributes:
        gain: factor on the open loop at gain 1; 0 where no gain holds.
        case: index of the case that limits.
        frequency: at which it does [Hz].
        limit: which margin.
    """

    gain: float
    case: int
    frequency: float
    limit: Limit


def largest_gain(frequency: FloatArray, loops: ComplexArray, corner: float, demand: Demand) -> GainLimit:
    """The largest gain whose margins hold in every case.

    Args:
        frequency: ascending [Hz], shape (n,).
        loops: open loops at gain 1, shape (cases, n).
        corner: of the integrating controller, 1 / 2 pi T_n [Hz]; 0 where there is none.
        demand: the margins.
    """
    size, from_180 = np.abs(loops), np.degrees(np.angle(-loops))  # 0 at -180 deg
    near = np.abs(from_180) < demand.phase
    above = np.maximum.accumulate((frequency >= corner) & _far(loops, demand.phase), axis=1)
    by_phase = np.where(_widened(near & above), size, 0.0)
    by_gain = np.where(_crossing(from_180) & above, size * 10 ** (demand.gain / 20), 0.0)
    upper = [_limit(frequency, by_phase, Limit.PHASE), _limit(frequency, by_gain, Limit.GAIN)]
    found = min(upper, key=lambda one: one.gain)
    low = np.where(near & ~above, size, np.inf)
    least = 1 / float(np.min(low)) if np.isfinite(low).any() else 0.0
    reached = bool(above.any(axis=1).all())
    return (
        found if reached and least < found.gain < np.inf else GainLimit(0.0, found.case, found.frequency, found.limit)
    )


def _far(loops: ComplexArray, phase: float) -> BoolArray:
    """Whether the phase, followed from the lowest frequency on, is more than `phase` [deg] above -180 deg."""
    followed = np.degrees(np.unwrap(np.angle(loops), axis=1))
    turns = 360 * np.round((followed[:, :1] + 90) / 360)  # begins between -270 and 90 deg
    far: BoolArray = followed - turns + 180 > phase
    return far


def _crossing(from_180: FloatArray) -> BoolArray:
    """Whether the phase passes -180 deg beside a frequency, before or behind it."""
    change = (np.diff(np.signbit(from_180), axis=1)) & (np.abs(np.diff(from_180, axis=1)) < 180)
    beside = np.zeros(from_180.shape, dtype=bool)
    beside[:, :-1] |= change
    beside[:, 1:] |= change
    return beside


def _widened(mask: BoolArray) -> BoolArray:
    """The mask and the frequencies beside it: between two frequencies the phase may have gone further."""
    wide = mask.copy()
    wide[:, :-1] |= mask[:, 1:]
    wide[:, 1:] |= mask[:, :-1]
    return wide


def _limit(frequency: FloatArray, sizes: FloatArray, limit: Limit) -> GainLimit:
    case, place = np.unravel_index(int(np.argmax(sizes)), sizes.shape)
    size = float(sizes[case, place])
    return GainLimit(1 / size if size else np.inf, int(case), float(frequency[place]), limit)
