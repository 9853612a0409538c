"""The effects that can be planted: one frozen class each, by what they act on."""

from __future__ import annotations

from dataclasses import dataclass

from tests.generator.constants import Constants
from tests.generator.effects.base import Effect
from tests.generator.effects.drive_torque import (
    BallPassRipple,
    LoadDependentFriction,
    TorqueConstantDroop,
    TorqueRipple,
)
from tests.generator.effects.guide_friction import (
    CoulombAsymmetry,
    FrictionDeviation,
    FrictionVsPosition,
    Presliding,
    Stribeck,
    ViscousAsymmetry,
    ViscousWarmup,
)
from tests.generator.effects.nut_travel import (
    Backlash,
    LeadErrorCumulative,
    LeadErrorPeriodic,
    PreloadLoss,
    StiffnessDeviation,
    StiffnessVsPosition,
    ThermalGrowth,
)
from tests.generator.effects.table_force import (
    ConstantForce,
    InertiaDeviation,
    Payload,
    PositionSpring,
    StructuralMode,
)
from tests.generator.effects.timing import ChannelDelay, DriveDelay

EFFECT_CLASSES: tuple[type[Effect], ...] = (
    CoulombAsymmetry,
    ViscousAsymmetry,
    Stribeck,
    Presliding,
    FrictionVsPosition,
    ViscousWarmup,
    FrictionDeviation,
    LoadDependentFriction,
    TorqueRipple,
    BallPassRipple,
    TorqueConstantDroop,
    ConstantForce,
    PositionSpring,
    Backlash,
    LeadErrorPeriodic,
    LeadErrorCumulative,
    ThermalGrowth,
    StiffnessDeviation,
    StiffnessVsPosition,
    PreloadLoss,
    Payload,
    InertiaDeviation,
    StructuralMode,
    DriveDelay,
    ChannelDelay,
)
"""In the order of the effect table."""

__all__ = [
    "EFFECT_CLASSES",
    "Backlash",
    "BallPassRipple",
    "ChannelDelay",
    "ConstantForce",
    "CoulombAsymmetry",
    "DriveDelay",
    "Effect",
    "FrictionDeviation",
    "FrictionVsPosition",
    "InertiaDeviation",
    "LeadErrorCumulative",
    "LeadErrorPeriodic",
    "LoadDependentFriction",
    "Payload",
    "PlantedEffects",
    "PositionSpring",
    "PreloadLoss",
    "Presliding",
    "StiffnessDeviation",
    "StiffnessVsPosition",
    "Stribeck",
    "StructuralMode",
    "ThermalGrowth",
    "TorqueConstantDroop",
    "TorqueRipple",
    "ViscousAsymmetry",
    "ViscousWarmup",
]


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
