"""Kinds of coordinates in which values are fitted: scaled, logarithmic, components of a sine, heats, a middle force."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from feeddrive.effects.base import Effect, Value, number


@dataclass(frozen=True)
class Linear:
    """value = size * coordinate."""

    key: str
    size: float

    def read(self, effect: Effect) -> list[float]:
        """Coordinates of the effect's values."""
        value = effect.values[self.key]
        return [number / self.size for number in (value if isinstance(value, tuple) else (value,))]

    def write(self, effect: Effect, coordinates: Sequence[float]) -> dict[str, Value]:
        """Values of the coordinates."""
        parameter = effect.parameter(self.key)
        numbers = [min(max(c * self.size, parameter.minimum), parameter.maximum) for c in coordinates]
        if not isinstance(effect.values[self.key], tuple):
            return {self.key: numbers[0]}
        if self.key != "delta_force":
            return {self.key: tuple(numbers)}
        # a curve over the stroke keeps its level: another one would be another level of the declared friction
        level = sum(self.read(effect)) * self.size
        more = (sum(numbers) - level) / len(numbers)
        return {self.key: tuple(number - more for number in numbers)}


@dataclass(frozen=True)
class Logarithmic:
    """value = exp(coordinate)."""

    key: str

    def read(self, effect: Effect) -> list[float]:
        """Coordinates of the effect's values."""
        return [math.log(number(effect.values[self.key]))]

    def write(self, effect: Effect, coordinates: Sequence[float]) -> dict[str, Value]:
        """Values of the coordinates."""
        parameter = effect.parameter(self.key)
        value = math.exp(min(max(coordinates[0], -700.0), 700.0))
        return {self.key: min(max(value, parameter.minimum), parameter.maximum)}


@dataclass(frozen=True)
class Sine:
    """amplitude and phase as the two components of the sine at an angle m of its shaft, in the middle of the stroke.

    phase at m = phase + order m. A stroke of some turns that lies forty turns from zero tells that phase; that at zero
    goes by 2 pi 40 with the order, and a step along its components leads out of where their slopes hold.
    """

    size: float
    middle: float

    def read(self, effect: Effect) -> list[float]:
        """Coordinates of the effect's values."""
        values = effect.values
        amplitude, phase = number(values["amplitude"]), number(values["phase"]) + number(values["order"]) * self.middle
        return [amplitude * math.cos(phase) / self.size, amplitude * math.sin(phase) / self.size]

    def write(self, effect: Effect, coordinates: Sequence[float]) -> dict[str, Value]:
        """Values of the coordinates, the order being that of the effect."""
        a, b = coordinates
        most = effect.parameter("amplitude").maximum
        phase = math.atan2(b, a) - number(effect.values["order"]) * self.middle
        return {"amplitude": min(self.size * math.hypot(a, b), most), "phase": math.remainder(phase, math.tau)}


@dataclass(frozen=True)
class Order:
    """order = size * coordinate, the sine being as it is in the middle of the stroke (`Sine`)."""

    size: float
    middle: float
    key: str = "order"

    def read(self, effect: Effect) -> list[float]:
        """Coordinate of the effect's order."""
        return [number(effect.values[self.key]) / self.size]

    def write(self, effect: Effect, coordinates: Sequence[float]) -> dict[str, Value]:
        """Order of the coordinate, and the phase that it has at an angle of zero."""
        parameter = effect.parameter(self.key)
        order = min(max(coordinates[0] * self.size, parameter.minimum), parameter.maximum)
        turned = (number(effect.values[self.key]) - order) * self.middle
        return {self.key: order, "phase": math.remainder(number(effect.values["phase"]) + turned, math.tau)}


@dataclass(frozen=True)
class TwoHeats:
    """Two heats that are linear in the prediction, in place of a heat and a share of it.

    A motor's P a and P (1 - a): with `rest`. Two bearings' c and c s: without.
    """

    key: str
    share: str
    size: float
    rest: bool

    def read(self, effect: Effect) -> list[float]:
        """Coordinates of the effect's values."""
        whole, share = number(effect.values[self.key]) / self.size, number(effect.values[self.share])
        return [whole * share, whole * (1 - share)] if self.rest else [whole, whole * share]

    def write(self, effect: Effect, coordinates: Sequence[float]) -> dict[str, Value]:
        """Values of the coordinates, neither heat below zero."""
        first, second = (max(c, 0.0) for c in coordinates)
        whole = first + second if self.rest else first
        over = whole if whole > 0 else 1.0
        share = min((first if self.rest else second) / over, effect.parameter(self.share).maximum)
        return {self.key: whole * self.size, self.share: share}


@dataclass(frozen=True)
class MiddleForce:
    """Force of a spring in the middle m of the stroke, k (m - zero), in place of its zero, which may be far off.

    The force on the table, k (x - m) + k (m - zero), is linear in it and in the stiffness, and where there is no more
    than a constant force the stiffness alone is idle.
    """

    size: float
    middle: float
    key: str = "zero"

    def read(self, effect: Effect) -> list[float]:
        """Coordinates of the effect's values."""
        return [number(effect.values["stiffness"]) * (self.middle - number(effect.values["zero"])) / self.size]

    def write(self, effect: Effect, coordinates: Sequence[float]) -> dict[str, Value]:
        """Values of the coordinates."""
        stiffness = number(effect.values["stiffness"])
        softest = math.copysign(max(abs(stiffness), SOFTEST), stiffness)
        return {"zero": self.middle - coordinates[0] * self.size / softest}


SOFTEST = 1e-9
"""Stiffness [N/m] of a spring that is a force alone: its zero still is a number."""


Coordinate = Linear | Logarithmic | Sine | Order | TwoHeats | MiddleForce
