"""The controller of a scenario: a table of it, or a file of its own.

format = "feeddrive-controller/1"     # in a file of its own; as [controller] of a scenario it is left out
velocity_rate = "8 kHz"
position_rate = "2 kHz"               # velocity_rate is an integer multiple of it
position_gain = "4 (m/min)/mm"        # or 1/s; names of makers are known: K_v, POSCTRL_GAIN, ... (servo.vendor_names)
velocity_gain = "2 N m s/rad"         # K_p
reset_time = "15 ms"                  # T_n; left out: no integrator
tracking_time = "15 ms"               # of the anti-windup; left out: the reset time
position_feedback = "motor"           # or "table"
current_bandwidth = "1 kHz"           # -3 dB of the closed current loop; left out: no lag
dead_time = "125 us"
torque_limit = "30 N m"               # left out: that of the motor
current_limit = "20 A"                # with torque_constant = "1.5 N m/A": another torque limit
speed_limit = "3000 rev/min"
balancing_time = "2 ms"
torque_offset = "0 N m"
mode = "position"                     # "velocity": position loop open; "torque": both open
allow_unstable = false
[feed_forward]
speed = 1.0
torque = 1.0                          # of the plant's inertia, or of inertia = "60 kg cm^2"
coulomb = "0.4 N m"
smoothing_speed = "3 rad/s"
viscous = "0.01 N m s/rad"
[[filter]]
at = "torque"                         # or "speed"
kind = "notch"                        # frequency, bandwidth, depth; PT1: frequency; PT2: frequency, damping;
frequency = "510 Hz"                  # biquad: zero_frequency, zero_damping, pole_frequency, pole_damping
bandwidth = "100 Hz"
depth = "30 dB"
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

from feeddrive.errors import InputError
from feeddrive.plant.chain.moving_inertia import inertia_at_motor
from feeddrive.plant.file.entries import Table
from feeddrive.plant.plant import Plant
from feeddrive.schema.controller import CONTROLLER
from feeddrive.servo.cascade import Cascade, Feedback, FeedForward, divider
from feeddrive.servo.cascade_function import velocity_loop_of
from feeddrive.servo.filters import Filter, biquad, notch, pt1, pt2
from feeddrive.servo.vendor_names import with_own_names
from feeddrive.simulate.scenario.scenario_values import boolean, optional, positive

FORMAT = "feeddrive-controller/1"
_MODES = ("position", "velocity", "torque")
_FORWARD_UNITS = {
    "speed": "1",
    "torque": "1",
    "inertia": "kg m^2",
    "coulomb": "N m",
    "smoothing_speed": "rad/s",
    "viscous": "N m s/rad",
}
_FILTERS: dict[str, tuple[Callable[..., Filter], dict[str, str]]] = {
    "PT1": (pt1, {"frequency": "Hz"}),
    "PT2": (pt2, {"frequency": "Hz", "damping": "1"}),
    "notch": (notch, {"frequency": "Hz", "bandwidth": "Hz", "depth": "dB"}),
    "biquad": (biquad, {"zero_frequency": "Hz", "zero_damping": "1", "pole_frequency": "Hz", "pole_damping": "1"}),
}


def read_cascade(written: Table, plant: Plant) -> tuple[Cascade, bool]:
    """The cascade of a controller table, and whether an unstable loop may run.

    Args:
        written: table of the controller; names of makers are accepted.
        plant: gives the lead, the motor's torque limit and the inertia for the feed-forward.

    Raises:
        InputError: unknown key, a value missing or impossible, rates that are no integer multiples.
    """
    entries = with_own_names(dict(written.entries), written.where)
    table = Table(entries, written.where, written.origins, written.source, CONTROLLER)
    table.refuse_undeclared()
    for key in ("format", "name", "source"):
        table.text(key, "")
    fast, slow = positive(table, "velocity_rate", "Hz"), positive(table, "position_rate", "Hz")
    reset = optional(table, "reset_time", "s", math.inf)
    bandwidth = positive(table, "current_bandwidth", "Hz") if "current_bandwidth" in table.entries else math.inf
    try:
        cascade = Cascade(
            radius=plant.chain.motor_radius,
            sample_time=1 / fast,
            position_divider=divider(fast, slow, table.place("position_rate")),
            position_gain=optional(table, "position_gain", "1/s", 0.0),
            velocity_gain=optional(table, "velocity_gain", "N m s/rad", 0.0),
            reset_time=reset,
            tracking_time=optional(table, "tracking_time", "s", reset),
            torque_limit=_torque_limit(table, plant),
            speed_limit=optional(table, "speed_limit", "rad/s", math.inf),
            feedback=Feedback(table.choice("position_feedback", [str(place) for place in Feedback], "motor")),
            feed_forward=_feed_forward(table, plant),
            balancing_time=optional(table, "balancing_time", "s", 0.0),
            torque_offset=optional(table, "torque_offset", "N m", 0.0),
            torque_filters=_filters(table, "torque"),
            speed_filters=_filters(table, "speed"),
            current_lag=1 / (2 * math.pi * bandwidth),
            dead_time=optional(table, "dead_time", "s", 0.0),
        )
    except InputError as error:
        known = error.where.startswith(table.where)
        raise error if known else InputError(error.what, f"{table.where}, {error.where}", error.mend) from None
    return _in_mode(cascade, table), boolean(table, "allow_unstable", False)


def _in_mode(cascade: Cascade, table: Table) -> Cascade:
    """The cascade with its outer loops open as the mode says; loops that are closed need their gain."""
    mode = table.choice("mode", _MODES, "position")
    needed = {"position": ("position_gain", "velocity_gain"), "velocity": ("velocity_gain",), "torque": ()}[mode]
    for key in needed:
        positive(table, key, {"position_gain": "1/s", "velocity_gain": "N m s/rad"}[key])
    if mode == "velocity":
        return velocity_loop_of(cascade)
    if mode == "torque":
        return replace(cascade, position_gain=0.0, velocity_gain=0.0)
    return cascade


def _torque_limit(table: Table, plant: Plant) -> float:
    limits = [optional(table, "torque_limit", "N m", math.inf), plant.torque_limit]
    if ("current_limit" in table.entries) != ("torque_constant" in table.entries):
        missing = "torque_constant" if "current_limit" in table.entries else "current_limit"
        raise InputError("current_limit and torque_constant belong together", table.where, f"add {missing}")
    if "current_limit" in table.entries:
        limits.append(positive(table, "current_limit", "A") * positive(table, "torque_constant", "N m/A"))
    return min(limits)


def _feed_forward(table: Table, plant: Plant) -> FeedForward:
    inner = table.table("feed_forward")
    inner.refuse_undeclared()
    values = {key: inner.quantity(key, unit, key) for key, unit in _FORWARD_UNITS.items() if key in inner.entries}
    for key, value in values.items():
        if value < 0:
            raise InputError("is negative", inner.place(key), "write zero or more")
    values.setdefault("inertia", inertia_at_motor(plant))
    return FeedForward(**values)


def _filters(table: Table, place: str) -> tuple[Filter, ...]:
    found = []
    for inner in table.tables("filter"):
        kind = inner.choice("kind", _FILTERS)
        make, units = _FILTERS[kind]
        inner = inner.of_kind(kind)
        inner.refuse_undeclared()
        if inner.choice("at", ("torque", "speed"), "torque") == place:
            found.append(make(**{key: inner.quantity(key, unit, key) for key, unit in units.items()}))
    return tuple(found)
