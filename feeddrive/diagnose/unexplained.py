"""What is left after all effects: how much above the noise, and on which measured variable it depends."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from feeddrive.diagnose.periodogram import sine_at, strongest_orders
from feeddrive.diagnose.result import ChannelResult, Dependence, JudgedRecording, Unexplained
from feeddrive.typing import FloatArray

BINS = 40
"""Bins of a variable."""

LEAST_SHARE = 0.05
"""Share of the residual's square that a variable must explain to be named."""


def unexplained(channel: ChannelResult, recordings: Sequence[JudgedRecording]) -> Unexplained:
    """What is left of one channel: share of the measured square above the noise, and the variables that it follows."""
    after = channel.after
    above = max(after.rms**2 - channel.noise_rms**2, 0.0)
    measured = after.rms / after.relative if after.relative > 0 else float("inf")
    longest = max(recordings, key=lambda recording: len(recording.time))
    series = next(s for s in longest.channels if s.name == channel.name)
    residual = series.measured - series.after
    kept = np.isfinite(residual)
    found = []
    for variable, values in longest.variables.items():
        share = _explained(values[kept], residual[kept])
        if share > LEAST_SHARE:
            found.append(Dependence(variable, share))
    if "motor_angle" not in longest.variables:
        return Unexplained(above / measured**2, tuple(sorted(found, key=lambda d: -d.share)))
    angle = longest.variables["motor_angle"][kept]
    for order in strongest_orders(angle, residual[kept], count=1):
        amplitude, _ = sine_at(angle, residual[kept], order)
        share = 0.5 * amplitude**2 / float(np.mean(residual[kept] ** 2))
        if share > LEAST_SHARE:
            found.append(Dependence("motor_angle", share, f"{2 * np.pi / order:.4g} rad ({order:.4g} per revolution)"))
    return Unexplained(above / measured**2, tuple(sorted(found, key=lambda d: -d.share)))


def _explained(variable: FloatArray, residual: FloatArray) -> float:
    """Share of the residual's variance that its mean per bin of the variable explains, less what chance would."""
    if not np.ptp(variable) > 0:
        return 0.0
    edges = np.unique(np.quantile(variable, np.linspace(0, 1, BINS + 1)))
    bins = np.clip(np.searchsorted(edges, variable, side="right") - 1, 0, len(edges) - 2)
    count = np.bincount(bins, minlength=len(edges) - 1)
    mean = np.bincount(bins, weights=residual, minlength=len(edges) - 1) / np.maximum(count, 1)
    total = float(np.sum((residual - residual.mean()) ** 2))
    between = float(np.sum(count * (mean - residual.mean()) ** 2))
    return between / total if total > 0 else 0.0
