"""Forces on the table that stand in no list of effects, compiled."""

from __future__ import annotations

import math

from tests.generator.constants import Constants
from tests.generator.state import State, compiled


@compiled
def unlisted_force(state: State, c: Constants) -> float:
    """Return the force [N] on the table against positive motion."""
    force = 0.0
    if c.cogging_force != 0.0:
        force += c.cogging_force * math.sin(2.0 * math.pi * state.position / c.cogging_period + c.cogging_phase)
    if c.spot_force != 0.0:
        force += c.spot_force * math.exp(-(((state.position - c.spot_centre) / c.spot_half_width) ** 2))
    if c.square_drag != 0.0:
        force += c.square_drag * state.velocity * abs(state.velocity)
    if c.later_friction != 0.0 and state.time >= c.later_time:
        force += c.later_friction * math.tanh(state.velocity / c.guide_velocity)
    if c.cable_drag != 0.0:
        reach = (state.position - c.stroke_low) / (c.stroke_high - c.stroke_low)
        force += c.cable_drag * reach * (1.0 - reach) * math.tanh(state.velocity / c.guide_velocity)
    return force
