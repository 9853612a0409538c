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

import numpy as np
from scipy.ndimage import shift

from feeddrive.effects.base import TimingEffect
from feeddrive.effects.timing.channel_delay import lateness
from feeddrive.plant.plant import Plant
from feeddrive.typing import FloatArray


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
    """A series in the band, shape (n,), `lag` [s] later; quintic splines are exact to 1e-4 in the band."""
    if lag == 0:
        return series
    about = series[0]  # the spline takes it away again: a long travel keeps its digits
    moved: FloatArray = np.asarray(shift(series - about, lag / sample_time, order=5, mode="nearest") + about)
    return moved
