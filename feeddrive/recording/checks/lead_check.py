"""Do the channels of a recording fit each other, the lead and the stroke? Finds swapped columns and wrong units."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from feeddrive.errors import InputError
from feeddrive.recording.recording import Recording
from feeddrive.typing import FloatArray
from feeddrive.units.quantity import format_quantity

_MOVES_TOGETHER = 0.9  # correlation of two channels that see the same motion
_SETPOINT_RANGE = (0.5, 2.0)  # slope of position on set-point; a lagging servo stays well inside

# Slope over lead/2pi for the usual mistakes.
_MISTAKES = (
    (-1.0, "the sign of one of the two channels is reversed"),
    (1000.0, "table_position looks like mm under a heading of m"),
    (1e-3, "table_position looks like m under a heading of mm"),
    (2.0 * math.pi, "motor_angle looks like revolutions under a heading of rad"),
    (math.pi / 180.0, "motor_angle looks like degrees under a heading of rad"),
    (180.0 / math.pi, "motor_angle looks like rad under a heading of deg"),
)


_OFF_STROKE = 2.0
"""Travel over the declared stroke that no overtravel reaches; a unit that is another makes six times or more of it."""


def check_against_lead(recording: Recording, lead: float, where: str, factor: float = 0.1) -> None:
    """Refuse channels that contradict the lead [m]; channels that are absent are not judged.

    The slope table_position / motor_angle may differ from lead / 2pi by `factor` [1]; beyond it columns are swapped, or
    unit or lead are wrong.
    """
    radius = lead / (2.0 * math.pi)
    if "motor_angle" in recording and "table_position" in recording:
        _check_slope(recording["motor_angle"], recording["table_position"], radius, where, factor)


def check_against_stroke(recording: Recording, lead: float, stroke: tuple[float, float] | None, where: str) -> None:
    """Refuse a motor that turns further than the declared stroke [m] at the lead [m] lets it.

    Where there is no table position beside it, nothing else tells the unit of the angle. The tenth of the rows at
    either end of the way does not count: a cell may be an outlier.
    """
    if stroke is None or "motor_angle" not in recording:
        return
    low, high = np.quantile(recording["motor_angle"], (0.1, 0.9))
    travel, declared = float(high - low) * lead / (2.0 * math.pi), stroke[1] - stroke[0]
    if travel <= _OFF_STROKE * declared:
        return
    way, length = format_quantity(travel, "m"), format_quantity(declared, "m")
    what = f"motor_angle moves the table by {way} at the lead of the plant, while its stroke is {length}"
    mend = "check the unit of motor_angle, and the lead, the gear ratio and the stroke in the plant file"
    if math.degrees(1.0) * declared >= travel > 2.0 * math.pi * declared:  # no rad under revolutions goes so far
        mend = "motor_angle looks like degrees under a heading of rad: correct the header"
    raise InputError(what, where, mend)


def without_unfollowed_setpoint(recording: Recording, lead: float) -> Recording:
    """Return the recording without a set-point that the position does not follow, and with a note of it; lead in m.

    A trace often holds the set-point of another axis, of another unit or before a transformation; what was measured is
    as good without it.
    """
    position = _position(recording, lead / (2.0 * math.pi)) if "setpoint" in recording else None
    reason = _unfollowed(recording["setpoint"], position) if position is not None else ""
    if not reason:
        return recording
    channels = {name: samples for name, samples in recording.channels.items() if name != "setpoint"}
    return replace(recording, channels=channels, notes=(*recording.notes, reason))


def _check_slope(angle: FloatArray, position: FloatArray, radius: float, where: str, factor: float) -> None:
    slope, correlation = _regression(angle, position)
    if abs(correlation) < _MOVES_TOGETHER:
        what = f"motor_angle and table_position do not move together (correlation {correlation:.2f})"
        raise InputError(what, where, "check which columns hold them")
    if abs(slope / radius - 1.0) <= factor:
        return
    measured, declared = (format_quantity(2.0 * math.pi * value, "m") for value in (slope, radius))
    what = f"table_position moves {measured} per revolution of motor_angle, while the plant's lead is {declared}"
    raise InputError(what, where, _mend(slope, radius, factor))


def _mend(slope: float, radius: float, factor: float) -> str:
    if abs(1.0 / (slope * radius) - 1.0) <= factor:
        return "motor_angle and table_position are swapped: exchange the two columns"
    for ratio, mistake in _MISTAKES:
        if abs(slope / (radius * ratio) - 1.0) <= factor:
            return f"{mistake}: correct the header"
    return "correct the lead in the plant file (or a gear ratio), or name the plant that was measured"


def _position(recording: Recording, radius: float) -> FloatArray | None:
    """Return the position that a set-point is compared with, (n,) [m]."""
    if "table_position" in recording:
        return recording["table_position"]
    return recording["motor_angle"] * radius if "motor_angle" in recording else None


def _unfollowed(setpoint: FloatArray, position: FloatArray) -> str:
    """Return why a set-point is not used; empty where the position follows it."""
    if np.ptp(setpoint) == 0.0:
        return ""
    slope, correlation = _regression(setpoint, position)
    if correlation >= _MOVES_TOGETHER and _SETPOINT_RANGE[0] <= slope <= _SETPOINT_RANGE[1]:
        return ""
    what = f"the position does not follow the setpoint (slope {slope:.3g}, correlation {correlation:.2f})"
    return f"{what}: it is left out; check which column holds it, and its unit"


def _regression(x: FloatArray, y: FloatArray) -> tuple[float, float]:
    """Return slope of y on x and their correlation; zeros where one of them stands still."""
    x, y = x - x.mean(), y - y.mean()
    if not np.any(x) or not np.any(y):
        return 0.0, 0.0
    both = float(x @ y)
    return both / float(x @ x), both / math.sqrt(float(x @ x) * float(y @ y))
