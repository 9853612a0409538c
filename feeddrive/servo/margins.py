"""Margins of a loop from its frequency response: gain, phase, delay margin and the peak of the sensitivity."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from feeddrive.typing import ComplexArray, FloatArray

if TYPE_CHECKING:
    import control

GROWTH = 0.1
"""[1/s] above which a loop counts as unstable.

A free position has an eigenvalue of 1, known to about 1e-7 after rounding, which is 1e-3 1/s at 8 kHz.
"""

POINTS = 20_000
"""Points of the grid; crossings are interpolated between them."""

_MANY_STATES = 60
"""States from which on the triangular form is quicker; a dead time of many ticks makes one of each."""

_AT_ONCE = 1000
"""Frequencies that are solved together; more would take memory and no less time."""


@dataclass(frozen=True)
class Margins:
    """How far a loop is from instability; a margin that does not exist is infinite and its frequency NaN.

    Attributes:
        gain: smallest gain margin [dB].
        gain_frequency: where [Hz].
        phase: smallest phase margin [deg].
        phase_frequency: where the loop gain is 1 there [Hz].
        sensitivity: largest |1 / (1 + L)| [1].
        stable: whether the closed loop is; the margins of one that is not mean nothing.
    """

    gain: float
    gain_frequency: float
    phase: float
    phase_frequency: float
    sensitivity: float
    stable: bool


def frequency_response(system: control.StateSpace, frequency: FloatArray) -> ComplexArray:
    """Complex response D + C (z - A)^-1 B of a system of one input and one output at frequencies [Hz], shape (n,).

    States in SI are of very unlike size (metres beside torques and integrals of speed); A is balanced first, without
    which a loop that has fallen to 1e-6 would be a sum whose terms cancel, known to 1e-12 alone.
    """
    from scipy.linalg import matrix_balance  # takes time to import

    s = 2j * math.pi * np.atleast_1d(np.asarray(frequency, dtype=float))
    z = np.exp(s * system.dt) if system.dt else s
    a, b, c, d = (np.asarray(matrix, dtype=float) for matrix in (system.A, system.B, system.C, system.D))
    response: ComplexArray = np.full(z.shape, d[0, 0], dtype=np.complex128)
    if len(a):
        a, (scale, _) = matrix_balance(a, permute=False, separate=True)
        b, c = b / scale[:, None], c * scale
    if len(a) > _MANY_STATES:
        return response + _by_triangle(a, b, c, z)
    for first in range(0, len(z) if len(a) else 0, _AT_ONCE):
        part = slice(first, first + _AT_ONCE)
        response[part] += (c @ np.linalg.solve(z[part, None, None] * np.eye(len(a)) - a, b))[:, 0, 0]
    return response


def _by_triangle(a: FloatArray, b: FloatArray, c: FloatArray, z: ComplexArray) -> ComplexArray:
    """C (z - A)^-1 B by the Schur form A = Q T Q^H, which takes n^2 steps per frequency in place of n^3, shape of z."""
    from scipy.linalg import schur  # takes time to import

    t, q = schur(a, output="complex")
    given, x = q.conj().T @ b, np.zeros((len(a), *z.shape), dtype=np.complex128)
    for row in range(len(a) - 1, -1, -1):
        x[row] = (given[row] + t[row, row + 1 :] @ x[row + 1 :]) / (z - t[row, row])
    found: ComplexArray = (c @ q @ x)[0]
    return found


def margins(loop: control.StateSpace, lowest: float = 0.1, points: int = POINTS) -> Margins:
    """Margins of an open discrete loop with negative feedback, one in, one out, from the frequency `lowest` [Hz] on.

    Gain margins count above 0 dB only (gain that may be added); every crossing up to half the sample rate is seen.
    """
    frequency = np.geomspace(lowest, 0.5 / loop.dt, points)
    return margins_of(frequency, frequency_response(loop, frequency), _stable(loop))


def margins_of(frequency: FloatArray, response: ComplexArray, stable: bool) -> Margins:
    """Margins of an open loop from its response.

    Args:
        frequency: ascending, dense enough to follow the phase [Hz], shape (n,).
        response: complex, shape (n,).
        stable: whether the closed loop is; margins do not tell.
    """
    # a sampled low-pass is exactly zero at half the sample rate
    magnitude = np.log(np.maximum(np.abs(response), np.finfo(float).tiny))
    phase = np.unwrap(np.angle(response))
    turns = 2 * math.pi * np.round((phase[0] + math.pi / 2) / (2 * math.pi))  # begin near -90 deg
    found = _crossings(frequency, magnitude, phase - turns)
    gain = min(found[0], default=(math.inf, math.nan))
    least = min(found[1], default=(math.inf, math.nan))
    decibel = 20 * gain[0] / math.log(10)
    peak = float(np.max(1 / np.abs(1 + response)))
    return Margins(decibel, gain[1], math.degrees(least[0]), least[1], peak, stable)


def _stable(loop: control.StateSpace) -> bool:
    """Whether the loop is stable when it is closed, by its eigenvalues."""
    closed = np.asarray(loop.A) - np.asarray(loop.B) @ np.asarray(loop.C) / (1 + float(loop.D[0, 0]))
    return bool(math.log(np.max(np.abs(np.linalg.eigvals(closed)))) / float(loop.dt) < GROWTH)


def _crossings(
    frequency: FloatArray, magnitude: FloatArray, phase: FloatArray
) -> tuple[list[tuple[float, float]], list[tuple[float, float]]]:
    """(ln of gain that may be added, frequency) at each -180 deg, (phase margin, frequency) at each gain of 1."""
    beyond = np.floor((phase + math.pi) / (2 * math.pi))
    gains = []
    for i in np.flatnonzero(np.diff(beyond)):
        target = 2 * math.pi * max(beyond[i], beyond[i + 1]) - math.pi
        share = (target - phase[i]) / (phase[i + 1] - phase[i])
        value = magnitude[i] + share * (magnitude[i + 1] - magnitude[i])
        if value < 0:
            gains.append((float(-value), float(frequency[i] + share * (frequency[i + 1] - frequency[i]))))
    phases = []
    for i in np.flatnonzero(np.diff(np.signbit(magnitude))):
        share = -magnitude[i] / (magnitude[i + 1] - magnitude[i])
        at = phase[i] + share * (phase[i + 1] - phase[i])
        distance = abs((at + math.pi + math.pi) % (2 * math.pi) - math.pi)
        phases.append((float(distance), float(frequency[i] + share * (frequency[i + 1] - frequency[i]))))
    return gains, phases
