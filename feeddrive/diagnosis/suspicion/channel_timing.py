"""When the rows of predicted channels were true: a drive that acts late, channels that are recorded late.

    y_predicted(t) = y(t - lag),    lag = d_channel - d_angle - d_drive (the last for the torque alone)

The prediction is driven by the motor angle as it was recorded, so that a late angle makes every other channel early;
nothing has to be simulated again for it.

| symbol | meaning | unit |
|---|---|---|
| d_channel, d_angle | `channel_delay` of the channel, of the motor angle | s |
| d_drive | `drive_delay`: what acts at t was recorded at t - d_drive | s |
"""

from __future__ import annotations

import math

import numpy as np
from scipy.interpolate import BSpline
from scipy.ndimage import spline_filter1d

from feeddrive.effects.base import TimingEffect
from feeddrive.effects.timing.channel_delay import lateness
from feeddrive.plant.plant import Plant
from feeddrive.typing import FloatArray

PADDING = 16
"""Samples by which the ends are continued for a spline, which forgets them by a factor of 0.43 a sample."""

_BASIS = BSpline.basis_element(np.arange(7.0))
"""Quintic B-spline over six steps."""


def lag_of(plant: Plant, channel: str) -> float:
    """By how much a channel's rows are later than those of the motor angle [s]; negative where they are earlier."""
    lag = lateness(plant.effects, channel) - lateness(plant.effects, "motor_angle")
    if channel != "motor_torque":
        return lag
    return lag - float(sum(e.delay(e.values) for e in plant.effects if isinstance(e, TimingEffect)))


def repeated(series: FloatArray, rows: tuple[int, int]) -> FloatArray:
    """A series, shape (n,), read every so many rows from a first one on and repeated between (`logged_rows`)."""
    every, first = rows
    index = np.arange(len(series))
    return np.asarray(series[np.maximum((index - first) // every * every + first, 0)])


def lagging(series: FloatArray, lag: float, sample_time: float) -> FloatArray:
    """A series in the band, shape (n,), `lag` [s] later; quintic splines are exact to 1e-4 in the band.

    Every sample is read at the same share of a step, so that the spline is one sum of six of its coefficients.
    """
    if lag == 0:
        return series
    whole = math.floor(lag / sample_time)
    part = lag / sample_time - whole
    reach = PADDING + abs(whole)
    about = series[0]  # the spline takes it away again: a long travel keeps its digits
    coefficients = spline_filter1d(np.pad(series - about, reach, mode="edge"), 5, mode="nearest")
    weights = _BASIS(np.arange(1.0, 7.0) - part)
    read = coefficients[reach - whole - 3 : reach - whole + len(series) + 2]
    moved: FloatArray = np.convolve(read, weights, mode="valid") + about
    return moved
