"""What a machine does over hours: speed of the screw and air around it, in rows of one length."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from feeddrive.errors import InputError
from feeddrive.recording.files.reading import read_recording
from feeddrive.typing import FloatArray
from feeddrive.units.quantity import format_quantity

SPEED, AMBIENT_CHANNEL = "screw_speed", "ambient_temperature"
LONGEST = 200_000
"""Rows: two weeks at 6 s; more is a slip of a unit."""

_ROW, _LEAST_ROWS = 30.0, 120


@dataclass(frozen=True, eq=False)
class Duty:
    """Speeds and surroundings.

    Attributes:
        step: length of a row [s].
        speeds: of the screw over each row, of either sign, (k,) [rad/s].
        ambient: over each row, (k,) [degC].
        source: file that it comes from; empty for a constant speed.
    """

    step: float
    speeds: FloatArray
    ambient: FloatArray
    source: str = ""

    @property
    def times(self) -> FloatArray:
        """Ends of the rows, (k,) [s]."""
        return self.step * np.arange(1, len(self.speeds) + 1, dtype=np.float64)

    @property
    def duration(self) -> float:
        """[s]."""
        return self.step * len(self.speeds)

    @property
    def is_constant(self) -> bool:
        """Whether speed and air stay as they are."""
        return bool(np.all(self.speeds == self.speeds[0]) and np.all(self.ambient == self.ambient[0]))


def constant_duty(speed: float, duration: float, ambient: float) -> Duty:
    """Constant speed [rad/s] over a duration [s] in air of `ambient` [degC].

    Raises:
        InputError: a duration that is not positive or far too long, a speed that is not above zero.
    """
    if not (math.isfinite(duration) and duration > 0):
        raise InputError(f"{format_quantity(duration, 's')} is no duration", "--duration", "write a time above zero")
    if not (math.isfinite(speed) and speed > 0):
        mend = 'write a speed above zero, such as "750 rev/min"'
        raise InputError(f"{format_quantity(speed, 'rad/s')} heats nothing", "--speed", mend)
    rows = max(math.ceil(duration / _ROW), _LEAST_ROWS)
    if rows > LONGEST:
        what = f"{format_quantity(duration, 's')} is too long"
        raise InputError(what, "--duration", f"write at most {format_quantity(LONGEST * _ROW, 's')}")
    return Duty(duration / rows, np.full(rows, float(speed)), np.full(rows, float(ambient)))


def read_duty(path: Path, ambient: float) -> Duty:
    """Read a duty from a file of columns `time [s]`, `screw_speed [rev/min]`, may be `ambient_temperature [degC]`.

    The speed of a row is that of the interval ending at its time, as in thermal recordings; times are even. `ambient`
    [degC] holds where the file has no column for it. Raises InputError: a file that cannot be used, or one without
    speeds.
    """
    recording = read_recording(path)
    if SPEED not in recording.channels:
        mend = f'add a column "{SPEED} [rev/min]"; it has {", ".join(recording.channels)}'
        raise InputError(f"there is no {SPEED}", str(path), mend)
    speeds = recording[SPEED]
    air = recording.channels.get(AMBIENT_CHANNEL, np.full(len(speeds), float(ambient)))
    if not np.any(speeds):
        raise InputError("the screw never turns", str(path), "write speeds other than zero")
    return Duty(recording.sample_time, speeds, np.asarray(air), str(path))
