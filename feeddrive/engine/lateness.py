"""Channels that are recorded late (`channel_delay`): what they held a while ago, read between the ticks.

A position d ago is read off the cubic through position and velocity of the two ticks about it, which misses it by
h^4/384 of its fourth derivative: below 0.1 nm at 8 kHz for an axis that rings at 500 Hz with 10 m/s^2. A torque is told
as its mean over a tick; the mean d ago is that over the two ticks about it, weighted by what the interval has of each.

| symbol | meaning | unit |
|---|---|---|
| d = k h - f h | delay, in whole ticks rounded up and the rest of one | s |
| h | tick | s |
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from feeddrive.effects.timing.channel_delay import ChannelDelay, lateness
from feeddrive.plant.plant import Plant
from feeddrive.servo.sampled_plant import SPLIT
from feeddrive.typing import FloatArray

RATES = {"motor_angle": "motor_speed", "table_position": "table_velocity"}
"""Positions and the channels that are their rates."""


@dataclass(frozen=True)
class LateChannels:
    """Channels that are recorded late, and what they held last.

    Attributes:
        delays: channel to its delay [s].
        tick: h [s].
        before: channel, and what its rate is called, to the values of the ticks before now, as many as are needed.
    """

    delays: Mapping[str, float]
    tick: float
    before: Mapping[str, FloatArray]

    @classmethod
    def at_rest(cls, plant: Plant, tick: float, first: Mapping[str, float]) -> LateChannels:
        """Late channels of an axis that has been standing, and holding what it now reads.

        Args:
            plant: whose effects count.
            tick: [s].
            first: channel to what it reads now, SI; 0 where it is not given.
        """
        names = dict.fromkeys(effect.place for effect in plant.effects_of(ChannelDelay))
        delays = {name: lateness(plant.effects, name) for name in names}
        before: dict[str, FloatArray] = {}
        for name, delay in delays.items():
            held = np.full(_ticks(delay, tick)[0], first.get(name, 0.0))
            before[name] = held
            if name in RATES:
                before[RATES[name]] = np.zeros_like(held)
        return cls(delays, tick, before)

    def read(self, series: Mapping[str, FloatArray]) -> tuple[dict[str, FloatArray], LateChannels]:
        """Late channels at some ticks, (n,), and what is held after them; `motor_torque` comes as means of ticks."""
        known = {name: np.concatenate([held, series[name]]) for name, held in self.before.items()}
        late = {name: self._late(name, known) for name in self.delays}
        after = {name: values[len(values) - len(self.before[name]) :] for name, values in known.items()}
        return late, LateChannels(self.delays, self.tick, after)

    def _late(self, name: str, known: Mapping[str, FloatArray]) -> FloatArray:
        ticks, rest = _ticks(self.delays[name], self.tick)
        values = known[name]
        count = len(values) - ticks
        if not rest:
            return values[:count]
        first, second = values[:count], values[1 : count + 1]
        if name not in RATES:
            return (1 - rest) * first + rest * second
        rates = self.tick * known[RATES[name]]
        return _hermite(rest, first, second, rates[:count], rates[1 : count + 1])

    @property
    def vector(self) -> FloatArray:
        """What is held, as plain numbers; see `resumed`."""
        return np.concatenate([np.zeros(0), *self.before.values()])

    def resumed(self, vector: FloatArray) -> LateChannels:
        """Channels like these that hold what `vector` says."""
        held, at = {}, 0
        for name, values in self.before.items():
            held[name] = vector[at : at + len(values)]
            at += len(values)
        return LateChannels(self.delays, self.tick, held)


def late_mean(torque: FloatArray, sample: float, delay: float) -> FloatArray:
    """A torque held over every sample [s] as it is recorded `delay` [s] late: means over the late intervals, (n,)."""
    channels = LateChannels({"motor_torque": delay}, sample, {"motor_torque": np.zeros(_ticks(delay, sample)[0])})
    return channels.read({"motor_torque": torque})[0]["motor_torque"]


def _ticks(delay: float, tick: float) -> tuple[int, float]:
    """k and f: whole ticks to go back, and the part of a tick to come forward again."""
    ticks = math.ceil(delay / tick - SPLIT)
    rest = ticks - delay / tick
    return ticks, rest if rest > SPLIT else 0.0


def _hermite(part: float, first: FloatArray, second: FloatArray, rise: FloatArray, last: FloatArray) -> FloatArray:
    """The cubic with these values and rates per tick at both ends of a tick, at a part of it."""
    steep = 3 * (second - first) - 2 * rise - last
    bend = rise + last - 2 * (second - first)
    return first + part * (rise + part * (steep + part * bend))
