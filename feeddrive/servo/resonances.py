"""Resonances and anti-resonances: by poles and zeros of a system, and by the extrema of a curve.

    resonance       pole p:  f = |p| / 2 pi,  D = -Re p / |p|
    anti-resonance  zero z:  f = |z| / 2 pi,  D = -Re z / |z|

| symbol | meaning | unit |
|---|---|---|
| f | natural frequency | Hz |
| D | damping ratio | 1 |

Zeros are those of the pencil (A - z, B; C, D), the motions that the output does not show. For motor torque to motor
speed they are the modes with the motor held. A pole and a zero that nearly coincide cannot be seen on the curve.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import StrEnum
from typing import TYPE_CHECKING

import numpy as np

from feeddrive.typing import ComplexArray, FloatArray

if TYPE_CHECKING:
    import control

_MOST_DAMPED = 0.5
"""Roots of more damping leave no extremum worth the name."""

_PROMINENCE = 1.0
"""[dB] by which an extremum stands out of the curve."""

_SAME = 0.1
"""Share of frequency within which an extremum of the curve belongs to a root."""


class Kind(StrEnum):
    """Peak or dip."""

    RESONANCE = "resonance"
    ANTI_RESONANCE = "anti-resonance"


@dataclass(frozen=True)
class Resonance:
    """A lightly damped pole or zero.

    Attributes:
        kind: pole or zero.
        frequency: natural [Hz].
        damping: ratio [1].
    """

    kind: Kind
    frequency: float
    damping: float


@dataclass(frozen=True)
class Extremum:
    """A peak or dip of a magnitude curve.

    Attributes:
        kind: peak or dip.
        frequency: of the extremum [Hz].
        decibel: magnitude there [dB].
        prominence: by which it stands out [dB].
    """

    kind: Kind
    frequency: float
    decibel: float
    prominence: float


def resonances(system: control.StateSpace, low: float, high: float) -> tuple[Resonance, ...]:
    """Lightly damped poles and zeros of a continuous system, one in, one out, between frequencies [Hz]."""
    sets = ((Kind.RESONANCE, system.poles()), (Kind.ANTI_RESONANCE, system.zeros()))
    found = [root for kind, values in sets for root in _rooted(kind, values) if low <= root.frequency <= high]
    return tuple(sorted(found, key=lambda root: root.frequency))


def _rooted(kind: Kind, values: ComplexArray) -> list[Resonance]:
    upper = [complex(value) for value in values if np.isfinite(value) and value.imag > 0]
    roots = [Resonance(kind, abs(value) / (2 * math.pi), -value.real / abs(value)) for value in upper]
    return [root for root in roots if abs(root.damping) <= _MOST_DAMPED]


def extrema(frequency: FloatArray, values: ComplexArray) -> tuple[Extremum, ...]:
    """Peaks and dips of a curve, ascending in frequency, each refined by a parabola through its three points.

    Args:
        frequency: ascending [Hz], shape (n,).
        values: complex, shape (n,).
    """
    from scipy.signal import find_peaks  # takes a second to import

    curve: FloatArray = 20 * np.log10(np.maximum(np.abs(values), np.finfo(float).tiny))
    found: list[Extremum] = []
    for kind, sign in ((Kind.RESONANCE, 1.0), (Kind.ANTI_RESONANCE, -1.0)):
        places, properties = find_peaks(sign * curve, prominence=_PROMINENCE)
        for place, prominence in zip(places, properties["prominences"], strict=True):
            at, height = _vertex(np.log(frequency[place - 1 : place + 2]), curve[place - 1 : place + 2])
            found.append(Extremum(kind, math.exp(at), height, float(prominence)))
    return tuple(sorted(found, key=lambda one: one.frequency))


def on_curve(root: Resonance, seen: tuple[Extremum, ...]) -> Extremum | None:
    """The extremum of a curve that a pole or zero makes; None where it cannot be seen."""
    alike = [one for one in seen if one.kind is root.kind]
    near = [one for one in alike if abs(one.frequency / root.frequency - 1) < _SAME]
    return min(near, key=lambda one: abs(one.frequency - root.frequency), default=None)


def _vertex(x: FloatArray, y: FloatArray) -> tuple[float, float]:
    """Vertex of the parabola through three points; the middle one where they lie too close for it."""
    a, b, c = np.polyfit(x - x[1], y, 2)
    shift = -b / (2 * a) if a else 0.0
    inside = x[0] - x[1] <= shift <= x[2] - x[1]
    return (float(x[1] + shift), float(c - b * b / (4 * a))) if inside else (float(x[1]), float(y[1]))
