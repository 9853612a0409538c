"""Friction of the guide and drag of the screw, compiled."""

from __future__ import annotations

import math

from tests.generator.constants import Constants
from tests.generator.state import State, compiled


@compiled
def viscous_share(share: float, time: float, c: Constants) -> float:
    """Return what is left of a viscous drag that loses `share` with the warming of the lubricant."""
    if share == 0.0:
        return 1.0
    return 1.0 - share * (1.0 - math.exp(-time / c.warmup_time))


@compiled
def coulomb_level(position: float, velocity: float, c: Constants) -> float:
    """Return the sliding friction level of the guide [N] without its direction."""
    level = c.guide_coulomb
    if velocity > 0.0:
        level += c.coulomb_asymmetry
    elif velocity == 0.0:
        level += 0.5 * c.coulomb_asymmetry
    if c.stribeck_force != 0.0:
        level += c.stribeck_force * math.exp(-((velocity / c.stribeck_velocity) ** 2))
    if c.bump_peak != 0.0:
        level += c.bump_peak * math.exp(-(((position - c.bump_centre) / c.bump_half_width) ** 2))
    return level


@compiled
def bristle_rate(deflection: float, velocity: float, level: float, c: Constants) -> float:
    """Return dz/dt [m/s] of the elasto-plastic bristle whose sliding deflection is level / stiffness."""
    sliding = level / c.bristle_stiffness
    elastic = c.break_away * sliding
    size = abs(deflection)
    if deflection * velocity <= 0.0 or size <= elastic:
        return velocity
    share = 1.0
    if size < sliding:
        share = 0.5 * math.sin(math.pi * (size - 0.5 * (sliding + elastic)) / (sliding - elastic)) + 0.5
    return velocity * (1.0 - share * size / sliding)


@compiled
def table_friction(state: State, c: Constants) -> tuple[float, float]:
    """Return the guide's friction force [N] and the bristle's rate [m/s]."""
    velocity = state.velocity
    level = coulomb_level(state.position, velocity, c)
    viscous = c.guide_viscous * velocity
    if velocity > 0.0:
        viscous += c.viscous_asymmetry * velocity
    viscous *= viscous_share(c.guide_warmup, state.time, c)
    if c.bristle_stiffness == 0.0:
        return level * math.tanh(velocity / c.guide_velocity) + viscous, 0.0
    rate = bristle_rate(state.bristle, velocity, level, c)
    return c.bristle_stiffness * state.bristle + c.bristle_damping * rate + viscous, rate


@compiled
def screw_drag(state: State, force: float, c: Constants) -> float:
    """Return nut plus bearing drag [N m] while the nut transmits `force` [N]."""
    speed = state.screw_speed
    level = c.nut_coulomb + c.bearing_coulomb
    if c.load_coefficient != 0.0:
        level += c.load_coefficient * c.transmission * abs(force)
    if c.passing_amplitude != 0.0:
        level += c.passing_amplitude * math.sin(c.passing_order * state.screw_angle + c.passing_phase)
    power = math.copysign(c.nut_power * abs(speed) ** (2.0 / 3.0), speed)
    return level * math.tanh(speed / c.drag_speed) + power * viscous_share(c.nut_warmup, state.time, c)
