"""What of the expected motion is uncertain with the motion itself, and what the declared plant makes of that.

The motion A that is expected (`encoder_error`) holds some of the steps' error still. What moved, frequency by
frequency, is not A in the mean but

    E[A_true | A] = (1 - κ(f) ρ(f)) A,   ρ = min(S_error / S_A, 1),   κ ~ N(1, 1) + i N(0, 1)

| symbol | meaning | unit |
|---|---|---|
| S_error, S_A | spectra of the errors that are drawn, and of A | rad² s |
| κ | straight in log f between nodes: `SPACING` apart, and closer about the poles with the motor held | 1 |

κ is nothing where the error is independent of A, one where it is independent of the motion (Carroll et al., Measurement
Error in Nonlinear Models (2006), chapter 3: attenuation). Under a drive it is neither: the loop answers the steps, the
motor moves with that, and κ is the sensitivity 1 / (1 + L) of the loop, complex, of size one, and up to two in a loop
that rings (Forssell and Ljung, Automatica 35 (1999) 1215). A plant that answers the motor as a filter does (a further
mode, a softer spring, another mass) lowers the error by what κ ρ takes from A, on blocks left out as well, as loop and
encoder are the same there. At a pole of the load with the motor held the motor is hardly moved, L is nothing, and the
sensitivity goes to one and back: over the width 1 / |L| of the frequency, which is nobody's to know, the pole's own at
least. Nodes stand at the pole, its half width away and twice as far each time until they are as far apart as all are.

So (1 - ρ) A is simulated, and what the declared plant makes of ρ A around every node is a column that each comparison
is without, as far as a deviation of one goes, at once and a quarter of a period later. Neither names nor declared
values are told by it.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np
from scipy.fft import irfft, next_fast_len, rfft

from feeddrive.typing import ComplexArray, FloatArray

SPACING = 2 ** (1 / 3)
"""Ratio of the frequencies of two nodes. A resonance of a loop that is damped by a quarter turns the sensitivity by
a radian over half an octave; what is straight over a third of one follows that."""

HALF = 0.5
"""Share ρ from which a motion is left out: less is missed without it than with it. Left in, it would shake the load,
and friction that turns with it is none in the mean."""

LEAST = 1e-3
"""Share ρ from which a frequency has a node: what is less, a recording of some thousand independent values does not
tell from none."""


def unsure_motions(
    angle: FloatArray, share: FloatArray, sample_time: float, edge: float, poles: Sequence[complex] = ()
) -> Iterator[FloatArray]:
    """Parts of a motion that may not be, or may be late, one for each node and phase.

    Args:
        angle: expected motion of the motor [rad], (n,), at rest at its ends.
        share: ρ at the frequencies of n samples, (n // 2 + 1,).
        sample_time: [s].
        edge: of the band of the comparison [Hz].
        poles: of the load with the motor held [1/s].

    Yields:
        Angle [rad], (n,).
    """
    frequency, spectrum = _turned(angle, sample_time)
    shares = np.interp(frequency, np.fft.rfftfreq(len(angle), sample_time), share)
    seen = frequency[(shares >= LEAST) & (frequency <= edge)]
    if not len(seen):
        return
    first, floor = max(seen[0], frequency[1]), 1 / (len(angle) * sample_time)
    count = math.ceil(math.log(edge / first) / math.log(SPACING)) + 2
    nodes = [first * SPACING**node for node in range(-1, count + 1)]
    for pole in poles:
        width = max(-pole.real / (2 * math.pi), floor)
        centre = abs(pole.imag) / (2 * math.pi)
        nodes.append(centre)
        while width < 0.5 * (SPACING - 1) * centre:
            nodes += [centre - width, centre + width]
            width *= 2
    inside = [node for node in nodes if nodes[0] <= node <= nodes[count + 1]]
    places, at = np.unique(np.log(inside)), np.log(np.maximum(frequency, frequency[1]))
    for hat in np.eye(len(places))[1:-1]:
        part = shares * np.interp(at, places, hat)
        if not part.any():
            continue
        for phase in (1.0, 1j):
            yield irfft(spectrum * part * phase)[: len(angle)]


def without_share(angle: FloatArray, share: FloatArray, sample_time: float) -> FloatArray:
    """A motion without what is not told of it: (1 - ρ) of it where the error is less than the rest, none elsewhere.

    Args:
        angle: expected motion of the motor [rad], (n,), at rest at its ends.
        share: ρ at the frequencies of n samples, (n // 2 + 1,).
        sample_time: [s].
    """
    frequency, spectrum = _turned(angle, sample_time)
    shares = np.interp(frequency, np.fft.rfftfreq(len(angle), sample_time), share)
    lost: FloatArray = irfft(spectrum * left_out(shares))[: len(angle)]
    return angle - lost


def left_out(share: FloatArray) -> FloatArray:
    """How much of a motion is left out of which a share ρ is error."""
    return np.where(share < HALF, share, 1.0)


def _turned(angle: FloatArray, sample_time: float) -> tuple[FloatArray, ComplexArray]:
    """Frequencies [Hz] and spectrum of a motion, twice as long: without the stroke, which would jump at the end."""
    size = next_fast_len(2 * len(angle), real=True)
    size += size % 2  # irfft takes an even length
    frequency: FloatArray = np.asarray(np.fft.rfftfreq(size, sample_time), dtype=np.float64)
    difference = (2 * np.sin(np.pi * frequency * sample_time)) ** 2
    spectrum: ComplexArray = -rfft(np.concatenate([[0.0], np.diff(angle, 2), [0.0]]), size)
    return frequency, spectrum / np.where(difference > 0, difference, 1.0)
