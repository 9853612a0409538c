"""Forces on the table, masses and inertias."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

from tests.generator.constants import Constants
from tests.generator.effects.base import Effect, require


@dataclass(frozen=True)
class ConstantForce(Effect):
    """Force [N] on the table, positive against positive motion."""

    name: ClassVar[str] = "constant_force"
    size_keys: ClassVar[tuple[str, ...]] = ("force",)
    force: float

    def planted(self, constants: Constants) -> Constants:
        """Return `constants` with this effect in them."""
        return constants._replace(constant_force=self.force)


@dataclass(frozen=True)
class PositionSpring(Effect):
    """Force stiffness [N/m] * (x - zero [m]) on the table, against positive motion. Conservative."""

    name: ClassVar[str] = "position_spring"
    size_keys: ClassVar[tuple[str, ...]] = ("stiffness",)
    stiffness: float
    zero: float

    def planted(self, constants: Constants) -> Constants:
        """Return `constants` with this effect in them."""
        return constants._replace(spring_stiffness=self.stiffness, spring_zero=self.zero)


@dataclass(frozen=True)
class Payload(Effect):
    """Table mass greater by mass [kg]."""

    name: ClassVar[str] = "payload"
    size_keys: ClassVar[tuple[str, ...]] = ("mass",)
    mass: float

    def planted(self, constants: Constants) -> Constants:
        """Return `constants` with this effect in them; ValueError where no table mass is left."""
        require(constants.table_mass + self.mass > 0.0, self, "leaves no table mass")
        return constants._replace(table_mass=constants.table_mass + self.mass)


@dataclass(frozen=True)
class InertiaDeviation(Effect):
    """Inertia [kg m^2] added where = `motor` or `screw`."""

    name: ClassVar[str] = "inertia_deviation"
    size_keys: ClassVar[tuple[str, ...]] = ("inertia",)
    where: str
    inertia: float

    def __post_init__(self) -> None:
        """Refuse an unknown place."""
        require(self.where in ("motor", "screw"), self, f"where is motor or screw, not {self.where}")

    def planted(self, constants: Constants) -> Constants:
        """Return `constants` with this effect in them; ValueError where no inertia is left."""
        if self.where == "motor":
            constants = constants._replace(motor_inertia=constants.motor_inertia + self.inertia)
        else:
            constants = constants._replace(screw_inertia=constants.screw_inertia + self.inertia)
        require(min(constants.motor_inertia, constants.screw_inertia) > 0.0, self, "leaves no inertia")
        return constants


@dataclass(frozen=True)
class StructuralMode(Effect):
    """A further mass [kg] on the table through a spring; the table's own mass stays, the scale reads the table.

    frequency [Hz] and damping [1] are those of the mass with the table held: stiffness m w^2, damper 2 damping m w.
    """

    name: ClassVar[str] = "structural_mode"
    size_keys: ClassVar[tuple[str, ...]] = ("mass",)
    mass: float
    frequency: float
    damping: float

    def __post_init__(self) -> None:
        """Refuse what is no oscillator."""
        require(self.mass >= 0.0 and self.frequency > 0.0 and self.damping >= 0.0, self, "needs positive numbers")

    def planted(self, constants: Constants) -> Constants:
        """Return `constants` with this effect in them."""
        rate = 2.0 * math.pi * self.frequency
        return constants._replace(mode_mass=self.mass, mode_rate=rate, mode_damping=self.damping)
