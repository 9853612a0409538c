"""One channel that is sampled later than the others: a slower input, a filter, a bus cycle.

    y_recorded(t) = y(t - d)

| symbol | key | meaning | unit |
|---|---|---|---|
| d | delay | by which the channel is late; its row at t holds what the quantity was at t - d | s |
| y | channel | motor_torque, motor_angle or table_position | |

It acts on the recording alone: the controller reads its sensors in time, and equations of motion, frequency responses
and exported models know nothing of it. A held torque that is late by part of a sample is recorded as its mean over the
late interval. Before the start a late channel holds its first value.

What can be distinguished. Three channels have two relative delays, and a delay is never negative, so that each sign has
one name:

* torque late against both positions: `channel_delay` of motor_torque. `drive_delay` with the other sign would say the
  same, but a torque that acts before it is asked for is none;
* torque early against both positions: `drive_delay`, since drives do act late. Both positions read late by the same
  time would look alike; those are two delays, and one is taken;
* motor angle late: table and torque both seem early. Without a table position this is `drive_delay` to the last digit,
  which is then named, and `channel_delay` is listed with it;
* table position late: the opposite sign of a late motor angle, so that these two are never confused.

Source: the convention is that of the recording contract, positions read at t_i, torque acting from t_i to t_(i+1).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from feeddrive.effects.base import Effect, Kind, Parameter, Port, Signature
from feeddrive.typing import Expression


class ChannelDelay(Effect):
    """Delay of one recorded channel."""

    name = "channel_delay"
    words = "delay of a recorded channel"
    kind = Kind.TIMING
    ports = (Port.SENSOR,)
    parameters = (Parameter("delay", "s", 0.0, 0.1, size=1e-4),)
    signature = Signature(("table_position", "motor_torque"), "rate of one channel", ("drive_delay",))
    place_key = "channel"
    places = ("motor_torque", "motor_angle", "table_position")
    repeatable = True
    additive = True

    def delay(self, channel: str, p: Mapping[str, Expression]) -> Expression:
        """By how much a channel is late [s]."""
        return p["delay"] if channel == self.place else 0.0


def lateness(effects: Sequence[Effect], channel: str) -> float:
    """By how much a channel is recorded late, all effects together [s]."""
    return float(sum(e.delay(channel, e.values) for e in effects if isinstance(e, ChannelDelay)))
