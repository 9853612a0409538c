"""Sensors of heat: which channel of a recording is read where."""

from __future__ import annotations

from dataclasses import dataclass

from feeddrive.thermal.full.full_model import FRONT, NUT, REAR, SHAFT, growth_name

CHANNELS = {
    NUT: "nut_temperature",
    FRONT: "front_bearing_temperature",
    REAR: "rear_bearing_temperature",
    SHAFT: "shaft_travel_temperature",
}
"""Outputs and their names in recordings where no sensor is declared; "growth_200mm" is "table_growth_200mm"."""

THERMOMETER, SCALE = "thermometer", "scale"
"""Kinds of sensors."""

PLACES = {"nut": NUT, "front": FRONT, "rear": REAR, "shaft": SHAFT}
"""Where a thermometer may sit: outer surface of the nut, surfaces of the seats, mean of the shaft over the travel."""


@dataclass(frozen=True)
class HeatSensor:
    """A sensor for temperature or growth.

    Attributes:
        channel: in recordings.
        kind: "thermometer", or "scale" for a growth of the table's position.
        at: "nut", "front", "rear" or "shaft"; of a growth the position of the nut [m].
        noise: rms, of the channel's SI unit; 0 where it is to be read off the recording.
    """

    channel: str
    kind: str
    at: str | float
    noise: float = 0.0

    @property
    def output(self) -> str:
        """Output of the thermal model that it reads."""
        return growth_name(self.at) if isinstance(self.at, float) else PLACES[self.at]
