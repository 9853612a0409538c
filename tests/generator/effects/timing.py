"""Effects on when the torque acts and when a channel is recorded."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from tests.generator.constants import Constants
from tests.generator.effects.base import Effect, require

LATENESS = {
    "motor_torque": "torque_lateness",
    "motor_angle": "angle_lateness",
    "table_position": "table_lateness",
}


@dataclass(frozen=True)
class DriveDelay(Effect):
    """The torque acts delay [s] later than recorded."""

    name: ClassVar[str] = "drive_delay"
    size_keys: ClassVar[tuple[str, ...]] = ("delay",)
    delay: float

    def __post_init__(self) -> None:
        """Refuse a torque that acts before it is asked for."""
        require(self.delay >= 0.0, self, "delay is not negative")

    def planted(self, constants: Constants) -> Constants:
        """Return `constants` with this effect in them."""
        return constants._replace(drive_delay=self.delay)


@dataclass(frozen=True)
class ChannelDelay(Effect):
    """One channel is recorded delay [s] late: its row at t holds what the quantity was at t - delay.

    channel: motor_torque, motor_angle or table_position. The controller is not concerned. The held torque late by a
    part of a sample means that the recorder reads the positions that much after the torque has changed.
    """

    name: ClassVar[str] = "channel_delay"
    size_keys: ClassVar[tuple[str, ...]] = ("delay",)
    channel: str
    delay: float

    def __post_init__(self) -> None:
        """Refuse an unknown channel and a reading of the future."""
        require(self.channel in LATENESS, self, f"channel is one of {', '.join(LATENESS)}, not {self.channel}")
        require(self.delay >= 0.0, self, "delay is not negative")

    def planted(self, constants: Constants) -> Constants:
        """Return `constants` with this effect in them."""
        return constants._replace(**{LATENESS[self.channel]: self.delay})
