"""Whether anything is left above the noise, and how sure that is.

    excess = (rms^2 - floor^2) / rms^2

The floor is the sensor noise in the band as `band.white_noise` reads it: the tenth part of the quietest blocks. That
quantile lies below the mean by z_0.1 times the scatter of a block's level, which for fourth differences of white noise
is 5.25 / m of the square (m samples a block, 5.25 = 2 sum R_k^2 / R_0^2); here it is put right, and its own scatter is
counted. A quantised motor angle moves the predicted table by up to r q / sqrt(12), more or less of which is in the band
with the speed: half of its square is taken for noise, and half for doubt. Where the steps matter (`encoder_error`) what
they add is drawn, and counted as noise and as doubt. The rms scatters with the blocks of time,
which counts correlation inside them.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from feeddrive.diagnosis.likelihood.band import NOISE_BLOCK
from feeddrive.diagnosis.likelihood.evidence import AxisEvidence, Evidence
from feeddrive.typing import FloatArray, IntegerArray

SCATTER = 5.25
"""Variance of a block's mean square of fourth differences of white noise, over its square, times the samples."""

QUANTILE, LOWER, DENSITY = 0.1, 1.2816, 0.1755
"""Quantile that is read, its distance from the mean in standard deviations, and the normal density there."""

ABOVE = 3.0
"""Standard errors by which the rms must stand above the floor for something to be left."""

MATERIAL = 0.03
"""Share of the squared rms below which what is left is not worth a word: a percent and a half of the rms."""


@dataclass(frozen=True)
class Floor:
    """Rms of the sensor noise in the band, and its standard error; unit of the channel."""

    rms: float
    standard_error: float


@dataclass(frozen=True)
class Excess:
    """What is left of a channel beside its noise.

    Attributes:
        share: of the squared rms above the floor; negative where the rms lies below it.
        standard_error: of the share.
        rms: of what is left, unit of the channel.
        floor: rms of the noise, unit of the channel.
    """

    share: float
    standard_error: float
    rms: float
    floor: float

    @property
    def is_left(self) -> bool:
        """Whether something is left above the noise."""
        return bool(self.share > max(ABOVE * self.standard_error, MATERIAL))


def noise_floor(evidence: Evidence, channel: str, radius: float = 0.0) -> Floor:
    """Noise of a channel in the band, what the model itself may miss included.

    Args:
        evidence: the recording.
        channel: its name.
        radius: travel per motor angle [m/rad] by which the angle's steps show in the channel; 0 where they do not.
    """
    noise, missed = evidence.noise[channel], evidence.missed(channel)
    if not isinstance(evidence, AxisEvidence):
        return Floor(math.hypot(noise, missed), 0.1 * noise)
    samples = max(16, int(NOISE_BLOCK / evidence.recording.sample_time))
    level = 0.5 * math.sqrt(SCATTER / samples)  # scatter of a block's rms over the rms
    blocks = max(len(evidence.recording) // samples, 1)
    spread = math.sqrt(QUANTILE * (1 - QUANTILE) / blocks) / DENSITY * level
    corrected = noise / (1 - LOWER * level)
    half = 0.5 * (radius * angle_step(evidence.recording["motor_angle"])) ** 2 / 12 if radius else 0.0
    if channel in evidence.added:  # known to what the drawn error says of it
        half = evidence.added[channel] ** 2
    rms = math.sqrt(corrected**2 + missed**2 + half)
    doubt = math.hypot(2 * spread * corrected**2, half)  # of the square
    return Floor(rms, doubt / (2 * rms) if rms > 0 else 0.0)


def angle_step(angle: FloatArray) -> float:
    """Least change between neighbouring samples [rad]: the step of an encoder; next to none where it is not seen."""
    changes = np.abs(np.diff(angle))
    return float(np.min(changes[changes > 0], initial=np.inf)) if np.any(changes > 0) else 0.0


def excess(residuals: Sequence[FloatArray], blocks: Sequence[IntegerArray], floors: Sequence[Floor]) -> Excess:
    """What is left above the noise, recordings pooled.

    Args:
        residuals: per recording, (n,); the mean is not taken out.
        blocks: block of time of every value, (n,).
        floors: per recording.
    """
    counts = np.array([len(residual) for residual in residuals], dtype=float)
    total = counts.sum()
    square = sum(float(residual @ residual) for residual in residuals) / total
    noise = float(np.sum(counts * [floor.rms**2 for floor in floors]) / total)
    doubt = float(np.sqrt(np.sum((counts * [2 * f.rms * f.standard_error for f in floors]) ** 2)) / total)
    scatter = 0.0
    for residual, block in zip(residuals, blocks, strict=True):
        sums = np.bincount(block, weights=residual**2 - square)
        scatter += float(sums @ sums)
    # scatter of the blocks about the mean is also how the error differs along the motion, which is no doubt about the
    # rms of this recording; it is counted, so that a single bad block is not taken for a machine
    error = math.hypot(noise / square * math.sqrt(scatter) / total, doubt) / square if square > 0 else 0.0
    share = float(1 - noise / square) if square > 0 else 0.0
    return Excess(share, error, math.sqrt(square), math.sqrt(noise))
