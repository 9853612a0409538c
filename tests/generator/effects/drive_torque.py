"""Effects on the torque of the motor and on the drag of the screw."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from tests.generator.constants import Constants
from tests.generator.effects.base import Effect, require


@dataclass(frozen=True)
class TorqueRipple(Effect):
    """Resisting torque amplitude [N m] * sin(order * motor angle + phase [rad])."""

    name: ClassVar[str] = "torque_ripple"
    size_keys: ClassVar[tuple[str, ...]] = ("amplitude",)
    amplitude: float
    order: float
    phase: float = 0.0

    def planted(self, constants: Constants) -> Constants:
        """Return `constants` with this effect in them."""
        return constants._replace(ripple_amplitude=self.amplitude, ripple_order=self.order, ripple_phase=self.phase)


@dataclass(frozen=True)
class TorqueConstantDroop(Effect):
    """The torque that acts is T * (1 - share * (T / at_torque [N m])^2), T being the recorded command."""

    name: ClassVar[str] = "torque_constant_droop"
    size_keys: ClassVar[tuple[str, ...]] = ("share",)
    share: float
    at_torque: float

    def planted(self, constants: Constants) -> Constants:
        """Return `constants` with this effect in them."""
        return constants._replace(droop=self.share / self.at_torque**2)


@dataclass(frozen=True)
class BallPassRipple(Effect):
    """Coulomb level of the screw's drag + amplitude [N m] * sin(order * screw angle + phase [rad]).

    Part of the level, times tanh(w / drag speed): it resists (or, where the sine is negative, helps) motion either way.
    """

    name: ClassVar[str] = "ball_pass_ripple"
    size_keys: ClassVar[tuple[str, ...]] = ("amplitude",)
    amplitude: float
    order: float
    phase: float = 0.0

    def planted(self, constants: Constants) -> Constants:
        """Return `constants` with this effect in them."""
        return constants._replace(passing_amplitude=self.amplitude, passing_order=self.order, passing_phase=self.phase)


@dataclass(frozen=True)
class LoadDependentFriction(Effect):
    """Coulomb level of the screw's drag + coefficient * |F| * r.

    F: force in the nut, damper included; r = lead / 2 pi.
    """

    name: ClassVar[str] = "load_dependent_friction"
    size_keys: ClassVar[tuple[str, ...]] = ("coefficient",)
    coefficient: float

    def __post_init__(self) -> None:
        """Refuse a drag that would drive."""
        require(self.coefficient >= 0.0, self, "coefficient is not negative")

    def planted(self, constants: Constants) -> Constants:
        """Return `constants` with this effect in them."""
        return constants._replace(load_coefficient=self.coefficient)
