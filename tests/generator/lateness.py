"""Channels that are recorded late: when the recorder reads and which row gets what.

A late position is read between the controller's instants and its rows are moved down. A late torque is a held one,
so that what it is late by beyond whole rows shows as positions read that much after the torque has changed.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from tests.generator.constants import Constants

Array = npt.NDArray[np.float64]

ROUNDING = 1e-9
"""Shares of a sample below this are none."""


class Lateness(NamedTuple):
    """rows: how many rows the late channel moves down; reading: time of the read after the instant [s]."""

    rows: int
    reading: float


def lateness(sample_time: float, c: Constants) -> Lateness:
    """Return how the late channel, if any, is read; ValueError where several are late."""
    delays = (c.torque_lateness, c.angle_lateness, c.table_lateness)
    if sum(delay > 0.0 for delay in delays) > 1:
        raise ValueError("only one channel can be late")
    samples = sum(delays) / sample_time
    rows = math.floor(samples + ROUNDING) if c.torque_lateness > 0.0 else math.ceil(samples - ROUNDING)
    share = abs(samples - rows)
    return Lateness(rows, share * sample_time if share > ROUNDING else 0.0)


def as_recorded(torque: Array, states: Array, read: Array, rows: int, c: Constants) -> tuple[Array, Array, Array]:
    """Return torque, motor angle and table position, each (n,), as the rows of the recording have them.

    states: (n, WIDTH) at the controller's instants; read: (n, WIDTH) `reading` later.
    """
    angle, position = states[:, 0], states[:, 4]
    if c.torque_lateness > 0.0:
        return moved(torque, rows, 0.0), read[:, 0], read[:, 4]
    if c.angle_lateness > 0.0:
        angle = moved(read[:, 0], rows, angle[0])
    if c.table_lateness > 0.0:
        position = moved(read[:, 4], rows, position[0])
    return torque, angle, position


def moved(values: Array, rows: int, first: float) -> Array:
    """Return `values` (n,) moved down by `rows`, `first` standing above them."""
    return np.concatenate((np.full(rows, first), values))[: values.size]
