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
    return c.lead_slope + c.growth_strain - left, left / c.growth_time


@compiled
def stretch(state: State, c: Constants) -> float:
    """Return nut travel minus table position [m], free play included."""
    travel = 0.0
    if c.travel_amplitude != 0.0:
        travel = c.travel_amplitude * math.sin(c.travel_order * state.screw_angle + c.travel_phase)
    strain, _ = growth(state.time, c)
    return c.transmission * state.screw_angle + travel - (1.0 - strain) * state.position


@compiled
def side_of(state: State, c: Constants) -> int:
    """Return which flank the stretch touches: -1, 0 or +1."""
    play = stretch(state, c)
    if play > 0.5 * c.gap:
        return 1
    return -1 if play < -0.5 * c.gap else 0


@compiled
def spring(e: float, position: float, c: Constants) -> tuple[float, float]:
    """Return the spring's force on the screw [N] and, of its force on the table, what k'(x) adds [N].

    Stiffness k(x) = k (1 - share (x - low) / (high - low)). Around zero force it is ratio k(x), up to the force
    F1 = preload_force, i.e. the stretch e1 = F1 / (ratio k(x)); beyond, F = sign(e) (F1 + k(x) (|e| - e1)).
    dU/dk at constant e: ratio e^2 / 2 within, (e^2 - (1 - ratio) e1^2) / 2 beyond.
    """
    k, slope = c.axial_stiffness, 0.0
    if c.stroke_share != 0.0:
        slope = -c.stroke_share * c.axial_stiffness / (c.stroke_high - c.stroke_low)
        k += slope * (position - c.stroke_low)
    if c.preload_force == 0.0:
        return k * e, -0.5 * slope * e * e
    soft = c.preload_ratio * k
    edge = c.preload_force / soft
    if abs(e) <= edge:
        return soft * e, -0.5 * slope * c.preload_ratio * e * e
    force = math.copysign(c.preload_force + k * (abs(e) - edge), e)
    return force, -0.5 * slope * (e * e - (1.0 - c.preload_ratio) * edge * edge)


@compiled
def nut_forces(state: State, side: int, c: Constants) -> tuple[float, float, float]:
    """Return the transmitted force [N], the torque it asks of the screw [N m] and its force on the table [N]."""
    if side == 0 and c.gap != 0.0:
        return 0.0, 0.0, 0.0
    ratio = c.transmission
    if c.travel_amplitude != 0.0:
        phase = c.travel_order * state.screw_angle + c.travel_phase
        ratio += c.travel_amplitude * c.travel_order * math.cos(phase)
    strain, strain_rate = growth(state.time, c)
    reach = 1.0 - strain
    force, pull = spring(stretch(state, c) - 0.5 * side * c.gap, state.position, c)
    force += c.axial_damping * (ratio * state.screw_speed - reach * state.velocity + strain_rate * state.position)
    return force, ratio * force, reach * force + pull
