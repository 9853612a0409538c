"""What can be planted in a warm-up: the laws of design, written here a second time, with the planted values."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

Planted = dict[str, dict[str, Any]]
"""Effect name to its parameters, SI; a parameter "curve" of `ambient_drift` names one of `CURVES`."""

CURVES = {
    "sine": lambda t, T: math.sin(2 * math.pi * t / T),
    "ramp": lambda t, T: min(t / T, 1.0),
    "exponential": lambda t, T: 1 - math.exp(-t / T),
    "hump": lambda t, T: 0.5 * (1 - math.cos(2 * math.pi * t / T)),
}


@dataclass(frozen=True)
class ThermalTruth:
    """Planted effects."""

    planted: Planted = field(default_factory=dict)

    def _of(self, name: str, key: str, default: float) -> float:
        return float(self.planted.get(name, {}).get(key, default))

    def end_heats(self, rpm: float) -> tuple[float, float]:
        """Heat into the first and the last 10 mm [W]."""
        front = rear = 0.0
        if rpm > 0 and "motor_heat" in self.planted:
            power, at, share = (self._of("motor_heat", key, 0.0) for key in ("power", "at_speed", "share_at_rest"))
            front += power * (share + (1 - share) * rpm * math.pi / 30 / at)
        if rpm > 0 and "bearing_heat" in self.planted:
            torque = 5.39e-4 + 4.202e-5 * rpm ** (2 / 3)
            heat = self._of("bearing_heat", "factor", 0.0) * torque * rpm * math.pi / 30
            front, rear = front + heat, rear + self._of("bearing_heat", "rear_share", 0.0) * heat
        return front, rear

    def drift(self, time: float) -> float:
        """Rise of the surroundings [K]."""
        if "ambient_drift" not in self.planted:
            return 0.0
        drift = self.planted["ambient_drift"]
        return float(drift["amplitude"]) * CURVES[drift["curve"]](time, float(drift["period"]))

    def coolant(self, time: float) -> float:
        """Conductance to the coolant [W/K]."""
        return self._of("cooling", "conductance", 0.0) if time >= self._of("cooling", "start", 0.0) else 0.0

    def frame(self, position: float, time: float) -> float:
        """Growth of the frame [m]."""
        if "structure_growth" not in self.planted:
            return 0.0
        u, s = self._of("structure_growth", "growth", 0.0), self._of("structure_growth", "slope", 0.0)
        return (u + s * position) * (1 - math.exp(-time / self._of("structure_growth", "time_constant", 1.0)))

    @property
    def preload_growth(self) -> float:
        """Of the load torque [1/K]."""
        return self._of("preload_growth", "coefficient", 0.0)

    @property
    def viscosity(self) -> float:
        """Of the viscous torque [1/K]."""
        return self._of("viscosity_temperature", "coefficient", 0.0)

    @property
    def contact_factor(self) -> float:
        """On the contact conductance."""
        return self._of("contact_conductance_deviation", "factor", 1.0)

    @property
    def screw_film(self) -> float:
        """Factor on the film of the screw."""
        return self._film("screw")

    @property
    def nut_film(self) -> float:
        """Factor on the film of the nut."""
        return self._film("nut")

    def _film(self, part: str) -> float:
        where = self.planted.get("convection_deviation", {}).get("where", "")
        return self._of("convection_deviation", "factor", 1.0) if where in (part, "all") else 1.0

    @property
    def sink(self) -> tuple[float, float]:
        """Conductance [W/K] and capacity [J/K] of the mass on the nut."""
        return self._of("heat_sink", "conductance", 0.0), self._of("heat_sink", "capacity", 0.0)

    @property
    def lags(self) -> dict[str, float]:
        """Channel to the time constant of its sensor [s]."""
        lag = self.planted.get("sensor_lag")
        return {str(lag["channel"]): float(lag["time_constant"])} if lag else {}
