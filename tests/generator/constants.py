"""The flat list of numbers that the compiled equations read."""

from __future__ import annotations

from typing import NamedTuple, cast

import numpy as np

from tests.generator.axis import AxisParameters


class Constants(NamedTuple):
    """Every number of the equations of motion, SI units; a planted effect replaces some of them, zero means absent."""

    transmission: float
    motor_inertia: float
    screw_inertia: float
    table_mass: float
    torsional_stiffness: float
    torsional_damping: float
    axial_stiffness: float
    axial_damping: float
    guide_coulomb: float
    guide_viscous: float
    guide_velocity: float
    nut_coulomb: float
    nut_power: float
    bearing_coulomb: float
    drag_speed: float
    stroke_low: float
    stroke_high: float
    coulomb_asymmetry: float = 0.0
    viscous_asymmetry: float = 0.0
    stribeck_force: float = 0.0
    stribeck_velocity: float = 1.0
    bump_peak: float = 0.0
    bump_centre: float = 0.0
    bump_half_width: float = 1.0
    bristle_stiffness: float = 0.0
    bristle_damping: float = 0.0
    break_away: float = 0.8
    guide_warmup: float = 0.0
    nut_warmup: float = 0.0
    warmup_time: float = 1.0
    load_coefficient: float = 0.0
    passing_amplitude: float = 0.0
    passing_order: float = 1.0
    passing_phase: float = 0.0
    ripple_amplitude: float = 0.0
    ripple_order: float = 1.0
    ripple_phase: float = 0.0
    droop: float = 0.0
    """Share of the torque lost at 1 N m."""
    constant_force: float = 0.0
    spring_stiffness: float = 0.0
    spring_zero: float = 0.0
    gap: float = 0.0
    travel_amplitude: float = 0.0
    travel_order: float = 1.0
    travel_phase: float = 0.0
    lead_slope: float = 0.0
    growth_strain: float = 0.0
    growth_time: float = 1.0
    stroke_share: float = 0.0
    preload_ratio: float = 1.0
    preload_force: float = 0.0
    mode_mass: float = 0.0
    mode_rate: float = 0.0
    mode_damping: float = 0.0
    drive_delay: float = 0.0
    torque_lateness: float = 0.0
    angle_lateness: float = 0.0
    table_lateness: float = 0.0
    cogging_force: float = 0.0
    cogging_period: float = 1.0
    cogging_phase: float = 0.0
    spot_force: float = 0.0
    spot_centre: float = 0.0
    spot_half_width: float = 1.0
    square_drag: float = 0.0
    later_friction: float = 0.0
    later_time: float = 0.0
    cable_drag: float = 0.0
    ratio: float = 1.0
    """Motor turns per screw turn; torsional stiffness and damping are those at the screw."""
    fall: float = 0.0
    """Acceleration of fall against positive motion [m/s^2]."""
    counterbalance: float = 0.0
    asymmetry_width: float = 0.0
    asymmetry_power: float = 1.0
    asymmetry_speed: float = 1.0
    stribeck_kind: float = 0.0
    """0: Gaussian; 1: 1 / (1 + |v / vs|); 2: exp(-|v / vs|)."""
    bristle_power: float = 0.0
    """0: elasto-plastic; else Dahl's exponent."""
    bump_kind: float = 0.0
    """0: Gaussian; 1: 1 / (1 + u^2); 2: half a wave of a cosine; 3: flat with soft edges."""
    warmup_slow_share: float = 0.0
    warmup_slow_time: float = 1.0
    load_power: float = 1.0
    load_reference: float = 1.0
    passing_second: float = 0.0
    ripple_second: float = 0.0
    droop_power: float = 2.0
    spring_reach: float = 0.0
    gap_softness: float = 0.0
    travel_second: float = 0.0
    lead_curve: float = 0.0
    growth_slow_share: float = 0.0
    growth_slow_time: float = 1.0
    stroke_power: float = 1.0
    preload_smooth: float = 0.0
    mode_speed: float = 0.0
    """Speed at which the damper of the further mass saturates [m/s]; 0: linear."""


def declared_constants(axis: AxisParameters) -> Constants:
    """Return the constants of `axis` with nothing planted."""
    shared = {name: getattr(axis, name) for name in Constants._fields if hasattr(axis, name)}
    return Constants(**shared)


RECORD = np.dtype([(name, np.float64) for name in Constants._fields])


def packed(constants: Constants) -> Constants:
    """Return the constants as a numpy record with the same fields.

    Compiled functions get a record by reference; sixty numbers by value would take them three times as long.
    """
    return cast(Constants, np.array([tuple(constants)], dtype=RECORD)[0])
