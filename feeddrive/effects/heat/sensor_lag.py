"""A sensor that follows late.

    τ dy/dt = θ - y,    y = θ at the start

| symbol | key | meaning | unit |
|---|---|---|---|
| τ | time_constant | of the sensor | s |
| | channel | whose sensor | |
| θ, y | | what is there, what is read | degC or m |
"""

from __future__ import annotations

from collections.abc import Mapping

from feeddrive.effects.base import Parameter, Signature
from feeddrive.effects.heat.thermal_effect import ThermalEffect
from feeddrive.typing import Expression


class SensorLag(ThermalEffect):
    """First-order lag of one channel."""

    name = "sensor_lag"
    words = "lag of a sensor"
    parameters = (Parameter("time_constant", "s", 0.0, 1e6, size=60.0),)
    signature = Signature(("nut_temperature", "front_bearing_temperature"), "rate of one channel", ("heat_sink",))
    place_key = "channel"
    repeatable = True

    def lag(self, channel: str, p: Mapping[str, Expression]) -> Expression:
        """Time constant of this channel's sensor [s]."""
        return p["time_constant"] if channel == self.place else 0.0
