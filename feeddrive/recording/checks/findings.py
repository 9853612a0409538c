"""What is found in usable samples and reported: saturation and quantisation."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from feeddrive.recording.channels import INJECTED, channel_unit
from feeddrive.typing import BoolArray, FloatArray
from feeddrive.units.quantity import format_quantity

_LIMITED_CHANNELS = ("motor_torque", "motor_current", "cutting_force")  # a position at rest sits at its end rightly
_NOT_MEASURED = ("setpoint", "screw_speed", *INJECTED)  # a ramp repeats its own step, a programme has few values
_FEWEST_LEVELS = 5
_SATURATED_SHARE = 0.01
_SATURATED_RUN = 3  # samples in a row at the limit


def sample_notes(channels: Mapping[str, FloatArray]) -> tuple[str, ...]:
    """Say saturation and quantisation of channels, (n,) each."""
    notes: list[str] = []
    for name, samples in channels.items():
        unit = channel_unit(name, "")
        notes.extend(_saturation(name, samples, unit) if name in _LIMITED_CHANNELS else ())
        step = 0.0 if name in _NOT_MEASURED else quantisation_step(samples)
        if step > 0.0:
            notes.append(f"{name} moves in steps of {format_quantity(step, 'K' if unit == 'degC' else unit)}")
    return tuple(notes)


def quantisation_step(samples: FloatArray) -> float:
    """Return the step that samples, (n,), move in, or 0 if they have none: median of the smallest differences."""
    differences = np.diff(np.unique(samples))
    # Rounding errors of a unit conversion split equal values.
    differences = differences[differences > 1e-10 * np.max(np.abs(samples), initial=0.0)]
    if differences.size < _FEWEST_LEVELS:
        return 0.0
    smallest = differences[differences < 1.5 * differences.min()]  # two steps would be 2.0
    # Differences of a channel without steps do not come again: one or two of them lie as near to the least.
    return float(np.median(smallest)) if smallest.size >= 3 + 0.002 * differences.size else 0.0


def _saturation(name: str, samples: FloatArray, unit: str) -> list[str]:
    """Say the limits that a channel sits at."""
    notes = []
    for limit in sorted({float(samples.max()), float(samples.min())}):
        at_limit = samples == limit
        share = float(np.mean(at_limit))
        if share > _SATURATED_SHARE and _longest_run(at_limit) >= _SATURATED_RUN:
            notes.append(
                f"{name} is saturated at {format_quantity(limit, unit)} in {100.0 * share:.1f} % of the samples"
            )
    return notes


def _longest_run(mask: BoolArray) -> int:
    """Return the length of the longest run of True."""
    edges = np.flatnonzero(np.diff(np.concatenate(([False], mask, [False]))))
    return int(np.max(edges[1::2] - edges[::2], initial=0))
