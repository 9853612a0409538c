"""Temperature sensors of a compensation: where one can be mounted, its noise and its lag.

    τ ds/dt = y - s,    reading = s + noise

Mountable are the nut, a bearing (its housing) and every body attached to the machine: motor flange, housings, bed. The
screw turns, so that no sensor sits on it; neither growth nor a mean of the shaft is a reading. Where a body is attached
to a bearing's seat, the sensor goes on that body: the seat itself lies within it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from feeddrive.errors import InputError
from feeddrive.thermal.full.full_model import FRONT, NUT, REAR
from feeddrive.thermal.machine_heat import Heat
from feeddrive.thermal.rig import refuse_negative, refuse_unless_positive
from feeddrive.typing import FloatArray


@dataclass(frozen=True)
class Sensor:
    """A temperature sensor.

    Attributes:
        place: "nut", "front", "rear" or the name of a body.
        noise: standard deviation of a reading [K].
        lag: time constant τ [s]; 0 for a sensor that follows at once.
    """

    place: str
    noise: float = 0.03
    lag: float = 60.0

    def __post_init__(self) -> None:
        refuse_unless_positive(self.noise, "K", f"{self.place}.noise")
        refuse_negative(self.lag, "s", f"{self.place}.lag")


def mountable_places(heat: Heat) -> tuple[str, ...]:
    """Places of a plant where a sensor can be mounted."""
    covered = {body.port for body in heat.bodies}
    seats = tuple(seat for seat in (FRONT, REAR) if seat not in covered)
    return (NUT, *seats, *(body.name for body in heat.bodies))


def refuse_unmountable(heat: Heat, sensors: Sequence[Sensor]) -> None:
    """Refuse sensors where none can be mounted, or two at one place.

    Raises:
        InputError: says which places there are.
    """
    known = mountable_places(heat)
    for sensor in sensors:
        if sensor.place not in known:
            what = f'no sensor can be mounted at "{sensor.place}"'
            raise InputError(what, "sensors", f"the screw turns; choose among {', '.join(known)}")
    if len({sensor.place for sensor in sensors}) < len(sensors):
        raise InputError("two sensors at one place", "sensors", "name each place once")


def lagged(values: FloatArray, step: float, lag: float) -> FloatArray:
    """What a sensor of time constant `lag` shows of a temperature that runs straight from row to row.

    Args:
        values: at the end of each row, (k,) [K]; zero before the first, as is the sensor.
        step: length of a row [s].
        lag: τ [s].
    """
    if lag == 0:
        return np.array(values)
    kept, shown, before = math.exp(-step / lag), np.empty(len(values)), 0.0
    state = 0.0
    for i, value in enumerate(values):
        behind = lag * (value - before) / step
        state = kept * (state - before + behind) + value - behind
        shown[i], before = state, value
    return shown


def simulated_readings(
    rises: FloatArray, step: float, sensors: Sequence[Sensor], generator: np.random.Generator
) -> FloatArray:
    """Readings with lag and noise of true rises after each row of `step` [s], (k, m), as rises over the start [K]."""
    noise = generator.normal(size=np.shape(rises)) * np.array([sensor.noise for sensor in sensors])
    shown = [lagged(column, step, sensor.lag) for column, sensor in zip(rises.T, sensors, strict=True)]
    return np.asarray(np.array(shown).reshape(rises.T.shape).T + noise)
