"""A second plant carried along by the motor motion of a run: what its torque and its table would have been.

What an effect changes in a recording is what the plant without it asks of the motor, and where its table stands, under
the very motion that was recorded; two closed loops of their own would move differently. Screw and table of the second
plant are integrated with the same Runge-Kutta stages, motor angle and speed those of the first:

    T2 = T2' + (J2 / J1) (T1 - T1'),    T' = twist / ratio + ripple

| symbol | meaning | unit |
|---|---|---|
| T1, T2 | torque that acts on the motor of the run, and that the second plant asks for | N m |
| T' | torque that goes on to the screw, ripple included | N m |
| J1, J2 | inertia of the motors | kg m^2 |

T2 is the mean over the first cycle of a row. A second plant with free play finds its flank at the ends of steps, not
inside them.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from tests.generator.constants import Constants, packed
from tests.generator.loop import Sampling, acting
from tests.generator.motion import advance, ripple_of, shifted, slopes, twist_of
from tests.generator.state import State, compiled
from tests.generator.transmission import side_of

Array = npt.NDArray[np.float64]


def beside(torque: Array, start: State, second: State, s: Sampling, first: Constants, other: Constants) -> tuple[
    Array, Array
]:  # fmt: skip
    """Return what the recorded torque [N m] and the table position [m] of the other plant would be, (n,) each.

    Args:
        torque: commanded, held for a cycle each, (n,) [N m].
        start, second: states of the run and of the other plant at the first cycle.
        s: of the loop.
        first, other: of the plant that ran, of the other one.
    """
    return _beside(torque, start, second, s, packed(first), packed(other))


@compiled
def led(state: State, leader: State) -> State:
    """Return the state with the motor of another."""
    return State(
        leader.angle, leader.speed, state.screw_angle, state.screw_speed, state.position, state.velocity,
        state.bristle, state.mass_deflection, state.mass_velocity, state.time,
    )  # fmt: skip


@compiled
def carried(
    leader: State, other: State, torque: float, sides: tuple[int, int], step: float, first: Constants, second: Constants
) -> tuple[State, State, float]:
    """Return both states one step later and the mean torque that the other plant asks of its motor [N m]."""
    weights = (1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0)
    shares = (0.0, 0.5, 0.5, 1.0)
    one, two = leader, led(other, leader)
    ends, following = leader, other
    asked = 0.0
    for stage in range(4):
        slope_one = slopes(one, torque, sides[0], first)
        slope_two = slopes(two, torque, sides[1], second)
        passed = twist_of(one, first) / first.ratio + ripple_of(one, first)
        needed = twist_of(two, second) / second.ratio + ripple_of(two, second)
        asked += weights[stage] * (needed + second.motor_inertia / first.motor_inertia * (torque - passed))
        ends = shifted(ends, slope_one, weights[stage] * step)
        following = shifted(following, slope_two, weights[stage] * step)
        if stage < 3:
            one = shifted(leader, slope_one, shares[stage + 1] * step)
            two = led(shifted(other, slope_two, shares[stage + 1] * step), one)
    return ends, led(following, ends), asked


@compiled
def commanded(torque: float, c: Constants) -> float:
    """Return the command [N m] that brings about a torque."""
    if c.droop == 0.0:
        return torque
    command = torque
    for _ in range(6):
        command = torque / max(acting(1.0, c) if command == 0.0 else acting(command, c) / command, 0.2)
    return command


@compiled
def _beside(torque: Array, start: State, second: State, s: Sampling, first: Constants, other: Constants) -> tuple[
    Array, Array
]:  # fmt: skip
    count = torque.size
    asked, position = np.empty(count), np.empty(count)
    whole = math.floor(first.drive_delay / s.sample_time)
    late = first.drive_delay - whole * s.sample_time
    leader, follower = start, led(second, start)
    side = 0
    for i in range(count):
        position[i] = follower.position
        total = 0.0
        for part in range(2):
            span = late if part == 0 else s.sample_time - late
            if span <= 0.0:
                continue
            row = i - whole - 1 + part
            given = acting(torque[row], first) if row >= 0 else 0.0
            steps = max(1, math.ceil(span / s.longest_step - 1e-9))
            for _ in range(steps):
                sides = (side, side_of(follower, other))
                if first.gap == 0.0 or first.gap_softness != 0.0:
                    leader, follower, mean = carried(leader, follower, given, sides, span / steps, first, other)
                else:
                    # The flanks of the run are those of the run: its own step, the other plant led to its end.
                    _, follower, mean = carried(leader, follower, given, sides, span / steps, first, other)
                    leader, side = advance(leader, given, side, span / steps, first)
                    follower = led(follower, leader)
                total += mean * span / steps
        asked[i] = commanded(total / s.sample_time, other)
    return asked, position
