"""The one definition of the cascade's equations: a CasADi function of one tick (symbols in `servo/cascade.py`)."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import lru_cache

import casadi as ca
import numpy as np

from feeddrive.servo.cascade import Cascade, Feedback
from feeddrive.servo.filters import Filter
from feeddrive.servo.sampled_plant import SampledController
from feeddrive.symbolic_turn import SYMBOLS
from feeddrive.typing import Expression, FloatArray

REFERENCES = ("position", "velocity", "acceleration", "speed_excitation", "torque_excitation")
"""References: of the table [m, m/s, m/s^2]; added to the speed set-point [rad/s] and to the torque command [N m]."""

SIGNALS = ("position_error", "speed_command", "measured_speed", "unlimited_torque")
"""x_b - x at the last position tick [m], F_s w_set [rad/s], w [rad/s], T_raw [N m]."""

PARAMETERS = (
    "radius", "sample_time", "position_gain", "velocity_gain", "integral_gain", "tracking_rate", "torque_limit",
    "speed_limit", "speed_share", "torque_per_acceleration", "friction_torque", "smoothing_speed", "viscous",
    "balancing_share", "torque_offset",
)  # fmt: skip
"""Leading entries of the parameters; five coefficients per filter follow, torque filters first."""

_HELD = ("speed_set", "forward", "balanced", "error", "integral", "last_angle")
_COEFFICIENTS = 5


def cascade_controller(cascade: Cascade) -> SampledController:
    """The cascade as the function, with `REFERENCES` and `SIGNALS`, that engine and linear loop take.

    Set-points are read at position ticks, excitations at every tick. Raises InputError for a filter that does not fit
    the sample rate.
    """
    feedback = cascade.feedback
    function = _function(cascade.position_divider, feedback, len(cascade.torque_filters), len(cascade.speed_filters))
    measured = ("motor_angle",) if feedback is Feedback.MOTOR else ("motor_angle", "table_position")
    initial = np.zeros(function.size1_in(0))
    values = _values(cascade)
    return SampledController(function, initial, values, cascade.sample_time, REFERENCES, measured, SIGNALS)


def velocity_loop_of(cascade: Cascade) -> Cascade:
    """The velocity loop alone: the position loop open, the speed set-point that of the trajectory."""
    forward = replace(cascade.feed_forward, speed=1.0)
    return replace(cascade, position_gain=0.0, feed_forward=forward)


def _values(cascade: Cascade) -> FloatArray:
    forward, t = cascade.feed_forward, cascade.sample_time
    slow = t * cascade.position_divider
    balancing = -math.expm1(-slow / cascade.balancing_time) if cascade.balancing_time else 1.0
    no_integrator = math.isinf(cascade.reset_time)
    settings = [
        cascade.radius, t, cascade.position_gain, cascade.velocity_gain,
        0.0 if no_integrator else cascade.velocity_gain / cascade.reset_time,
        0.0 if no_integrator else 1.0 / cascade.tracking_time,
        cascade.torque_limit, cascade.speed_limit, forward.speed, forward.torque * forward.inertia / cascade.radius,
        forward.coulomb, forward.smoothing_speed, forward.viscous, balancing, cascade.torque_offset,
    ]  # fmt: skip
    filters: tuple[Filter, ...] = (*cascade.torque_filters, *cascade.speed_filters)
    return np.concatenate([settings, *(item.discrete(t) for item in filters)])


@lru_cache(maxsize=64)
@SYMBOLS.taken()
def _function(position_divider: int, feedback: Feedback, torque_filters: int, speed_filters: int) -> ca.Function:
    count = torque_filters + speed_filters
    state = ca.SX.sym("state", len(_HELD) + 2 * count)
    reference = ca.SX.sym("reference", len(REFERENCES))
    measurement = ca.SX.sym("measurement", 1 if feedback is Feedback.MOTOR else 2)
    tick = ca.SX.sym("tick")
    parameters = ca.SX.sym("parameters", len(PARAMETERS) + _COEFFICIENTS * count)
    p = dict(zip(PARAMETERS, ca.vertsplit(parameters)[: len(PARAMETERS)], strict=True))
    held = dict(zip(_HELD, ca.vertsplit(state)[: len(_HELD)], strict=True))
    angle = measurement[0]
    position = p["radius"] * angle if feedback is Feedback.MOTOR else measurement[1]

    due = ca.fmod(tick, position_divider) == 0
    fresh = _position_loop(p, held, reference, position, tick)
    held |= {name: ca.if_else(due, value, held[name]) for name, value in fresh.items()}

    # at the first tick there is no earlier angle, and the axis is taken to stand
    speed = ca.if_else(tick == 0, 0.0, (angle - held["last_angle"]) / p["sample_time"])
    memories = [state[len(_HELD) + 2 * i : len(_HELD) + 2 * i + 2] for i in range(count)]
    sets = [parameters[len(PARAMETERS) + _COEFFICIENTS * i :][:_COEFFICIENTS] for i in range(count)]
    split = torque_filters
    speed_set, after_speed = _in_series(held["speed_set"] + reference[3], memories[split:], sets[split:])
    error = speed_set - speed
    wanted = p["velocity_gain"] * error + held["integral"] + held["forward"] + reference[4]
    filtered, after_torque = _in_series(wanted, memories[:split], sets[:split])
    raw = filtered + p["torque_offset"]
    torque = _limited(raw, p["torque_limit"])
    rate = p["integral_gain"] * error + p["tracking_rate"] * (torque - raw)
    held |= {"integral": held["integral"] + p["sample_time"] * rate, "last_angle": angle}

    after = ca.vertcat(*(held[name] for name in _HELD), *after_torque, *after_speed)
    signals = ca.vertcat(held["error"], speed_set, speed, raw)
    return ca.Function(
        "cascade", [state, reference, measurement, tick, parameters], [after, torque, signals],
        ["state", "reference", "measurement", "tick", "parameters"], ["after", "torque", "signals"],
    )  # fmt: skip


def _position_loop(
    p: dict[str, Expression], held: dict[str, Expression], reference: Expression, position: Expression, tick: Expression
) -> dict[str, Expression]:
    """What a position tick sets anew: speed set-point, feed-forward torque, balanced set-point and error."""
    lagged = held["balanced"] + p["balancing_share"] * (reference[0] - held["balanced"])
    balanced = ca.if_else(tick == 0, reference[0], lagged)
    error = balanced - position
    speed = (p["position_gain"] * error + p["speed_share"] * reference[1]) / p["radius"]
    turning = reference[1] / p["radius"]
    friction = p["friction_torque"] * ca.tanh(turning / p["smoothing_speed"]) + p["viscous"] * turning
    return {
        "speed_set": _limited(speed, p["speed_limit"]),
        "forward": p["torque_per_acceleration"] * reference[2] + friction,
        "balanced": balanced,
        "error": error,
    }


def _in_series(
    value: Expression, memories: list[Expression], coefficients: list[Expression]
) -> tuple[Expression, list[Expression]]:
    """The value through filters in transposed direct form II, and their memories after."""
    after = []
    for memory, c in zip(memories, coefficients, strict=True):
        result = c[0] * value + memory[0]
        after.append(ca.vertcat(c[1] * value - c[3] * result + memory[1], c[2] * value - c[4] * result))
        value = result
    return value, after


def _limited(value: Expression, limit: Expression) -> Expression:
    return ca.fmin(ca.fmax(value, -limit), limit)
