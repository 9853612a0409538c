"""The flat list of numbers that the compiled equations read."""

from __future__ import annotations

from typing import NamedTuple

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
    ripple_amplitude: float = 0.0
    ripple_order: float = 1.0
    ripple_phase: float = 0.0
    constant_force: float = 0.0
    gap: float = 0.0
    travel_amplitude: float = 0.0
    travel_order: float = 1.0
    travel_phase: float = 0.0
    drive_delay: float = 0.0


def declared_constants(axis: AxisParameters) -> Constants:
    """Return the constants of `axis` with nothing planted."""
    shared = {name: getattr(axis, name) for name in Constants._fields if hasattr(axis, name)}
    return Constants(**shared)
