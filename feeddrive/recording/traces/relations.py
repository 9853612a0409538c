"""Relations between the signals of an axis: regressions, the integral of a speed, the lag between two signals."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from feeddrive.recording.traces.resampling import gaps, same_time
from feeddrive.recording.traces.trace import Signal
from feeddrive.typing import FloatArray

FEWEST = 50  # samples below which a regression on noise can look like a relation
_BLOCKS = 8
_SURE = 6.0  # scatters: with 6 degrees of freedom a chance of one in a thousand
_SAID_LAG = 0.2  # of a sample over the recording; far below it no result changes


class Fit(NamedTuple):
    """y = factor x + constant; scatter relative to the rms of y about its mean; correlation."""

    factor: float
    scatter: float
    correlation: float


def fit(x: FloatArray, y: FloatArray) -> Fit | None:
    """Return the regression of y on x, (n,) each; None where one of them stands still or there are too few."""
    kept = np.isfinite(x) & np.isfinite(y)
    if int(kept.sum()) < FEWEST:
        return None
    x, y = x[kept] - np.mean(x[kept]), y[kept] - np.mean(y[kept])
    across, along = float(x @ x), float(y @ y)
    if not (across > 0.0 and along > 0.0 and math.isfinite(across) and math.isfinite(along)):
        return None
    factor = float(x @ y) / across
    rest = y - factor * x
    return Fit(factor, math.sqrt(float(rest @ rest) / along), float(x @ y) / math.sqrt(across * along))


def at_times(signal: Signal, time: FloatArray) -> FloatArray:
    """Return the values of a signal at times, (n,); NaN outside its own."""
    if same_time(signal.time, time):
        return signal.values
    return np.interp(time, signal.time, signal.values, left=np.nan, right=np.nan)


def speed_factor(position: Signal, speed: Signal) -> Fit | None:
    """Return a speed per derivative of a position: from the integral of the speed, which quantisation does not blur.

    Only the longest stretch without a gap in either is used.
    """
    breaks = [position.time[i] for i, _ in gaps(position.time)] + [speed.time[i] for i, _ in gaps(speed.time)]
    edges = sorted({float(position.time[0]), *map(float, breaks), float(position.time[-1])})
    start, stop = max(pairwise(edges), key=lambda pair: pair[1] - pair[0], default=(0.0, 0.0))
    inside = (position.time > start) & (position.time <= stop) if breaks else np.ones(position.time.size, bool)
    time, place = position.time[inside], position.values[inside]
    if time.size < FEWEST:
        return None
    rate = at_times(speed, time) if not breaks else np.interp(time, speed.time, speed.values)
    kept = np.isfinite(rate)
    time, place, rate = time[kept], place[kept], rate[kept]
    if time.size < FEWEST:
        return None
    travelled = np.concatenate(([0.0], np.cumsum(0.5 * (rate[1:] + rate[:-1]) * np.diff(time))))
    # An offset of the speed makes a ramp of its integral, which is no part of the factor; but so does an even motion.
    ramp = np.column_stack((time - time[0], np.ones_like(time)))
    flat = tuple(side - ramp @ np.linalg.lstsq(ramp, side, rcond=None)[0] for side in (travelled, place))
    found = [one for one in (fit(*flat), fit(travelled, place)) if one is not None and one.factor != 0.0]
    if not found:
        return None
    best = min(found, key=lambda one: one.scatter)
    return Fit(1.0 / best.factor, best.scatter, best.correlation)


def clock_drift(position: Signal, speed: Signal) -> Fit | None:
    """Return by how much the lag of a speed behind its position grows with time, and its scatter; None if it does not.

    In each block p(t) = a X(t) + b X'(t) + c + d t with X the integral of the speed, so its lag is b / a.
    """
    if not same_time(position.time, speed.time) or position.time.size < _BLOCKS * 4 * FEWEST:
        return None
    time, step = position.time, float(np.median(np.diff(position.time)))
    travelled = np.concatenate(([0.0], np.cumsum(0.5 * (speed.values[1:] + speed.values[:-1]) * np.diff(time))))
    middles, lags = [], []
    for block in np.array_split(np.arange(time.size), _BLOCKS):
        way, since = travelled[block] - travelled[block[0]], time[block] - time[block[0]]
        moves = np.column_stack((way, speed.values[block], np.ones(block.size), since))
        size = np.max(np.abs(moves), axis=0)
        if not np.all(size > 0.0) or np.ptp(position.values[block]) == 0.0:
            return None
        factors = np.linalg.lstsq(moves / size, position.values[block], rcond=None)[0] / size
        if not abs(factors[0]) > 0.0:
            return None
        middles.append(float(np.mean(time[block])))
        lags.append(float(factors[1] / factors[0]))
    spread, late = np.array(middles) - np.mean(middles), np.array(lags) - np.mean(lags)
    drift = float(spread @ late) / float(spread @ spread)
    rest = late - drift * spread
    scatter = math.sqrt(float(rest @ rest) / (_BLOCKS - 2) / float(spread @ spread))
    length = float(time[-1] - time[0])
    if abs(drift) * length < _SAID_LAG * step or abs(drift) < _SURE * scatter:
        return None
    return Fit(drift, scatter, 0.0)


def smooth_slope(values: FloatArray, time: FloatArray) -> FloatArray:
    """Return the slope over ten samples, (n,): differences of neighbours show the quantisation of an encoder."""
    wide = 5
    padded, stamps = (np.pad(side, wide, mode="edge") for side in (values, time))
    width = stamps[2 * wide :] - stamps[: -2 * wide]
    slope: FloatArray = (padded[2 * wide :] - padded[: -2 * wide]) / np.where(width > 0.0, width, 1.0)
    return slope


def explained(torque: FloatArray, acceleration: FloatArray, direction: FloatArray) -> tuple[float, float, float]:
    """Return the share of a torque that a (acceleration) + b (direction) + c explains, and a and b."""
    columns = np.column_stack((acceleration, direction, np.ones_like(torque)))
    scale = np.maximum(np.max(np.abs(columns), axis=0), 1e-300)
    kept = np.isfinite(torque)
    if kept.sum() < FEWEST:
        return 0.0, 0.0, 0.0
    factors = np.linalg.lstsq(columns[kept] / scale, torque[kept], rcond=None)[0]
    rest = torque[kept] - columns[kept] / scale @ factors
    whole = float(np.var(torque[kept]))
    return (1.0 - float(np.var(rest)) / whole if whole > 0.0 else 0.0), float(factors[0]), float(factors[1])
