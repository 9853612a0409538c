"""Recordings of drawn machines spoilt in the forty ways of `tests.recovery.corruptions`, in the machine's own units."""

from __future__ import annotations

from collections.abc import Callable

from tests.generator.machines import Machine
from tests.generator.runs import Channels
from tests.recovery import corruptions
from tests.recovery.corruptions import CORRUPTIONS

OWN: dict[str, Callable[[Machine], Callable[[Channels], Channels]]] = {
    "set-point logged as the actual angle": lambda m: corruptions.in_place_of(
        "motor_angle", lambda given: given["setpoint"] / m.radius
    ),
    "position from the angle": lambda m: corruptions.in_place_of(
        "table_position", lambda given: given["motor_angle"] * m.radius
    ),
}
"""Those that know the machine's travel per revolution."""


def spoilings(machine: Machine) -> list[str]:
    """Return the ways that the recordings of a machine can be spoilt in."""
    return [name for name in CORRUPTIONS if machine.scale or "position" not in name]


def spoilt(machine: Machine, name: str, channels: Channels) -> Channels:
    """Return the channels spoilt in a way of `spoilings`; torques of that list are those of a limit of 30 N m."""
    change = OWN[name](machine) if name in OWN else CORRUPTIONS[name]
    size = machine.axis.controller.torque_limit / corruptions.RATED_TORQUE
    if name == "torque and set-point swapped":
        return change(channels)
    given = {**channels, "motor_torque": channels["motor_torque"] / size}
    if "table_position" not in given:
        given["table_position"] = given["motor_angle"]
    result = change(given)
    result = {**result, "motor_torque": result["motor_torque"] * size}
    return {key: values for key, values in result.items() if key in channels}
