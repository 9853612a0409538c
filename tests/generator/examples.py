"""One example of every effect for an axis, of a size that a service engineer would meet."""

from __future__ import annotations

from tests.generator import effects as planted
from tests.generator.axis import AxisParameters
from tests.generator.effects import Effect


def examples(axis: AxisParameters) -> tuple[Effect, ...]:
    """Return one or two examples of every effect, scaled to the friction, torque and stroke of `axis`."""
    return (*_friction(axis), *_torque(axis), *_table(axis), *_transmission(axis), *_timing())


def _friction(axis: AxisParameters) -> tuple[Effect, ...]:
    level, stroke = axis.guide_coulomb, axis.stroke_high - axis.stroke_low
    return (
        planted.CoulombAsymmetry(delta_force=0.25 * level),
        planted.ViscousAsymmetry(delta_viscous=-0.3 * axis.guide_viscous),
        planted.Stribeck(delta_force=-0.35 * level, velocity=6e-3),
        planted.Presliding(stiffness=9e4 * level),
        planted.FrictionVsPosition(0.6 * level, axis.stroke_low + 0.6 * stroke, 0.13 * stroke),
        planted.ViscousWarmup(port="table", share=0.5, time_constant=4.0),
        planted.ViscousWarmup(port="screw", share=0.5, time_constant=4.0),
        planted.FrictionDeviation(port="table", coulomb_factor=1.25, viscous_factor=0.8),
        planted.FrictionDeviation(port="screw", coulomb_factor=0.7, viscous_factor=1.3),
    )


def _torque(axis: AxisParameters) -> tuple[Effect, ...]:
    drag = axis.nut_coulomb + axis.bearing_coulomb
    return (
        planted.LoadDependentFriction(coefficient=0.08),
        planted.TorqueRipple(amplitude=0.25 * drag, order=6.0, phase=0.7),
        planted.BallPassRipple(amplitude=0.3 * drag, order=7.37, phase=1.1),
        planted.TorqueConstantDroop(share=0.08, at_torque=0.3 * axis.controller.torque_limit),
    )


def _table(axis: AxisParameters) -> tuple[Effect, ...]:
    return (
        planted.ConstantForce(force=-0.45 * axis.guide_coulomb),
        planted.PositionSpring(stiffness=2.5 * axis.guide_coulomb, zero=axis.stroke_low),
        planted.Payload(mass=0.16 * axis.table_mass),
        planted.InertiaDeviation(where="motor", inertia=0.12 * axis.motor_inertia),
        planted.InertiaDeviation(where="screw", inertia=-0.12 * axis.screw_inertia),
        planted.StructuralMode(mass=0.12 * axis.table_mass, frequency=70.0, damping=0.03),
    )


def _transmission(axis: AxisParameters) -> tuple[Effect, ...]:
    return (
        planted.Backlash(width=6e-6),
        planted.LeadErrorPeriodic(amplitude=1.8e-6, order=1.0, phase=2.2),
        planted.LeadErrorCumulative(slope=30e-6),
        planted.ThermalGrowth(strain=25e-6, time_constant=5.0),
        planted.StiffnessDeviation(factor=0.6),
        planted.StiffnessVsPosition(share_over_stroke=0.4),
        planted.PreloadLoss(ratio=0.35, force=2.5 * axis.guide_coulomb),
    )


def _timing() -> tuple[Effect, ...]:
    return (
        planted.DriveDelay(delay=180e-6),
        planted.ChannelDelay(channel="motor_torque", delay=0.7e-3),
        planted.ChannelDelay(channel="motor_angle", delay=0.3e-3),
        planted.ChannelDelay(channel="table_position", delay=0.3e-3),
    )
