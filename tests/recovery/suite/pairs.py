"""Pairs of effects: what meets on one machine, and what hides one another.

Left out are pairs that no recording can tell from another pair: an asymmetry with a constant force (the same as that
force with another Coulomb level), a spring with a constant force (a spring with another zero).
"""

from __future__ import annotations

Member = tuple[str, int]
"""Effect and which of its examples."""

PAIRS: tuple[tuple[Member, Member], ...] = (
    (("backlash", 0), ("stiffness_deviation", 0)),  # a worn nut, or a loose bearing
    (("preload_loss", 0), ("friction_deviation", 1)),  # worn balls: softer about zero, less drag of the screw
    (("constant_force", 0), ("friction_vs_position", 0)),  # a vertical axis with a dry place
    (("stribeck", 0), ("friction_deviation", 0)),  # a higher level hides a drop at low speed
    (("presliding", 0), ("stribeck", 0)),  # both at reversals
    (("lead_error_periodic", 0), ("lead_error_cumulative", 0)),  # one screw's pitch errors
    (("lead_error_cumulative", 0), ("thermal_growth", 0)),  # one is the other at once
    (("torque_ripple", 0), ("ball_pass_ripple", 0)),  # two ripples
    (("torque_ripple", 0), ("lead_error_periodic", 0)),  # a bent screw shows in both channels
    (("payload", 0), ("drive_delay", 0)),  # a fixture on a drive with dead time: both in the chirp
    (("position_spring", 0), ("coulomb_asymmetry", 0)),  # a cable chain and a tight guide
    (("viscous_warmup", 0), ("thermal_growth", 0)),  # a machine that warms
    (("payload", 0), ("torque_constant_droop", 0)),  # both when accelerating
    (("inertia_deviation", 0), ("payload", 0)),  # they share the torque of acceleration
    (("structural_mode", 0), ("backlash", 0)),  # a swinging table on a worn nut
    (("channel_delay", 2), ("lead_error_periodic", 0)),  # a late scale
)

HEAT_PAIRS: tuple[tuple[Member, Member], ...] = (
    (("motor_heat", 0), ("preload_growth", 0)),
    (("motor_heat", 0), ("cooling", 1)),
    (("ambient_drift", 0), ("preload_growth", 0)),
    (("structure_growth", 0), ("motor_heat", 0)),
    (("convection_deviation", 0), ("motor_heat", 0)),
    (("heat_sink", 0), ("bearing_heat", 1)),
)
