"""Channels that are one signal under two names.

A copy changes in the same rows as its source and departs from it by no more than the last digits of both:

    max |y - s x - c| <= 0.6 (|s| q_x + q_y)

with the resolutions q, at the rows that neither channel had filled on reading. A servo always has an error, and a
transmission gives: two sensors differ by more.
"""

from __future__ import annotations

import numpy as np

from feeddrive.errors import InputError
from feeddrive.recording.checks.flaws import resolution
from feeddrive.recording.recording import Recording
from feeddrive.typing import FloatArray

ROUNDED = 0.6
"""Share of a resolution by which a rounded value departs: half of it, and what the scale between the two loses."""

WIDE = 1000.0
"""Range over resolution from which a copy is distinguished from two sensors that see next to nothing."""

DIGITS = 1e-9
"""Share of the largest value: what ten significant digits in a file leave. No transmission gives so little."""

SIZES = 3
"""Different steps that show a grid: rest and one speed, to and fro, make two at most, whatever resolves them."""


def refuse_copied_setpoint(recording: Recording) -> None:
    """Refuse a recording whose measured motion is the set-point.

    Raises:
        InputError: the set-point and a measured channel are one signal.
    """
    for name in ("table_position", "motor_angle"):
        if are_copies(recording, "setpoint", name):
            what = f"setpoint and {name} are the same signal to the last digit, and a servo always has an error"
            mend = f"map the actual value to {name}, or leave out the column that is a copy"
            raise InputError(what, recording.name, mend)


def are_copies(recording: Recording, source: str, other: str) -> bool:
    """Tell whether one channel of a recording is another times a factor; not where it lacks either."""
    if source not in recording or other not in recording:
        return False
    as_read = np.ones(len(recording.time), dtype=np.bool_)
    for flaw in recording.flaws:
        if flaw.channel in (source, other):
            as_read[flaw.rows] = False
    return is_copy(recording[source][as_read], recording[other][as_read])


def is_copy(source: FloatArray, other: FloatArray) -> bool:
    """Tell whether one channel is the other times a factor, (n,) each."""
    changes, others = np.diff(source) != 0.0, np.diff(other) != 0.0
    if float(np.mean(changes == others)) < 0.999 or not np.any(changes):
        return False
    x, y = source - source.mean(), other - other.mean()
    factor = float(x @ y) / float(x @ x)
    steps = _grid(source), _grid(other)
    if np.ptp(source) < WIDE * steps[0] or np.ptp(other) < WIDE * steps[1]:
        return False
    rounding = DIGITS * float(np.max(np.abs(other)))
    return bool(np.max(np.abs(y - factor * x)) <= ROUNDED * (abs(factor) * steps[0] + steps[1]) + rounding)


def _grid(samples: FloatArray) -> float:
    """Resolution of samples that all lie on its grid; 0 where they do not, or where nothing shows that it is one.

    The least difference of a few hundred rows may be a thousand times what their sensor resolves; in a stroke at one
    speed it is the way of a row. A grid shows itself by steps of several of its multiples.
    """
    step = resolution(samples)
    if step == 0.0:
        return 0.0
    places = np.round((samples - samples[0]) / step)
    # a decimal file writes 8 digits or more of a place, so that a tenth of a step is far from rounding
    off = float(np.max(np.abs((samples - samples[0]) / step - places)))
    sizes = np.unique(np.abs(np.diff(places)))
    return float(step) if off < 0.1 and np.sum(sizes > 0.0) >= SIZES else 0.0
