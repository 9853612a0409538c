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
    if c.warmup_slow_share != 0.0:
        slow = c.warmup_slow_share
        left = (1.0 - slow) * math.exp(-time / c.warmup_time) + slow * math.exp(-time / c.warmup_slow_time)
        return 1.0 - share * (1.0 - left)
    return 1.0 - share * (1.0 - math.exp(-time / c.warmup_time))


@compiled
def stribeck_share(velocity: float, c: Constants) -> float:
    """Return the share of the Stribeck force at a velocity [m/s]."""
    ratio = velocity / c.stribeck_velocity
    if c.stribeck_kind == 1.0:
        return 1.0 / (1.0 + abs(ratio))
    if c.stribeck_kind == 2.0:
        return math.exp(-abs(ratio))
    return math.exp(-(ratio**2))


@compiled
def bump_share(position: float, c: Constants) -> float:
    """Return the share of the tight place's force at a position [m]."""
    u = (position - c.bump_centre) / c.bump_half_width
    if c.bump_kind == 1.0:
        return 1.0 / (1.0 + u * u)
    if c.bump_kind == 2.0:
        return 0.5 * (1.0 + math.cos(0.5 * math.pi * u)) if abs(u) < 2.0 else 0.0
    if c.bump_kind == 3.0:
        return 0.5 * (math.tanh(4.0 * (u + 1.0)) - math.tanh(4.0 * (u - 1.0)))
    return math.exp(-(u**2))


@compiled
def coulomb_level(position: float, velocity: float, c: Constants) -> float:
    """Return the sliding friction level of the guide [N] without its direction."""
    level = c.guide_coulomb
    if c.asymmetry_width != 0.0:
        level += 0.5 * c.coulomb_asymmetry * (1.0 + math.tanh(velocity / c.asymmetry_width))
    elif velocity > 0.0:
        level += c.coulomb_asymmetry
    elif velocity == 0.0:
        level += 0.5 * c.coulomb_asymmetry
    if c.stribeck_force != 0.0:
        level += c.stribeck_force * stribeck_share(velocity, c)
    if c.bump_peak != 0.0:
        level += c.bump_peak * bump_share(position, c)
    return level


@compiled
def bristle_rate(deflection: float, velocity: float, level: float, c: Constants) -> float:
    """Return dz/dt [m/s] of the elasto-plastic bristle whose sliding deflection is level / stiffness."""
    sliding = level / c.bristle_stiffness
    if c.bristle_power != 0.0:
        left = 1.0 - math.copysign(1.0, velocity) * deflection / sliding
        return velocity * math.copysign(abs(left) ** c.bristle_power, left)
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
        if c.asymmetry_power == 1.0:
            viscous += c.viscous_asymmetry * velocity
        else:
            viscous += c.viscous_asymmetry * velocity * (velocity / c.asymmetry_speed) ** (c.asymmetry_power - 1.0)
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
        load = abs(force)
        if c.load_power != 1.0:
            load = c.load_reference * (load / c.load_reference) ** c.load_power
        level += c.load_coefficient * c.transmission * load
    if c.passing_amplitude != 0.0:
        phase = c.passing_order * state.screw_angle + c.passing_phase
        level += c.passing_amplitude * math.sin(phase)
        if c.passing_second != 0.0:
            level += c.passing_second * c.passing_amplitude * math.sin(2.0 * phase)
    power = math.copysign(c.nut_power * abs(speed) ** (2.0 / 3.0), speed)
    return level * math.tanh(speed / c.drag_speed) + power * viscous_share(c.nut_warmup, state.time, c)
