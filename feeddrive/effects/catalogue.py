"""Every effect by its name."""

from __future__ import annotations

import difflib

from feeddrive.effects.backlash import Backlash
from feeddrive.effects.ball_pass_ripple import BallPassRipple
from feeddrive.effects.base import Effect
from feeddrive.effects.channel_delay import ChannelDelay
from feeddrive.effects.constant_force import ConstantForce
from feeddrive.effects.coulomb_asymmetry import CoulombAsymmetry
from feeddrive.effects.drive_delay import DriveDelay
from feeddrive.effects.friction_deviation import FrictionDeviation
from feeddrive.effects.friction_vs_position import FrictionVsPosition
from feeddrive.effects.guide_friction import GuideFriction
from feeddrive.effects.inertia_deviation import InertiaDeviation
from feeddrive.effects.lead_error_cumulative import LeadErrorCumulative
from feeddrive.effects.lead_error_periodic import LeadErrorPeriodic
from feeddrive.effects.load_dependent_friction import LoadDependentFriction
from feeddrive.effects.nut_friction import NutFriction
from feeddrive.effects.payload import Payload
from feeddrive.effects.position_spring import PositionSpring
from feeddrive.effects.preload_loss import PreloadLoss
from feeddrive.effects.presliding import Presliding
from feeddrive.effects.shaft_drag import BearingDrag, NutDrag
from feeddrive.effects.stiffness_deviation import StiffnessDeviation
from feeddrive.effects.stiffness_vs_position import StiffnessVsPosition
from feeddrive.effects.stribeck import Stribeck
from feeddrive.effects.structural_mode import StructuralMode
from feeddrive.effects.tabulated_force import TabulatedForce
from feeddrive.effects.tabulated_friction import TabulatedFriction
from feeddrive.effects.tabulated_torque import TabulatedTorque
from feeddrive.effects.tabulated_travel import TabulatedTravel
from feeddrive.effects.thermal.ambient_drift import AmbientDrift
from feeddrive.effects.thermal.base import ThermalEffect
from feeddrive.effects.thermal.bearing_heat import BearingHeat
from feeddrive.effects.thermal.contact_conductance_deviation import ContactConductanceDeviation
from feeddrive.effects.thermal.convection_deviation import ConvectionDeviation
from feeddrive.effects.thermal.cooling import Cooling
from feeddrive.effects.thermal.heat_sink import HeatSink
from feeddrive.effects.thermal.motor_heat import MotorHeat
from feeddrive.effects.thermal.preload_growth import PreloadGrowth
from feeddrive.effects.thermal.sensor_lag import SensorLag
from feeddrive.effects.thermal.structure_growth import StructureGrowth
from feeddrive.effects.thermal.viscosity_temperature import ViscosityTemperature
from feeddrive.effects.thermal_growth import ThermalGrowth
from feeddrive.effects.torque_constant_droop import TorqueConstantDroop
from feeddrive.effects.torque_ripple import TorqueRipple
from feeddrive.effects.viscous_asymmetry import ViscousAsymmetry
from feeddrive.effects.viscous_warmup import ViscousWarmup
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
