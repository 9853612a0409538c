"""What of a diagnosis is drawn: labels of the two predictions, residuals, and limits on the number of figures."""

from __future__ import annotations

import re

import numpy as np

from feeddrive.diagnosis.judging.result import ChannelResult, ChannelSeries, Diagnosis, JudgedRecording
from feeddrive.report.figures.drawing import AFTER, BEFORE
from feeddrive.typing import FloatArray

MOST_SERIES_FIGURES = 6
MOST_CHANNELS_IN_DETAIL = 5


def stem_of(name: str) -> str:
    """A name as part of a file name."""
    return re.sub(r"[^a-z0-9]+", "_", name.lower()).strip("_") or "unnamed"


def detailed_channels(diagnosis: Diagnosis) -> list[ChannelResult]:
    """The channels that get figures of their own, those with the most error above noise, in their own order."""
    ranked = sorted(diagnosis.channels, key=_excess, reverse=True)[:MOST_CHANNELS_IN_DETAIL]
    return [channel for channel in diagnosis.channels if channel in ranked]


def _excess(channel: ChannelResult) -> float:
    """How far the error before stands above the noise; zero where the ratio is not finite."""
    noise = channel.noise_rms if channel.noise_rms > 0.0 else 1.0
    ratio = channel.before.rms / noise
    return float(ratio) if np.isfinite(ratio) else 0.0


def series_of(recording: JudgedRecording, channel: str) -> ChannelSeries | None:
    """The series of a channel in a recording, or None where it has none or only left-out samples."""
    for series in recording.channels:
        if series.name == channel and np.any(np.isfinite(series.measured - series.before)):
            return series
    return None


def drawn_series(diagnosis: Diagnosis) -> list[tuple[int, JudgedRecording, ChannelResult, ChannelSeries]]:
    """The pairs of recording and channel whose series are drawn, recording by recording, with its number from 1."""
    pairs = [
        (number, recording, channel, series)
        for number, recording in enumerate(diagnosis.recordings, start=1)
        for channel in detailed_channels(diagnosis)
        if (series := series_of(recording, channel.name)) is not None
    ]
    return pairs[:MOST_SERIES_FIGURES]


def residuals(diagnosis: Diagnosis, series: ChannelSeries) -> list[tuple[str, str, FloatArray]]:
    """Label, colour and residual (measured - predicted, SI, shape (n,)) of the predictions to draw.

    Only one where nothing was found, since both are the same plant.
    """
    before = series.measured - series.before
    if diagnosis.nothing_missing:
        return [("declared plant", BEFORE, before)]
    return [("before", BEFORE, before), ("after", AFTER, series.measured - series.after)]


def with_variable(
    diagnosis: Diagnosis, channel: str, variable: str
) -> list[tuple[JudgedRecording, ChannelSeries, FloatArray]]:
    """The recordings that have both the channel and the variable, with the variable's values, shape (n,)."""
    return [
        (recording, series, recording.variables[variable])
        for recording in diagnosis.recordings
        if variable in recording.variables and (series := series_of(recording, channel)) is not None
    ]
