"""What rounding to steps makes of a torque that comes again: an error that is the same at every passage.

    Q(f + s z) - f  =  Σ_m  Δ k_m (-1)^m / (π m)  sin(2 π m f / Δ)        on the mean over z
    k_m = exp(-2 π² m² s² / Δ²)
    S_nm = Δ k_m / (√2 π m) w(f / Δ - n) [cos(2 π m f / Δ), sin(2 π m f / Δ)]
    w(u) = cos(π u / 2) for |u| < 1, else 0

| symbol | meaning | unit |
|---|---|---|
| f | torque that is predicted | N m |
| Q, Δ | rounds to the steps of the recording; one of them | |
| s, z | noise below the steps; normal, of deviation 1 | N m |
| k_m | share of a wave of the rounding that comes again | 1 |
| S_nm | what a wave of the rounding may make, as far as a deviation of one goes, of torques about n steps | N m |

Where the noise below the steps is less than half of one, a torque that comes again is rounded alike each time: at a
steady speed the error stays, and looks like a friction that is other than declared. How large it is depends on where
f lies between two steps, and that nobody knows beforehand: friction is declared to a fifth. Torques that are more than
a step apart are therefore off by errors of their own, each of waves of any phase. Of many torques the last wave that is
told apart stands for those beyond it: at a steady speed all are alike.

Rows toggle between two steps as the noise lets them, P of them on the mean over where f lies:

    P = E min(|z'|, 1),    z' normal, of mean d / Δ and variance 2 s² / Δ²

d being what f changes by from row to row.

Noise that is not white from row to row toggles them less, and is counted for less than it is. Noise of half a step
leaves k_1 = 0.7 %: Widrow and Kollár, Quantization Noise (2008), chapter 4.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq
from scipy.special import ndtr

from feeddrive.typing import BoolArray, FloatArray, IntegerArray

BROKEN_UP = 0.5
"""Noise over a step from which nothing of the rounding comes again."""

STEADY = 0.1
"""Steps that a torque goes from row to row at a steady speed at most: beyond, rows tell of it and not of the noise."""

MOST = 64
"""Waves at most of all torques, those that most rows are about: others are passed through."""

WAVES = np.arange(1.0, 10.0)
"""Waves of the rounding: nine hold 0.94 of its square."""


@dataclass(frozen=True, eq=False)
class Rounding:
    """What rounding may make of a recorded torque.

    Attributes:
        steps: predicted torque over a step, (n,).
        sizes: of the waves, Δ k_m / (√2 π m), (w,) [N m].
        about: n of the torques that have an error of their own, (k,).
    """

    steps: FloatArray
    sizes: FloatArray
    about: IntegerArray

    @property
    def size(self) -> float:
        """Rms of what rounding makes [N m]."""
        return float(np.linalg.norm(self.sizes))

    def parts(self) -> Iterator[FloatArray]:
        """S_nm, (n,) each, two for every n and m [N m]."""
        for m, size in enumerate(self.sizes, start=1):
            angle = 2 * np.pi * m * self.steps
            waves = size * np.cos(angle), size * np.sin(angle)
            for n in self.about:
                window = np.cos(0.5 * np.pi * np.clip(self.steps - n, -1.0, 1.0))
                yield from (window * wave for wave in waves)


def rounding_of(torque: FloatArray, predicted: FloatArray, step: float, rows: BoolArray) -> Rounding | None:
    """What rounding may make of a torque; None where the noise breaks it up.

    Args:
        torque: as recorded, (n,) [N m].
        predicted: of the plant as declared, (n,) [N m].
        step: of the recording [N m].
        rows: that are compared, (n,).
    """
    through = np.abs(np.diff(predicted)) / step
    steady = rows[1:] & rows[:-1] & (through < STEADY)
    if not steady.any():
        return None
    toggled = np.abs(np.diff(torque)) > 0.5 * step
    noise = noise_over_step(float(np.mean(toggled[steady])), through[steady])
    if noise >= BROKEN_UP:
        return None
    steps = predicted / step
    about, count = np.unique(np.round(steps[rows]).astype(np.int64), return_counts=True)
    most = np.sort(about[np.argsort(-count, kind="stable")[:MOST]])
    sizes = step * np.exp(-2 * (np.pi * WAVES * noise) ** 2) / (math.sqrt(2) * math.pi * WAVES)
    told = min(max(MOST // len(most), 1), len(sizes))
    return Rounding(steps, np.append(sizes[: told - 1], np.linalg.norm(sizes[told - 1 :])), most)


def noise_over_step(toggled: float, through: FloatArray) -> float:
    """s / Δ where a share P of rows toggles, f going d / Δ, (n,), from row to row; `BROKEN_UP` for all larger ones."""
    if toggled >= toggling(BROKEN_UP, through):
        return BROKEN_UP
    if toggled <= np.mean(through):
        return 0.0
    return float(brentq(lambda noise: toggling(noise, through) - toggled, 0.0, BROKEN_UP))


def toggling(noise: float, through: FloatArray) -> float:
    """P of a noise over the step beside a torque that goes d / Δ, (n,), from row to row, of less than a step."""
    if noise <= 0:
        return float(np.mean(through))
    deviation = math.sqrt(2) * noise
    ahead, here, back = (deviation * _below((at - through) / deviation) for at in (1.0, 0.0, -1.0))
    return float(np.mean(1 - (ahead - 2 * here + back)))


def _below(at: FloatArray) -> FloatArray:
    """Integral of the normal distribution up to some deviations, (n,)."""
    below: FloatArray = at * ndtr(at) + np.exp(-0.5 * at**2) / math.sqrt(2 * math.pi)
    return below
