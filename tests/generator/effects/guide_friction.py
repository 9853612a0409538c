"""Effects on the friction of the guide, and on declared friction at either port."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Self

from tests.generator.constants import Constants
from tests.generator.effects.base import Effect, require


@dataclass(frozen=True)
class CoulombAsymmetry(Effect):
    """Coulomb level greater by delta_force [N] for v > 0."""

    name: ClassVar[str] = "coulomb_asymmetry"
    size_keys: ClassVar[tuple[str, ...]] = ("delta_force",)
    delta_force: float

    def planted(self, constants: Constants) -> Constants:
        """Return `constants` with this effect in them."""
        return constants._replace(coulomb_asymmetry=self.delta_force)


@dataclass(frozen=True)
class ViscousAsymmetry(Effect):
    """Viscous coefficient greater by delta_viscous [N s/m] for v > 0."""

    name: ClassVar[str] = "viscous_asymmetry"
    size_keys: ClassVar[tuple[str, ...]] = ("delta_viscous",)
    delta_viscous: float

    def planted(self, constants: Constants) -> Constants:
        """Return `constants` with this effect in them."""
        return constants._replace(viscous_asymmetry=self.delta_viscous)


@dataclass(frozen=True)
class Stribeck(Effect):
    """Coulomb level + delta_force [N] * exp(-(v / velocity [m/s])^2)."""

    name: ClassVar[str] = "stribeck"
    size_keys: ClassVar[tuple[str, ...]] = ("delta_force",)
    delta_force: float
    velocity: float

    def planted(self, constants: Constants) -> Constants:
        """Return `constants` with this effect in them."""
        return constants._replace(stribeck_force=self.delta_force, stribeck_velocity=self.velocity)


@dataclass(frozen=True)
class Presliding(Effect):
    """Elasto-plastic bristle (Dupont and others 2000) in place of tanh: stiffness [N/m], damping [N s/m].

    break_away is the share of the sliding deflection up to which the bristle is purely elastic.
    The softer the bristle, the larger the effect.
    """

    name: ClassVar[str] = "presliding"
    size_keys: ClassVar[tuple[str, ...]] = ("stiffness",)
    stiffness: float
    damping: float = 4000.0
    break_away: float = 0.8

    def planted(self, constants: Constants) -> Constants:
        """Return `constants` with this effect in them."""
        return constants._replace(
            bristle_stiffness=self.stiffness, bristle_damping=self.damping, break_away=self.break_away
        )

    def scaled(self, factor: float) -> Self:
        """Return the effect with `factor` times the sliding deflection."""
        return super().scaled(1.0 / factor)


@dataclass(frozen=True)
class FrictionVsPosition(Effect):
    """Coulomb level + peak [N] * exp(-((x - centre) / half_width)^2), lengths in m."""

    name: ClassVar[str] = "friction_vs_position"
    size_keys: ClassVar[tuple[str, ...]] = ("peak",)
    peak: float
    centre: float
    half_width: float

    def planted(self, constants: Constants) -> Constants:
        """Return `constants` with this effect in them."""
        return constants._replace(bump_peak=self.peak, bump_centre=self.centre, bump_half_width=self.half_width)


@dataclass(frozen=True)
class ViscousWarmup(Effect):
    """Viscous drag of a port (`table` or `screw`) times 1 - share * (1 - exp(-t / time_constant [s])).

    t counts from the first sample. At the table it acts on the whole viscous force, an asymmetry included; at the
    screw on the nut's power law.
    """

    name: ClassVar[str] = "viscous_warmup"
    size_keys: ClassVar[tuple[str, ...]] = ("share",)
    port: str
    share: float
    time_constant: float

    def __post_init__(self) -> None:
        """Refuse an unknown port and a drag that would drive."""
        require(self.port in ("table", "screw"), self, f"port is table or screw, not {self.port}")
        require(self.share <= 1.0 and self.time_constant > 0.0, self, "share is at most 1, time_constant above 0")

    def planted(self, constants: Constants) -> Constants:
        """Return `constants` with this effect in them."""
        if self.port == "table":
            return constants._replace(guide_warmup=self.share, warmup_time=self.time_constant)
        return constants._replace(nut_warmup=self.share, warmup_time=self.time_constant)


@dataclass(frozen=True)
class FrictionDeviation(Effect):
    """Declared Coulomb and viscous friction of a port (`table` or `screw`) multiplied by the factors."""

    name: ClassVar[str] = "friction_deviation"
    size_keys: ClassVar[tuple[str, ...]] = ("coulomb_factor", "viscous_factor")
    neutral: ClassVar[float] = 1.0
    port: str
    coulomb_factor: float = 1.0
    viscous_factor: float = 1.0

    def __post_init__(self) -> None:
        """Refuse an unknown port and a friction that would drive."""
        require(self.port in ("table", "screw"), self, f"port is table or screw, not {self.port}")
        require(min(self.coulomb_factor, self.viscous_factor) >= 0.0, self, "factors are not negative")

    def planted(self, constants: Constants) -> Constants:
        """Return `constants` with this effect in them."""
        if self.port == "table":
            return constants._replace(
                guide_coulomb=constants.guide_coulomb * self.coulomb_factor,
                guide_viscous=constants.guide_viscous * self.viscous_factor,
            )
        return constants._replace(
            nut_coulomb=constants.nut_coulomb * self.coulomb_factor,
            bearing_coulomb=constants.bearing_coulomb * self.coulomb_factor,
            nut_power=constants.nut_power * self.viscous_factor,
        )
