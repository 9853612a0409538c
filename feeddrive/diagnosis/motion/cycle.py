"""After what time a recorded motion comes again: a programme of cycles.

    q(L) = sum_t (v(t + L) - v(t))^2 / sum_t (v(t + L)^2 + v(t)^2)

| symbol | meaning | unit |
|---|---|---|
| v | rate of the motor angle | rad per sample |
| L | lag | samples |
| q | 0 where the motion is what it was, 1 where it has nothing to do with it | 1 |
"""

from __future__ import annotations

from weakref import WeakKeyDictionary

import numpy as np
from scipy.fft import irfft, next_fast_len, rfft

from feeddrive.recording import Recording

ALIKE = 0.01
"""q up to which a motion comes again. How much of an error does is asked of the error (`certainty.noise_colour`)."""

OTHER = 0.5
"""q from which a motion has become another: one that goes on as it was has not come again."""

_KNOWN: WeakKeyDictionary[Recording, dict[tuple[int, int], float]] = WeakKeyDictionary()
"""Cycles of recordings that are in use, which every comparison asks for."""


def cycle_of(recording: Recording, every: int, least: int) -> float:
    """Lag after which the motion comes again, in steps of `every` samples; 0 where it does not.

    Args:
        recording: with the motor angle, or without.
        every: samples of one step.
        least: steps of the shortest cycle that is asked for.

    Returns:
        The first lag of those, not a whole number of steps in general.
    """
    known = _KNOWN.setdefault(recording, {})
    if (every, least) not in known:
        known[every, least] = _cycle(recording, every, least)
    return known[every, least]


def _cycle(recording: Recording, every: int, least: int) -> float:
    if "motor_angle" not in recording.channels:
        return 0.0
    rate = np.diff(recording["motor_angle"][::every])
    count = len(rate)
    if count < 4:
        return 0.0
    size = next_fast_len(2 * count, real=True)
    products = irfft(np.abs(rfft(rate, size)) ** 2, size)[:count]
    begun = np.concatenate([[0.0], np.cumsum(rate**2)])
    squares = begun[count:0:-1] + (begun[-1] - begun[:-1])  # of the samples before the end, and of those from a lag on
    apart = 1.0 - 2.0 * products / np.where(squares > 0, squares, 1.0)
    apart = apart[: count // 2 + 2]
    others = np.flatnonzero(apart > OTHER)
    first = max(int(others[0]) if len(others) else len(apart), least, 1)
    inner = np.arange(first, len(apart) - 1)
    least_there = (apart[inner] <= ALIKE) & (apart[inner] <= apart[inner - 1]) & (apart[inner] < apart[inner + 1])
    if not least_there.any():
        return 0.0
    at = int(inner[least_there][0])
    below, lowest, above = apart[at - 1 : at + 2]
    bend = below - 2 * lowest + above
    return at + (0.5 * float((below - above) / bend) if bend > 0 else 0.0)
