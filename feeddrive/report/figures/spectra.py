"""Spectra of residuals with left-out stretches: over time in Hz, and over the screw in orders per revolution."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from feeddrive.diagnosis.judging.result import JudgedRecording
from feeddrive.report.thinning import runs
from feeddrive.typing import FloatArray

_BINS_PER_REVOLUTION = 160
_HIGHEST_ORDER = 40.0
_FEWEST_REVOLUTIONS = 3.0
_SEGMENT_SECONDS = 4.0
_LONGEST_ANGLE_GRID = 2**17


@dataclass(frozen=True)
class Spectrum:
    """Abscissa (frequency [Hz] or order per revolution) and amplitudes in the channel's unit, shape (points,) each."""

    abscissa: FloatArray
    amplitude: FloatArray


def sample_time(time: FloatArray) -> float:
    """The usual distance of two samples [s], NaN for fewer than two samples."""
    return float(np.median(np.diff(time))) if time.size > 1 else float("nan")


def density_spectrum(recordings: list[tuple[JudgedRecording, FloatArray]]) -> Spectrum | None:
    """Welch amplitude spectral density over all recordings that share the most usual sample time.

    Args:
        recordings: recordings with the residual to analyse, shape (n,), NaN where left out.

    Returns:
        Frequency [Hz] and density [unit/sqrt(Hz)], or None where no stretch is long enough.
    """
    steps = [sample_time(recording.time) for recording, _ in recordings]
    usable = [step for step in steps if np.isfinite(step) and step > 0.0]
    if not usable:
        return None
    step = max(usable, key=lambda one: sum(abs(other / one - 1.0) < 0.01 for other in usable))
    same = [
        values[first:last]
        for (_, values), own in zip(recordings, steps, strict=True)
        if abs(own / step - 1.0) < 0.01
        for first, last in runs(np.isfinite(values))
    ]
    return _welch(same, step)


def _welch(stretches: list[FloatArray], step: float) -> Spectrum | None:
    """Mean square over half-overlapping Hann segments of all stretches without gaps."""
    longest = max((stretch.size for stretch in stretches), default=0)
    segment = min(longest, max(256, round(_SEGMENT_SECONDS / step)))
    if segment < 32:
        return None
    pieces = np.array(
        [
            stretch[first : first + segment]
            for stretch in stretches
            for first in range(0, stretch.size - segment + 1, segment // 2)
        ]
    )
    window = np.hanning(segment)
    lines = np.fft.rfft((pieces - pieces.mean(axis=1, keepdims=True)) * window)
    density = 2.0 * step * np.mean(np.abs(lines) ** 2, axis=0) / np.sum(window**2)
    frequency = np.asarray(np.fft.rfftfreq(segment, step), dtype=np.float64)
    return Spectrum(frequency[1:], np.sqrt(density[1:]))


def order_spectrum(recordings: list[tuple[FloatArray, FloatArray]]) -> Spectrum | None:
    """Amplitude of the position-locked part of a residual over orders per motor revolution.

    Averaging over equal angles first removes what changes with direction or time. The zeros of the recordings may
    differ: their spectra are averaged as squares, without phase.

    Args:
        recordings: motor angle [rad] and residual of each recording, shape (n,), NaN where left out.

    Returns:
        Order [1/rev] and amplitude [unit], or None where fewer than three revolutions were travelled.
    """
    lines = [line for angle, residual in recordings if (line := _angle_line(angle, residual)) is not None]
    if not lines:
        return None
    orders = np.geomspace(max(0.3, 1.0 / min(line.abscissa[-1] for line in lines)), _HIGHEST_ORDER, 1200)
    squares = [np.interp(orders, *_order_lines(line)) ** 2 for line in lines]
    return Spectrum(orders, np.sqrt(np.mean(squares, axis=0)))


def _angle_line(angle: FloatArray, residual: FloatArray) -> Spectrum | None:
    """Mean residual over equal steps of angle; abscissa in revolutions from the first, NaN where never passed."""
    kept = np.isfinite(angle) & np.isfinite(residual)
    if not np.any(kept):
        return None
    turns = angle[kept] / (2.0 * np.pi)
    turns = turns - turns.min()
    if turns.max() < _FEWEST_REVOLUTIONS:
        return None
    count = min(_LONGEST_ANGLE_GRID, int(turns.max() * _BINS_PER_REVOLUTION))
    index = np.minimum((turns / turns.max() * count).astype(np.int64), count - 1)
    passes = np.bincount(index, minlength=count)
    total = np.bincount(index, weights=residual[kept], minlength=count)
    mean = np.where(passes > 0, total / np.maximum(passes, 1), np.nan)
    return Spectrum((np.arange(count) + 0.5) / count * turns.max(), mean)


def _order_lines(line: Spectrum) -> tuple[FloatArray, FloatArray]:
    """Orders and amplitudes of a line over angle, under a Hann window that is zero where no sample fell."""
    filled = np.isfinite(line.amplitude)
    weight = np.where(filled, np.hanning(line.amplitude.size), 0.0)
    values = np.where(filled, line.amplitude, 0.0)
    centred = values - np.sum(weight * values) / np.sum(weight)
    length = 4 * 2 ** int(np.ceil(np.log2(values.size)))
    step = float(line.abscissa[1] - line.abscissa[0])
    amplitude = 2.0 * np.abs(np.fft.rfft(weight * centred, length)) / np.sum(weight)
    orders = np.asarray(np.fft.rfftfreq(length, step), dtype=np.float64)
    return orders, amplitude
