"""Motor torque that acts later than recorded.

    T_acting(t) = T_recorded(t - d)

| symbol | key | meaning | unit |
|---|---|---|---|
| d | delay | negative where the recording itself is late; a simulation takes that as 0 | s |

The held torque is shifted in time as it is, not by a rational approximation.

A diagnosis names it where the torque acts later than it is recorded, as drives do, and leaves a torque that is recorded
late to `channel_delay`. It equals motor angle and table position both recorded late by d, which takes two effects, and
without a table position a late motor angle alone: the two are then listed together.
"""

from __future__ import annotations

from collections.abc import Mapping

from feeddrive.effects.base import Parameter, Port, Signature, TimingEffect
from feeddrive.typing import Expression


class DriveDelay(TimingEffect):
    """Delay between recorded and acting torque."""

    name = "drive_delay"
    words = "delay of the drive's torque"
    ports = (Port.MOTOR,)
    parameters = (Parameter("delay", "s", -0.1, 0.1, size=1e-4),)
    signature = Signature(("motor_torque",), "rate of the torque", ("channel_delay", "payload"))

    def delay(self, p: Mapping[str, Expression]) -> Expression:
        """Delay [s]."""
        return p["delay"]
