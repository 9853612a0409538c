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
from pathlib import Path
from typing import Any

from feeddrive.errors import InputError
from feeddrive.plant.analysis.modes import inertia_at_motor
from feeddrive.plant.plant import Plant
from feeddrive.schema.controller import CONTROLLER
from feeddrive.schema.table import Origins, Table
from feeddrive.schema.toml_text import read_toml, refuse_other_format
from feeddrive.servo.cascade import Cascade, Feedback, FeedForward, divider
from feeddrive.servo.cascade_function import velocity_loop_of
from feeddrive.servo.filters import Filter, biquad, notch, pt1, pt2
from feeddrive.servo.vendor_names import with_own_names

FORMAT = "feeddrive-controller/1"
_FILTERS: dict[str, Callable[..., Filter]] = {"PT1": pt1, "PT2": pt2, "notch": notch, "biquad": biquad}


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
    fast, slow = table.positive("velocity_rate"), table.positive("position_rate")
    reset = table.optional("reset_time", math.inf)
    bandwidth = table.positive("current_bandwidth") if "current_bandwidth" in table.entries else math.inf
    try:
        cascade = Cascade(
            radius=plant.chain.motor_radius,
            sample_time=1 / fast,
            position_divider=divider(fast, slow, table.place("position_rate")),
            position_gain=table.optional("position_gain", 0.0),
            velocity_gain=table.optional("velocity_gain", 0.0),
            reset_time=reset,
            tracking_time=table.optional("tracking_time", reset),
            torque_limit=_torque_limit(table, plant),
            speed_limit=table.optional("speed_limit", math.inf),
            feedback=Feedback(table.choice("position_feedback")),
            feed_forward=_feed_forward(table, plant),
            balancing_time=table.optional("balancing_time"),
            torque_offset=table.optional("torque_offset"),
            torque_filters=_filters(table, "torque"),
            speed_filters=_filters(table, "speed"),
            current_lag=1 / (2 * math.pi * bandwidth),
            dead_time=table.optional("dead_time"),
        )
    except InputError as error:
        known = error.where.startswith(table.where)
        raise error if known else InputError(error.what, f"{table.where}, {error.where}", error.mend) from None
    return _in_mode(cascade, table), table.switch("allow_unstable")


def _in_mode(cascade: Cascade, table: Table) -> Cascade:
    """The cascade with its outer loops open as the mode says; loops that are closed need their gain."""
    mode = table.choice("mode")
    needed = {"position": ("position_gain", "velocity_gain"), "velocity": ("velocity_gain",), "torque": ()}[mode]
    for key in needed:
        table.positive(key)
    if mode == "velocity":
        return velocity_loop_of(cascade)
    if mode == "torque":
        return replace(cascade, position_gain=0.0, velocity_gain=0.0)
    return cascade


def _torque_limit(table: Table, plant: Plant) -> float:
    limits = [table.optional("torque_limit", math.inf), plant.torque_limit]
    if ("current_limit" in table.entries) != ("torque_constant" in table.entries):
        missing = "torque_constant" if "current_limit" in table.entries else "current_limit"
        raise InputError("current_limit and torque_constant belong together", table.where, f"add {missing}")
    if "current_limit" in table.entries:
        limits.append(table.positive("current_limit") * table.positive("torque_constant"))
    return min(limits)


def _feed_forward(table: Table, plant: Plant) -> FeedForward:
    inner = table.table("feed_forward")
    inner.refuse_undeclared()
    values = {key: inner.quantity(key, origin=key) for key in inner.entries}
    for key, value in values.items():
        if value < 0:
            raise InputError("is negative", inner.place(key), "write zero or more")
    values.setdefault("inertia", inertia_at_motor(plant))
    return FeedForward(**values)


def _filters(table: Table, place: str) -> tuple[Filter, ...]:
    found = []
    for inner in table.tables("filter"):
        kind = inner.choice("kind")
        inner = inner.of_kind(kind)
        inner.refuse_undeclared()
        if inner.choice("at") == place:
            keys = CONTROLLER.sections["filter"].kinds[kind].keys
            found.append(_FILTERS[kind](**{key: inner.quantity(key, origin=key) for key in keys}))
    return tuple(found)


SCENARIO_FORMAT = "feeddrive-scenario/1"


def read_controller(path: Path, plant: Plant) -> Cascade:
    """The controller of a controller file or a scenario, for a plant, of which lead, torque limit and inertia are used.

    Raises InputError for neither kind of file, or a controller that cannot be read.
    """
    entries = read_toml(path, "scenario or controller file")
    written = entries.get("format")
    if written == FORMAT:
        return read_cascade(Table(entries, str(path), Origins()), plant)[0]
    if written != SCENARIO_FORMAT:
        mend = f'its first line is format = "{SCENARIO_FORMAT}" or "{FORMAT}"'
        raise InputError("is neither a scenario nor a controller file of this version", str(path), mend)
    where = insert_controller(entries, path)
    held = Table(entries, str(path), Origins()).table("controller")
    return read_cascade(Table(held.entries, where, held.origins), plant)[0]


def insert_controller(entries: dict[str, Any], path: Path) -> str:
    """Put the controller of another file in the place of its name; where it stands, for messages."""
    named = entries.get("controller")
    if named is None:
        raise InputError("controller is missing", str(path), "write a table [controller] or the name of a file")
    changes = dict(named) if isinstance(named, dict) else {"file": named}
    if "file" not in changes:
        return f"{path}, controller"
    file = path.parent / str(changes.pop("file"))
    read = read_toml(file, "controller file")
    refuse_other_format(read, FORMAT, str(file))
    own = with_own_names(read, str(file))
    entries["controller"] = own | with_own_names(changes, f"{path}, controller")
    return str(file) if not changes else f"{path}, controller"
