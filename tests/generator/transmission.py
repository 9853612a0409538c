"""What screw and table do to each other: travel of the nut, its free play and its spring, compiled.

The spring has an energy U(e, x), e being the stretch beyond the free play: e = r phi + lead errors + g(t) x - x - play,
so that forces are its derivatives: F = dU/de on the screw as F (r + d lead/d phi), on the table as
F (1 - g) - (dU/dk) k'(x), because a stiffness that falls along the stroke pulls the stretched table as well.
"""

from __future__ import annotations

import math

from tests.generator.constants import Constants
from tests.generator.state import State, compiled


@compiled
def growth(time: float, c: Constants) -> tuple[float, float]:
    """Return the strain g of the screw (cumulative lead error, warming) and its rate [1/s]."""
    if c.growth_strain == 0.0:
        return c.lead_slope, 0.0
    left = c.growth_strain * math.exp(-time / c.growth_time)
    if c.growth_slow_share == 0.0:
        return c.lead_slope + c.growth_strain - left, left / c.growth_time
    slow = c.growth_slow_share * c.growth_strain * math.exp(-time / c.growth_slow_time)
    left *= 1.0 - c.growth_slow_share
    return c.lead_slope + c.growth_strain - left - slow, left / c.growth_time + slow / c.growth_slow_time


@compiled
def travel_error(angle: float, c: Constants) -> tuple[float, float]:
    """Return the periodic lead error [m] at a screw angle and its derivative [m/rad]."""
    phase = c.travel_order * angle + c.travel_phase
    error, slope = c.travel_amplitude * math.sin(phase), c.travel_amplitude * c.travel_order * math.cos(phase)
    if c.travel_second != 0.0:
        error += c.travel_second * c.travel_amplitude * math.sin(2.0 * phase)
        slope += 2.0 * c.travel_second * c.travel_amplitude * c.travel_order * math.cos(2.0 * phase)
    return error, slope


@compiled
def curved_lead(position: float, c: Constants) -> tuple[float, float]:
    """Return what of the cumulative lead error is no straight line [m], and its derivative."""
    far = position - c.stroke_low
    return c.lead_slope * c.lead_curve * far * far, 2.0 * c.lead_slope * c.lead_curve * far


@compiled
def stretch(state: State, c: Constants) -> float:
    """Return nut travel minus table position [m], free play included."""
    travel = 0.0
    if c.travel_amplitude != 0.0:
        travel, _ = travel_error(state.screw_angle, c)
    if c.lead_curve != 0.0:
        travel += curved_lead(state.position, c)[0]
    strain, _ = growth(state.time, c)
    return c.transmission * state.screw_angle + travel - (1.0 - strain) * state.position


@compiled
def side_of(state: State, c: Constants) -> int:
    """Return which flank the stretch touches: -1, 0 or +1."""
    if c.gap_softness != 0.0:
        return 0
    play = stretch(state, c)
    if play > 0.5 * c.gap:
        return 1
    return -1 if play < -0.5 * c.gap else 0


@compiled
def spring(e: float, position: float, c: Constants) -> tuple[float, float]:
    """Return the spring's force on the screw [N] and, of its force on the table, what k'(x) adds [N].

    Stiffness k(x) = k / (1 + soft_share u), u = (x - low) / (high - low), soft_share = share / (1 - share), so that
    k(high) = (1 - share) k. Around zero force it is ratio k(x), up to the force
    F1 = preload_force, i.e. the stretch e1 = F1 / (ratio k(x)); beyond, F = sign(e) (F1 + k(x) (|e| - e1)).
    dU/dk at constant e: ratio e^2 / 2 within, (e^2 - (1 - ratio) e1^2) / 2 beyond.
    """
    k, slope = c.axial_stiffness, 0.0
    if c.stroke_share != 0.0:
        soft_share = c.stroke_share / (1.0 - c.stroke_share)
        reach, turn = (position - c.stroke_low) / (c.stroke_high - c.stroke_low), 1.0
        if c.stroke_power != 1.0:
            reach = max(reach, 0.0)
            turn = c.stroke_power * reach ** (c.stroke_power - 1.0)
            reach = reach**c.stroke_power
        k /= 1.0 + soft_share * reach
        slope = -soft_share * turn / (c.stroke_high - c.stroke_low) * k * k / c.axial_stiffness
    if c.gap_softness != 0.0:
        half = 0.5 * c.gap
        above = math.sqrt((e - half) ** 2 + c.gap_softness**2)
        below = math.sqrt((e + half) ** 2 + c.gap_softness**2)
        return k * (e + 0.5 * (above - below)), 0.0
    if c.preload_force == 0.0:
        return k * e, -0.5 * slope * e * e
    soft = c.preload_ratio * k
    edge = c.preload_force / soft
    if c.preload_smooth != 0.0:
        return k * (e - (1.0 - c.preload_ratio) * edge * math.tanh(e / edge)), 0.0
    if abs(e) <= edge:
        return soft * e, -0.5 * slope * c.preload_ratio * e * e
    force = math.copysign(c.preload_force + k * (abs(e) - edge), e)
    return force, -0.5 * slope * (e * e - (1.0 - c.preload_ratio) * edge * edge)


@compiled
def soft_touch(e: float, c: Constants) -> float:
    """Return the share of the contacts that touch at a stretch [m] where the free play has a soft edge."""
    half = 0.5 * c.gap
    above = (e - half) / math.sqrt((e - half) ** 2 + c.gap_softness**2)
    below = (e + half) / math.sqrt((e + half) ** 2 + c.gap_softness**2)
    return 1.0 + 0.5 * (above - below)


@compiled
def nut_forces(state: State, side: int, c: Constants) -> tuple[float, float, float]:
    """Return the transmitted force [N], the torque it asks of the screw [N m] and its force on the table [N]."""
    soft = c.gap_softness != 0.0
    if side == 0 and c.gap != 0.0 and not soft:
        return 0.0, 0.0, 0.0
    ratio = c.transmission
    if c.travel_amplitude != 0.0:
        ratio += travel_error(state.screw_angle, c)[1]
    strain, strain_rate = growth(state.time, c)
    reach = 1.0 - strain
    if c.lead_curve != 0.0:
        reach -= curved_lead(state.position, c)[1]
    e = stretch(state, c) - 0.5 * side * c.gap
    force, pull = spring(e, state.position, c)
    touch = soft_touch(e, c) if soft else 1.0
    rate = ratio * state.screw_speed - reach * state.velocity + strain_rate * state.position
    force += touch * c.axial_damping * rate
    return force, ratio * force, reach * force + pull
