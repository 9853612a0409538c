"""The cascade as drives have it: position P, velocity PI, current loop; its settings and their checks.

    position    w_set = (K_v (x_b - x) + k_s v_set) / r,          |w_set| <= w_max
    velocity    u = K_p (F_s w_set - w) + I + T_ff,               I' = K_p / T_n (F_s w_set - w) + (T - T_raw) / T_t
    torque      T_raw = F_t u + T_0,                              T = T_raw limited to +- T_max
    forward     T_ff = k_a J a_set / r + T_c tanh(w_r / w_0) + d w_r,   w_r = v_set / r
    balancing   x_b = x_set through a first-order lag T_b

| symbol | meaning | unit |
|---|---|---|
| x_set, v_set, a_set | set-point of the table position and its derivatives | m, m/s, m/s^2 |
| x | position: r theta (motor encoder) or that of the table (linear scale) | m |
| w | motor speed: difference of the motor angle over one tick of the velocity loop | rad/s |
| K_v | position gain (servo gain factor) | 1/s |
| K_p, T_n | gain and reset time of the velocity loop | N m s/rad, s |
| T_t | time in which the integrator follows a limited torque (back-calculation) | s |
| k_s, k_a | shares of speed and torque feed-forward | 1 |
| J | inertia at the motor that the torque feed-forward assumes | kg m^2 |
| T_c, w_0, d | friction at the motor: Coulomb torque, speed over which it turns, viscous | N m, rad/s, N m s/rad |
| F_s, F_t | filters of the speed set-point and of the torque | 1 |
| T_b | balancing time, for the delay of the velocity loop under feed-forward | s |
| r | lead / 2 pi | m/rad |

The integrator is stepped forward (Euler). Back-calculation rather than clamping: a clamped integrator makes the motion
a discontinuous function of every parameter. Source of the anti-windup: Åström, Hägglund, Advanced PID Control, 3.5.
The closed current loop is a first-order lag and a dead time, which the engine adds after the torque command.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from enum import StrEnum

from feeddrive.errors import InputError
from feeddrive.servo.filters import Filter

_MOST_TICKS = 1000
"""Most ticks of dead time, each of which is a state of the loop, and of one position tick."""

KV_UNIT = 1000.0 / 60.0
"""1/s per (m/min)/mm."""


class Feedback(StrEnum):
    """Where the position loop reads: the motor encoder or the linear scale of the table."""

    MOTOR = "motor"
    TABLE = "table"


@dataclass(frozen=True)
class FeedForward:
    """What the set-point adds directly.

    Attributes:
        speed: share k_s of the set speed; 0 is none, 1 takes the velocity's part of the following error away.
        torque: share k_a of the torque for the set acceleration.
        inertia: at the motor [kg m^2].
        coulomb: friction torque at the motor [N m].
        smoothing_speed: over which it turns [rad/s].
        viscous: torque per speed at the motor [N m s/rad].
    """

    speed: float = 0.0
    torque: float = 0.0
    inertia: float = 0.0
    coulomb: float = 0.0
    smoothing_speed: float = 1.0
    viscous: float = 0.0


@dataclass(frozen=True)
class Cascade:
    """Settings of the cascade, SI; symbols in the module's docstring.

    Attributes:
        radius: lead / 2 pi [m/rad].
        sample_time: of the velocity loop [s].
        position_divider: velocity ticks per position tick.
        position_gain: K_v [1/s].
        velocity_gain: K_p [N m s/rad].
        reset_time: T_n [s]; infinite leaves the integrator out.
        tracking_time: T_t [s].
        torque_limit: T_max [N m]; infinite if there is none.
        speed_limit: w_max [rad/s]; infinite if there is none.
        feedback: of the position loop.
        feed_forward: shares and friction.
        balancing_time: T_b [s].
        torque_offset: T_0, for instance against gravity [N m].
        torque_filters, speed_filters: in series, F_t and F_s.
        current_lag: time constant of the closed current loop [s].
        dead_time: from the tick to the torque, before that lag [s].

    Raises:
        InputError: a value outside its range; feed-forward of torque without inertia; an integrator that cannot
            follow (T_t below the sample time).
    """

    radius: float
    sample_time: float
    position_divider: int
    position_gain: float
    velocity_gain: float
    reset_time: float
    tracking_time: float
    torque_limit: float = math.inf
    speed_limit: float = math.inf
    feedback: Feedback = Feedback.MOTOR
    feed_forward: FeedForward = field(default_factory=FeedForward)
    balancing_time: float = 0.0
    torque_offset: float = 0.0
    torque_filters: tuple[Filter, ...] = ()
    speed_filters: tuple[Filter, ...] = ()
    current_lag: float = 0.0
    dead_time: float = 0.0

    def __post_init__(self) -> None:
        for name in ("radius", "sample_time", "reset_time", "tracking_time", "torque_limit", "speed_limit"):
            _refuse_unless(getattr(self, name) > 0, name, "write a value above zero")
        for name in ("position_gain", "velocity_gain", "balancing_time", "current_lag", "dead_time"):
            _refuse_unless(getattr(self, name) >= 0, name, "write zero or more")
        _refuse_unless(self.position_divider >= 1, "position_divider", "write 1 or more")
        _refuse_unless(self.feed_forward.smoothing_speed > 0, "smoothing_speed", "write a value above zero")
        _refuse_unless(self.tracking_time > self.sample_time, "tracking_time", "write more than the sample time")
        if self.position_divider > _MOST_TICKS:
            what = f"the position loop is {self.position_divider} times slower than the velocity loop"
            raise InputError(what, "controller.position_rate", f"at most {_MOST_TICKS} times is possible")
        if self.dead_time > _MOST_TICKS * self.sample_time:
            what = f"a dead time of {self.dead_time:g} s is more than {_MOST_TICKS} ticks"
            raise InputError(what, "controller.dead_time", "check its unit")
        if self.feed_forward.torque and not self.feed_forward.inertia > 0:
            raise InputError("torque feed-forward needs an inertia", "controller", 'write inertia = "... kg m^2"')


def _refuse_unless(holds: bool, name: str, mend: str) -> None:
    if not holds:
        raise InputError("is out of range", f"controller.{name}", mend)


def divider(fast_rate: float, slow_rate: float, where: str) -> int:
    """Ticks of the fast rate per tick of the slow one, both in Hz; refuses what is no integer, names the nearest."""
    ratio = fast_rate / slow_rate
    nearest = max(1, round(ratio))
    if abs(ratio - nearest) > 1e-9 * ratio:
        what = f"{fast_rate:.12g} Hz is no integer multiple of {slow_rate:.12g} Hz"
        raise InputError(what, where, f"write {fast_rate / nearest:.12g} Hz")
    return nearest
