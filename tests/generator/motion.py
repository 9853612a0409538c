"""The equations of motion and their integration, compiled.

The gap side says which flank of the free play touches: -1, 0 (none) or +1. A step that crosses a flank is cut there,
because the contact damper makes the force jump.
"""

from __future__ import annotations

import math

from tests.generator.constants import Constants
from tests.generator.friction import screw_drag, table_friction
from tests.generator.state import State, compiled
from tests.generator.transmission import nut_forces, side_of
from tests.generator.unlisted import unlisted_force

CONTACT_HALVINGS = 45


@compiled
def further_mass(state: State, c: Constants) -> tuple[float, float]:
    """Return the force [N] of the further mass on the table and the mass's acceleration [m/s^2]."""
    if c.mode_mass == 0.0:
        return 0.0, 0.0
    sliding = state.mass_velocity - state.velocity
    if c.mode_speed != 0.0:
        sliding = c.mode_speed * math.tanh(sliding / c.mode_speed)
    damper = 2.0 * c.mode_damping * sliding
    acceleration = -c.mode_rate * (c.mode_rate * state.mass_deflection + damper)
    return -c.mode_mass * acceleration, acceleration


@compiled
def twist_of(state: State, c: Constants) -> float:
    """Return the torque [N m] that motor and screw exchange, at the screw."""
    twist = c.torsional_stiffness * (state.angle / c.ratio - state.screw_angle)
    return twist + c.torsional_damping * (state.speed / c.ratio - state.screw_speed)


@compiled
def ripple_of(state: State, c: Constants) -> float:
    """Return the ripple torque of the motor [N m], against positive motion."""
    if c.ripple_amplitude == 0.0:
        return 0.0
    phase = c.ripple_order * state.angle + c.ripple_phase
    ripple = c.ripple_amplitude * math.sin(phase)
    if c.ripple_second != 0.0:
        ripple += c.ripple_second * c.ripple_amplitude * math.sin(2.0 * phase)
    return ripple


@compiled
def slopes(state: State, torque: float, side: int, c: Constants) -> State:
    """Return the time derivative of the state under the motor torque [N m], the gap's side being `side`."""
    force, load, push = nut_forces(state, side, c)
    twist = twist_of(state, c)
    friction, bristle = table_friction(state, c)
    resisting = c.constant_force + unlisted_force(state, c)
    if c.spring_reach == 0.0:
        resisting += c.spring_stiffness * (state.position - c.spring_zero)
    else:
        resisting += c.spring_stiffness * c.spring_reach * math.tanh((state.position - c.spring_zero) / c.spring_reach)
    if c.fall != 0.0:
        # A further mass on a spring hangs too.
        resisting += (c.table_mass + c.mode_mass) * c.fall - c.counterbalance
    pull, mass_acceleration = further_mass(state, c)
    return State(
        state.speed,
        (torque - twist / c.ratio - ripple_of(state, c)) / c.motor_inertia,
        state.screw_speed,
        (twist - load - screw_drag(state, force, c)) / c.screw_inertia,
        state.velocity,
        (push - friction - resisting + pull) / c.table_mass,
        bristle,
        state.mass_velocity - state.velocity,
        mass_acceleration,
        1.0,
    )


@compiled
def shifted(state: State, slope: State, step: float) -> State:
    """Return state + step * slope."""
    return State(
        state.angle + step * slope.angle,
        state.speed + step * slope.speed,
        state.screw_angle + step * slope.screw_angle,
        state.screw_speed + step * slope.screw_speed,
        state.position + step * slope.position,
        state.velocity + step * slope.velocity,
        state.bristle + step * slope.bristle,
        state.mass_deflection + step * slope.mass_deflection,
        state.mass_velocity + step * slope.mass_velocity,
        state.time + step * slope.time,
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
