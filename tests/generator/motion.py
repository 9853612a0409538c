"""The equations of motion and their integration, compiled.

State (7 numbers): motor angle and speed, screw angle and speed, table position and velocity, bristle deflection.
The gap side says which flank of the free play touches: -1, 0 (none) or +1. A step that crosses a flank is cut there,
because the contact damper makes the force jump.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TypeVar, cast

import numba

from tests.generator.constants import Constants

Function = TypeVar("Function", bound=Callable[..., object])
State = tuple[float, float, float, float, float, float, float]

CONTACT_HALVINGS = 45


def compiled(function: Function) -> Function:
    """Return `function` compiled by numba, keeping its type."""
    return cast(Function, numba.njit(function))


@compiled
def stretch(state: State, c: Constants) -> float:
    """Return nut travel minus table position [m], free play included."""
    travel = c.travel_amplitude * math.sin(c.travel_order * state[2] + c.travel_phase)
    return c.transmission * state[2] + travel - state[4]


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
    velocity = state[5]
    level = coulomb_level(state[4], velocity, c)
    viscous = c.guide_viscous * velocity
    if velocity > 0.0:
        viscous += c.viscous_asymmetry * velocity
    if c.bristle_stiffness == 0.0:
        return level * math.tanh(velocity / c.guide_velocity) + viscous, 0.0
    rate = bristle_rate(state[6], velocity, level, c)
    return c.bristle_stiffness * state[6] + c.bristle_damping * rate + viscous, rate


@compiled
def screw_drag(speed: float, c: Constants) -> float:
    """Return nut plus bearing drag [N m] at the screw speed [rad/s]."""
    coulomb = (c.nut_coulomb + c.bearing_coulomb) * math.tanh(speed / c.drag_speed)
    return coulomb + math.copysign(c.nut_power * abs(speed) ** (2.0 / 3.0), speed)


@compiled
def slopes(state: State, torque: float, side: int, c: Constants) -> State:
    """Return the time derivative of the state under the motor torque [N m], the gap's side being `side`."""
    angle, speed, screw_angle, screw_speed, _, velocity, _ = state
    ratio = c.transmission + c.travel_amplitude * c.travel_order * math.cos(
        c.travel_order * screw_angle + c.travel_phase
    )
    force = 0.0
    if side != 0 or c.gap == 0.0:
        force = c.axial_stiffness * (stretch(state, c) - 0.5 * side * c.gap)
        force += c.axial_damping * (ratio * screw_speed - velocity)
    twist = c.torsional_stiffness * (angle - screw_angle) + c.torsional_damping * (speed - screw_speed)
    ripple = c.ripple_amplitude * math.sin(c.ripple_order * angle + c.ripple_phase)
    friction, bristle = table_friction(state, c)
    return (
        speed,
        (torque - twist - ripple) / c.motor_inertia,
        screw_speed,
        (twist - ratio * force - screw_drag(screw_speed, c)) / c.screw_inertia,
        velocity,
        (force - friction - c.constant_force) / c.table_mass,
        bristle,
    )


@compiled
def shifted(state: State, slope: State, step: float) -> State:
    """Return state + step * slope."""
    return (
        state[0] + step * slope[0],
        state[1] + step * slope[1],
        state[2] + step * slope[2],
        state[3] + step * slope[3],
        state[4] + step * slope[4],
        state[5] + step * slope[5],
        state[6] + step * slope[6],
    )


@compiled
def runge_kutta(state: State, torque: float, side: int, step: float, c: Constants) -> State:
    """Return the state one classical fourth-order step later."""
    first = slopes(state, torque, side, c)
    second = slopes(shifted(state, first, 0.5 * step), torque, side, c)
    third = slopes(shifted(state, second, 0.5 * step), torque, side, c)
    fourth = slopes(shifted(state, third, step), torque, side, c)
    state = shifted(shifted(state, first, step / 6.0), second, step / 3.0)
    return shifted(shifted(state, third, step / 3.0), fourth, step / 6.0)


@compiled
def side_of(state: State, c: Constants) -> int:
    """Return which flank the stretch touches: -1, 0 or +1."""
    play = stretch(state, c)
    if play > 0.5 * c.gap:
        return 1
    return -1 if play < -0.5 * c.gap else 0


@compiled
def advance(state: State, torque: float, side: int, span: float, c: Constants) -> tuple[State, int]:
    """Return state and gap side after `span` [s], stopping at every flank on the way."""
    while True:
        trial = runge_kutta(state, torque, side, span, c)
        if c.gap == 0.0 or side_of(trial, c) == side:
            return trial, side
        before, after = 0.0, span
        for _ in range(CONTACT_HALVINGS):
            middle = 0.5 * (before + after)
            if side_of(runge_kutta(state, torque, side, middle, c), c) == side:
                before = middle
            else:
                after = middle
        state = runge_kutta(state, torque, side, after, c)
        side = side_of(state, c)
        span -= after
        if span <= 0.0:
            return state, side


@compiled
def advance_many(
    state: State, torque: float, side: int, span: float, longest: float, c: Constants
) -> tuple[State, int]:
    """Return state and gap side after `span` [s] in equal steps no longer than `longest` [s]."""
    if span <= 0.0:
        return state, side
    count = max(1, math.ceil(span / longest - 1e-9))
    for _ in range(count):
        state, side = advance(state, torque, side, span / count, c)
    return state, side
