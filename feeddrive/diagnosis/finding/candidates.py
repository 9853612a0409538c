"""Which effects are tried, whether a recording can show them, and the values that their fits start from.

A start is as good as the residual allows: orders from an angle-domain periodogram, a bump from the residual over
position, velocities and stiffnesses from a short scan. Each candidate then is refined before it is compared.
"""

from __future__ import annotations

from feeddrive.diagnosis.finding.scene import Candidate
from feeddrive.diagnosis.starts import drive, mode, needs, starts, transmission_starts
from feeddrive.effects.chain.payload import Payload
from feeddrive.effects.friction.coulomb_asymmetry import CoulombAsymmetry
from feeddrive.effects.friction.load_dependent_friction import LoadDependentFriction
from feeddrive.effects.friction.viscous_asymmetry import ViscousAsymmetry
from feeddrive.effects.source.constant_force import ConstantForce
from feeddrive.effects.travel.lead_error_cumulative import LeadErrorCumulative

CANDIDATES: tuple[Candidate, ...] = (
    Candidate("friction_deviation", starts.deviation, needs.force),
    Candidate("constant_force", starts.plain(ConstantForce.of(force=0.0)), needs.force),
    Candidate("position_spring", starts.position_spring, needs.force_stroke),
    Candidate("coulomb_asymmetry", starts.plain(CoulombAsymmetry.of(delta_force=0.0)), needs.friction_reversals),
    Candidate("viscous_asymmetry", starts.plain(ViscousAsymmetry.of(delta_viscous=0.0)), needs.friction_reversals),
    Candidate("viscous_warmup", starts.viscous_warmup, needs.force_duration),
    Candidate(
        "load_dependent_friction",
        starts.plain(LoadDependentFriction.of(coefficient=0.0)),
        needs.screw_drag,
    ),
    Candidate("stribeck", starts.stribeck, needs.friction),
    Candidate("presliding", starts.presliding, needs.friction_reversals, scanned=True),
    Candidate("friction_vs_position", starts.over_position, needs.friction),
    Candidate("torque_ripple", starts.ripple, needs.torque_turns),
    Candidate("ball_pass_ripple", starts.ball_pass_ripple, needs.screw_drag_turns),
    Candidate("lead_error_periodic", starts.lead_error, needs.lead),
    Candidate("lead_error_cumulative", starts.plain(LeadErrorCumulative.of(slope=0.0)), needs.scale),
    Candidate("thermal_growth", starts.thermal_growth, needs.scale_duration),
    Candidate("stiffness_deviation", transmission_starts.stiffness, needs.elastic),
    Candidate("stiffness_vs_position", transmission_starts.stiffness_vs_position, needs.stiffness_along_stroke),
    Candidate("preload_loss", transmission_starts.preload_loss, needs.elastic, scanned=True),
    Candidate("backlash", starts.backlash, needs.gap, scanned=True),
    Candidate("payload", starts.plain(Payload.of(mass=0.0)), needs.force),
    Candidate("structural_mode", mode.structural_mode, needs.elastic, scanned=True, brief=True),
    Candidate("inertia_deviation", drive.inertia, needs.torque_inertia),
    Candidate("torque_constant_droop", drive.droop, needs.torque),
    Candidate("drive_delay", drive.drive_delay, needs.torque),
    Candidate("channel_delay", drive.channel_delay, needs.nothing),
)
"""Effects that `diagnose` tries, and how."""
