"""The effects that can be planted: one frozen class each, named and parametrised as the project's effect table says.

Every class has `name` and `planted(constants)`, which returns the constants with the effect in them.
Friction and forces are positive when they resist positive motion.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Protocol

from tests.generator.constants import Constants


class Effect(Protocol):
    """Anything that can be planted."""

    name: ClassVar[str]

    def planted(self, constants: Constants) -> Constants:
        """Return `constants` with this effect in them."""


@dataclass(frozen=True)
class CoulombAsymmetry:
    """Coulomb level greater by delta_force [N] for v > 0."""

    name: ClassVar[str] = "coulomb_asymmetry"
    delta_force: float

    def planted(self, constants: Constants) -> Constants:
        """Return `constants` with this effect in them."""
        return constants._replace(coulomb_asymmetry=self.delta_force)


@dataclass(frozen=True)
class ViscousAsymmetry:
    """Viscous coefficient greater by delta_viscous [N s/m] for v > 0."""

    name: ClassVar[str] = "viscous_asymmetry"
    delta_viscous: float

    def planted(self, constants: Constants) -> Constants:
        """Return `constants` with this effect in them."""
        return constants._replace(viscous_asymmetry=self.delta_viscous)


@dataclass(frozen=True)
class Stribeck:
    """Coulomb level + delta_force [N] * exp(-(v / velocity [m/s])^2)."""

    name: ClassVar[str] = "stribeck"
    delta_force: float
    velocity: float

    def planted(self, constants: Constants) -> Constants:
        """Return `constants` with this effect in them."""
        return constants._replace(stribeck_force=self.delta_force, stribeck_velocity=self.velocity)


@dataclass(frozen=True)
class Presliding:
    """Elasto-plastic bristle (Dupont and others 2000) in place of tanh: stiffness [N/m], damping [N s/m].

    break_away is the share of the sliding deflection up to which the bristle is purely elastic.
    """

    name: ClassVar[str] = "presliding"
    stiffness: float
    damping: float = 4000.0
    break_away: float = 0.8

    def planted(self, constants: Constants) -> Constants:
        """Return `constants` with this effect in them."""
        return constants._replace(
            bristle_stiffness=self.stiffness, bristle_damping=self.damping, break_away=self.break_away
        )


@dataclass(frozen=True)
class FrictionVsPosition:
    """Coulomb level + peak [N] * exp(-((x - centre) / half_width)^2), lengths in m."""

    name: ClassVar[str] = "friction_vs_position"
    peak: float
    centre: float
    half_width: float

    def planted(self, constants: Constants) -> Constants:
        """Return `constants` with this effect in them."""
        return constants._replace(bump_peak=self.peak, bump_centre=self.centre, bump_half_width=self.half_width)


@dataclass(frozen=True)
class TorqueRipple:
    """Resisting torque amplitude [N m] * sin(order * motor angle + phase [rad])."""

    name: ClassVar[str] = "torque_ripple"
    amplitude: float
    order: float
    phase: float = 0.0

    def planted(self, constants: Constants) -> Constants:
        """Return `constants` with this effect in them."""
        return constants._replace(ripple_amplitude=self.amplitude, ripple_order=self.order, ripple_phase=self.phase)


@dataclass(frozen=True)
class ConstantForce:
    """Force [N] on the table, positive against positive motion."""

    name: ClassVar[str] = "constant_force"
    force: float

    def planted(self, constants: Constants) -> Constants:
        """Return `constants` with this effect in them."""
        return constants._replace(constant_force=self.force)


@dataclass(frozen=True)
class Backlash:
    """Free play of total width [m] between nut and table."""

    name: ClassVar[str] = "backlash"
    width: float

    def planted(self, constants: Constants) -> Constants:
        """Return `constants` with this effect in them."""
        return constants._replace(gap=self.width)


@dataclass(frozen=True)
class LeadErrorPeriodic:
    """Travel error amplitude [m] * sin(order * screw angle + phase [rad])."""

    name: ClassVar[str] = "lead_error_periodic"
    amplitude: float
    order: float
    phase: float = 0.0

    def planted(self, constants: Constants) -> Constants:
        """Return `constants` with this effect in them."""
        return constants._replace(travel_amplitude=self.amplitude, travel_order=self.order, travel_phase=self.phase)


@dataclass(frozen=True)
class Payload:
    """Table mass greater by mass [kg]."""

    name: ClassVar[str] = "payload"
    mass: float

    def planted(self, constants: Constants) -> Constants:
        """Return `constants` with this effect in them."""
        return constants._replace(table_mass=constants.table_mass + self.mass)


@dataclass(frozen=True)
class DriveDelay:
    """The torque acts delay [s] later than recorded."""

    name: ClassVar[str] = "drive_delay"
    delay: float

    def planted(self, constants: Constants) -> Constants:
        """Return `constants` with this effect in them."""
        return constants._replace(drive_delay=self.delay)


@dataclass(frozen=True)
class FrictionDeviation:
    """Declared Coulomb and viscous friction of a port (`table` or `screw`) multiplied by the factors."""

    name: ClassVar[str] = "friction_deviation"
    port: str
    coulomb_factor: float = 1.0
    viscous_factor: float = 1.0

    def planted(self, constants: Constants) -> Constants:
        """Return `constants` with this effect in them; raise ValueError for a port without friction."""
        if self.port == "table":
            return constants._replace(
                guide_coulomb=constants.guide_coulomb * self.coulomb_factor,
                guide_viscous=constants.guide_viscous * self.viscous_factor,
            )
        if self.port != "screw":
            raise ValueError(f"friction_deviation: port is table or screw, not {self.port}")
        return constants._replace(
            nut_coulomb=constants.nut_coulomb * self.coulomb_factor,
            bearing_coulomb=constants.bearing_coulomb * self.coulomb_factor,
            nut_power=constants.nut_power * self.viscous_factor,
        )


EFFECT_CLASSES = (
    CoulombAsymmetry,
    ViscousAsymmetry,
    Stribeck,
    Presliding,
    FrictionVsPosition,
    TorqueRipple,
    ConstantForce,
    Backlash,
    LeadErrorPeriodic,
    Payload,
    DriveDelay,
    FrictionDeviation,
)


@dataclass(frozen=True)
class PlantedEffects:
    """The effects of one recording, none or several, each name at most once (ValueError otherwise)."""

    effects: tuple[Effect, ...] = ()

    def __post_init__(self) -> None:
        """Refuse the same effect twice, because the second would replace the first."""
        names = [effect.name for effect in self.effects]
        if len(set(names)) < len(names):
            raise ValueError(f"an effect is planted twice: {names}")

    def planted(self, constants: Constants) -> Constants:
        """Return `constants` with all effects in them."""
        for effect in self.effects:
            constants = effect.planted(constants)
        return constants
