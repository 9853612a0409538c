"""Periodogram over an angle: which orders per revolution a residual holds."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.signal import find_peaks

from feeddrive.typing import FloatArray

BINS_PER_TURN = 256
"""Angle bins per revolution; the highest order is a quarter of it."""

LEAST_PERIODS = 5
"""Periods in the travel below which a sine is a trend over the stroke."""

OVERSAMPLING = 8
"""Zero padding, so that a peak is met to an eighth of the resolution."""


def strongest_orders(
    angle: FloatArray, residual: FloatArray, highest: float = BINS_PER_TURN / 4, count: int = 3, lowest: float = 0.0
) -> list[float]:
    """Orders per revolution of the largest peaks.

    The residual is averaged per angle bin first, so that rests and slow strokes do not weigh by their duration.

    Args:
        angle: shape (n,) [rad].
        residual: shape (n,).
        highest: order up to which peaks count.
        count: how many.
        lowest: order from which peaks count.

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
    allowed = (orders > max(lowest, LEAST_PERIODS / turns)) & (orders < min(highest, BINS_PER_TURN / 4))
    spectrum = np.where(allowed, spectrum, 0.0)
    peaks, _ = find_peaks(spectrum, distance=OVERSAMPLING)
    best = peaks[np.argsort(spectrum[peaks])[::-1][:count]]
    return [float(orders[i]) for i in best]


def sine_at(angle: FloatArray, residual: FloatArray, order: float) -> tuple[float, float]:
    """Amplitude and phase of the best sine of this order: residual = A sin(order angle + phase) + constant."""
    columns = np.column_stack([np.sin(order * angle), np.cos(order * angle), np.ones(len(angle))])
    a, b, _ = np.linalg.lstsq(columns, residual, rcond=None)[0]
    return float(np.hypot(a, b)), float(np.arctan2(b, a))


@dataclass(frozen=True)
class Sine:
    """A sine over an angle: residual = amplitude sin(order angle + phase), and the share of the square it takes."""

    order: float
    amplitude: float
    phase: float
    share: float


def strongest_sines(
    angle: FloatArray, residual: FloatArray, speed: FloatArray, edge: float, count: int = 3
) -> list[Sine]:
    """Sines that take most of a residual, each looked for at the samples at which it is in the band.

    An order n shows where n |speed| is below the edge: a high one at low speed alone, where the fast strokes, in which
    it is filtered off, or sampled as another one, are noise. So octaves of orders are looked for, each where the speed
    is so low that the whole octave is in the band; what each takes of the square is compared (of noise the best takes
    as much of few samples as of many).

    Args:
        angle: shape (n,) [rad].
        residual: shape (n,).
        speed: rate of the angle, (n,) [rad/s].
        edge: of the band [Hz].
        count: how many.

    Returns:
        Sines, the one that takes most first.
    """
    fastest, square = float(np.max(np.abs(speed), initial=0.0)), float(residual @ residual)
    if fastest == 0.0 or square == 0.0:
        return []
    found, lowest, highest = [], 0.0, 2 * np.pi * edge / fastest
    while lowest < BINS_PER_TURN / 4:
        slow = np.abs(speed) * highest <= 2 * np.pi * edge * (1 + 1e-9)
        if not slow.any():
            break
        there, left = angle[slow], residual[slow]
        for order in strongest_orders(there, left, highest, count, lowest):
            amplitude, phase = sine_at(there, left, order)
            found.append(Sine(order, amplitude, phase, 0.5 * amplitude**2 * len(left) / square))
        lowest, highest = highest, 2 * highest
    return sorted(found, key=lambda one: -one.share)[:count]
