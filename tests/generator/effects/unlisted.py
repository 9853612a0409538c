"""What stands in no list of effects: forces on the table that a diagnosis has no name for."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from tests.generator.constants import Constants
from tests.generator.effects.base import Effect


@dataclass(frozen=True)
class Cogging(Effect):
    """Force [N] * sin(2 pi x / period [m] + phase [rad]) on the table, of a period that no screw has."""

    name: ClassVar[str] = "cogging"
    size_keys: ClassVar[tuple[str, ...]] = ("force",)
    force: float
    period: float
    phase: float = 0.0

    def planted(self, constants: Constants) -> Constants:
        """Return `constants` with this effect in them."""
        return constants._replace(cogging_force=self.force, cogging_period=self.period, cogging_phase=self.phase)


@dataclass(frozen=True)
class ForceSpot(Effect):
    """Force [N] * exp(-((x - centre) / half_width)^2), the same in both directions: a magnet, a spring stop."""

    name: ClassVar[str] = "force_spot"
    size_keys: ClassVar[tuple[str, ...]] = ("force",)
    force: float
    centre: float
    half_width: float

    def planted(self, constants: Constants) -> Constants:
        """Return `constants` with this effect in them."""
        return constants._replace(spot_force=self.force, spot_centre=self.centre, spot_half_width=self.half_width)


@dataclass(frozen=True)
class SquareDrag(Effect):
    """Drag coefficient [N s^2/m^2] * v |v|, as of oil that is churned."""

    name: ClassVar[str] = "square_drag"
    size_keys: ClassVar[tuple[str, ...]] = ("coefficient",)
    coefficient: float

    def planted(self, constants: Constants) -> Constants:
        """Return `constants` with this effect in them."""
        return constants._replace(square_drag=self.coefficient)


@dataclass(frozen=True)
class LaterFriction(Effect):
    """Coulomb friction [N] that sets in at a time [s] after the first sample: a wiper that folds over."""

    name: ClassVar[str] = "later_friction"
    size_keys: ClassVar[tuple[str, ...]] = ("force",)
    force: float
    time: float

    def planted(self, constants: Constants) -> Constants:
        """Return `constants` with this effect in them."""
        return constants._replace(later_friction=self.force, later_time=self.time)


@dataclass(frozen=True)
class CableDrag(Effect):
    """Friction force * s (1 - s), s from 0 to 1 over the stroke: against the motion, so a loop over the position."""

    name: ClassVar[str] = "cable_drag"
    size_keys: ClassVar[tuple[str, ...]] = ("force",)
    force: float

    def planted(self, constants: Constants) -> Constants:
        """Return `constants` with this effect in them."""
        return constants._replace(cable_drag=self.force)
