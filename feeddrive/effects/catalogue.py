"""Every effect by its name."""

from __future__ import annotations

import difflib

from feeddrive.effects.base import Effect
from feeddrive.effects.chain.inertia_deviation import InertiaDeviation
from feeddrive.effects.chain.payload import Payload
from feeddrive.effects.chain.stiffness_deviation import StiffnessDeviation
from feeddrive.effects.chain.structural_mode import StructuralMode
from feeddrive.effects.friction.coulomb_asymmetry import CoulombAsymmetry
from feeddrive.effects.friction.friction_deviation import FrictionDeviation
from feeddrive.effects.friction.friction_vs_position import FrictionVsPosition
from feeddrive.effects.friction.guide_friction import GuideFriction
from feeddrive.effects.friction.load_dependent_friction import LoadDependentFriction
from feeddrive.effects.friction.nut_friction import NutFriction
from feeddrive.effects.friction.presliding import Presliding
from feeddrive.effects.friction.shaft_drag import BearingDrag, NutDrag
from feeddrive.effects.friction.stribeck import Stribeck
from feeddrive.effects.friction.viscous_asymmetry import ViscousAsymmetry
from feeddrive.effects.friction.viscous_warmup import ViscousWarmup
from feeddrive.effects.heat.ambient_drift import AmbientDrift
from feeddrive.effects.heat.bearing_heat import BearingHeat
from feeddrive.effects.heat.contact_conductance_deviation import ContactConductanceDeviation
from feeddrive.effects.heat.convection_deviation import ConvectionDeviation
from feeddrive.effects.heat.cooling import Cooling
from feeddrive.effects.heat.heat_sink import HeatSink
from feeddrive.effects.heat.motor_heat import MotorHeat
from feeddrive.effects.heat.preload_growth import PreloadGrowth
from feeddrive.effects.heat.sensor_lag import SensorLag
from feeddrive.effects.heat.structure_growth import StructureGrowth
from feeddrive.effects.heat.thermal_effect import ThermalEffect
from feeddrive.effects.heat.viscosity_temperature import ViscosityTemperature
from feeddrive.effects.source.ball_pass_ripple import BallPassRipple
from feeddrive.effects.source.constant_force import ConstantForce
from feeddrive.effects.source.position_spring import PositionSpring
from feeddrive.effects.source.torque_constant_droop import TorqueConstantDroop
from feeddrive.effects.source.torque_ripple import TorqueRipple
from feeddrive.effects.tabulated import TabulatedForce, TabulatedFriction, TabulatedTorque, TabulatedTravel
from feeddrive.effects.timing.channel_delay import ChannelDelay
from feeddrive.effects.timing.drive_delay import DriveDelay
from feeddrive.effects.transmission.backlash import Backlash
from feeddrive.effects.transmission.preload_loss import PreloadLoss
from feeddrive.effects.transmission.stiffness_vs_position import StiffnessVsPosition
from feeddrive.effects.travel.lead_error_cumulative import LeadErrorCumulative
from feeddrive.effects.travel.lead_error_periodic import LeadErrorPeriodic
from feeddrive.effects.travel.thermal_growth import ThermalGrowth
from feeddrive.errors import InputError

EFFECTS: dict[str, type[Effect]] = {
    effect.name: effect
    for effect in (
        GuideFriction,
        NutDrag,
        BearingDrag,
        NutFriction,
        CoulombAsymmetry,
        ViscousAsymmetry,
        Stribeck,
        Presliding,
        FrictionVsPosition,
        FrictionDeviation,
        LoadDependentFriction,
        ViscousWarmup,
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
        TabulatedForce,
        TabulatedTorque,
        TabulatedFriction,
        TabulatedTravel,
    )
}
"""Effect name to class: effects on motion and force."""

THERMAL_EFFECTS: dict[str, type[ThermalEffect]] = {
    effect.name: effect
    for effect in (
        MotorHeat,
        BearingHeat,
        AmbientDrift,
        PreloadGrowth,
        ViscosityTemperature,
        Cooling,
        ConvectionDeviation,
        ContactConductanceDeviation,
        HeatSink,
        StructureGrowth,
        SensorLag,
    )
}
"""Effect name to class: effects on temperatures and growth."""


def find_effect(name: str, where: str = "") -> type[Effect]:
    """The effect of that name.

    Raises:
        InputError: no such effect; names the nearest.
    """
    if name in EFFECTS:
        return EFFECTS[name]
    near = difflib.get_close_matches(name, EFFECTS, n=1, cutoff=0.4)
    mend = f"did you mean {near[0]}?" if near else f"known are {', '.join(EFFECTS)}"
    raise InputError(f"unknown effect {name!r}", where, mend)
