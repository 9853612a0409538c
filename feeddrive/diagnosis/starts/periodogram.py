"""Periodogram over an angle: which orders per revolution a residual holds."""

from __future__ import annotations

import numpy as np

from feeddrive.typing import FloatArray

BINS_PER_TURN = 256
"""Angle bins per revolution; the highest order is a quarter of it."""

LEAST_PERIODS = 5
"""Periods in the travel below which a sine is a trend over the stroke."""

OVERSAMPLING = 8
"""Zero padding, so that a peak is met to an eighth of the resolution."""


def strongest_orders(
    angle: FloatArray, residual: FloatArray, highest: float = BINS_PER_TURN / 4, count: int = 3
) -> list[float]:
    """Orders per revolution of the largest peaks.

    The residual is averaged per angle bin first, so that rests and slow strokes do not weigh by their duration.

    Args:
        angle: shape (n,) [rad].
        residual: shape (n,).
        highest: order up to which peaks count.
        count: how many.

    Returns:
        Orders, the strongest first; empty if the angle covers less than two revolutions.
    """
    bins = np.floor(angle * BINS_PER_TURN / (2 * np.pi)).astype(int)
    bins -= bins.min()
    size = int(bins.max()) + 1
    turns = size / BINS_PER_TURN
    if turns < 2:
        return []
    samples = np.bincount(bins, minlength=size)
    filled = np.flatnonzero(samples)
    mean = np.bincount(bins, weights=residual - np.mean(residual), minlength=size)[filled] / samples[filled]
    # at speed whole bins are jumped over; left at zero they would put a comb of false orders into the spectrum
    even = np.interp(np.arange(size), filled, mean)
    padded = OVERSAMPLING * size
    spectrum = np.abs(np.fft.rfft(even * np.hanning(size), padded))
    orders = np.arange(len(spectrum)) * BINS_PER_TURN / padded
    allowed = (orders > LEAST_PERIODS / turns) & (orders < min(highest, BINS_PER_TURN / 4))
    spectrum = np.where(allowed, spectrum, 0.0)
    return [float(orders[i]) for i in _highest_peaks(spectrum, count)]


def _highest_peaks(spectrum: FloatArray, count: int) -> list[int]:
    """Places of the highest peaks, none within the resolution of a higher one; the highest first."""
    inner = spectrum[1:-1]
    peaks = 1 + np.flatnonzero((inner > spectrum[:-2]) & (inner > spectrum[2:]))
    best: list[int] = []
    near = np.zeros(len(spectrum), dtype=bool)
    for place in peaks[np.argsort(spectrum[peaks])[::-1]]:
        if near[place]:
            continue
        best.append(int(place))
        if len(best) == count:
            break
        near[max(place - OVERSAMPLING + 1, 0) : place + OVERSAMPLING] = True
    return best


def sine_at(angle: FloatArray, residual: FloatArray, order: float) -> tuple[float, float]:
    """Amplitude and phase of the best sine of this order: residual = A sin(order angle + phase) + constant."""
    columns = np.column_stack([np.sin(order * angle), np.cos(order * angle), np.ones(len(angle))])
    a, b, _ = np.linalg.lstsq(columns, residual, rcond=None)[0]
    return float(np.hypot(a, b)), float(np.arctan2(b, a))
