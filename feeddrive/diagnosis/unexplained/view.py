"""What is left of a recording, beside the variables it may depend on.

No variable holds what is being explained: motion and load are those of the plant driven by the measured motor, not the
recorded torque nor the recorded table position.

Whether anything is left above the noise, and how sure that is, says `excess`:

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
from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from feeddrive.diagnosis.likelihood.evidence import Evidence
from feeddrive.diagnosis.likelihood.folds import block_of_rows, dealt_blocks
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.motion.axis_evidence import AxisEvidence
from feeddrive.diagnosis.motion.band import NOISE_BLOCK
from feeddrive.diagnosis.unexplained.unexplained_result import Above
from feeddrive.plant.plant import Plant
from feeddrive.typing import BoolArray, FloatArray, IntegerArray

SLOW = 1e-3
"""Share of the highest speed at which a direction turns, where the plant declares no guide friction that says."""


SCATTER = 5.25
"""Variance of a block's mean square of fourth differences of white noise, over its square, times the samples."""

QUANTILE, LOWER, DENSITY = 0.1, 1.2816, 0.1755
"""Quantile that is read, its distance from the mean in standard deviations, and the normal density there."""


@dataclass(frozen=True)
class View:
    """What is left of one channel of one recording.

    Attributes:
        evidence: the recording.
        channel: name.
        residual: measured less predicted in the band, (n,); only `rows` count.
        rows: samples that count, thinned to those that carry what is in the band, (n,).
        values: variable to its series, (n,), SI.
        floor: of the noise.
        shown: terms to their columns in the band, thinned; the channels of a recording share them.
    """

    evidence: Evidence
    channel: str
    residual: FloatArray
    rows: BoolArray
    values: Mapping[str, FloatArray]
    floor: Floor
    shown: dict[Hashable, FloatArray]

    @property
    def left(self) -> FloatArray:
        """The residual where it counts, the zero of a scale taken out, (m,)."""
        residual = self.residual[self.rows]
        return residual - residual.mean() if self.channel in self.evidence.floating else residual

    @property
    def blocks(self) -> IntegerArray:
        """Block of time of every row that counts, (m,)."""
        return block_of_rows(self.evidence, np.flatnonzero(self.rows))

    @property
    def dealt(self) -> IntegerArray:
        """The blocks under numbers whose remainder by `FOLDS` is their fold, (m,)."""
        return dealt_blocks(self.evidence)[self.blocks]


def views_of(
    problem: Problem, plants: Sequence[tuple[Plant, Evidence]], channels: Sequence[str], judged: bool
) -> dict[str, tuple[View, ...]]:
    """Views of channels, of those recordings that have them, at the fitted or at the judged samples.

    Args:
        problem: whose predictor is used.
        plants: for each recording the plant that predicts it, and the recording.
        channels: names.
        judged: whether the judged samples count, or else the fitted ones.
    """
    views: dict[str, list[View]] = {channel: [] for channel in channels}
    for plant, evidence in plants:
        predicted = problem.predictor.predict(plant, evidence)
        values = variables_of(problem, plant, evidence, predicted)
        thinned = evidence.thinned(evidence.judged_rows if judged else evidence.fit_rows)
        shown: dict[Hashable, FloatArray] = {}
        for channel in channels:
            if channel not in evidence.channels:
                continue
            residual = evidence.measured[channel] - predicted[channel]
            rows = thinned & np.isfinite(residual)
            radius = plant.chain.motor_radius if channel == "table_position" else 0.0
            floor = noise_floor(evidence, channel, radius)
            views[channel].append(View(evidence, channel, residual, rows, values, floor, shown))
    return {channel: tuple(own) for channel, own in views.items()}


def variables_of(
    problem: Problem, plant: Plant, evidence: Evidence, predicted: Mapping[str, FloatArray]
) -> dict[str, FloatArray]:
    """Variables that a residual may depend on, (n,) each, SI; `predicted` channels in the band, (n,) each."""
    clock = np.asarray(evidence.recording.time - evidence.recording.time[0], dtype=float)
    if not problem.predictor.of_motion:
        return {"time": clock, **problem.predictor.variables(plant, evidence)}
    motion = problem.predictor.variables(plant, evidence)
    position, velocity = motion["table_position"], motion["table_velocity"]
    direction = np.tanh(velocity / _turning_speed(plant, velocity))
    torque = {"predicted_torque": predicted["motor_torque"]} if "motor_torque" in predicted else {}
    return {
        "time": clock,
        **motion,
        "table_acceleration": np.gradient(velocity, evidence.recording.sample_time),
        **torque,
        "direction": direction,
        "travel_since_reversal": travel_since_reversal(position, direction),
    }


def _turning_speed(plant: Plant, velocity: FloatArray) -> float:
    """Velocity at which the direction turns [m/s]: that of the declared guide friction, where there is one."""
    for effect in plant.effects:
        declared = effect.values.get("smoothing_velocity")
        if isinstance(declared, float):
            return declared
    return SLOW * max(float(np.abs(velocity).max()), 1e-9)


def travel_since_reversal(position: FloatArray, direction: FloatArray) -> FloatArray:
    """Distance [m] from where the table last turned round, (n,)."""
    way = np.sign(np.where(np.abs(direction) > 0.5, direction, 0.0))
    moving = np.flatnonzero(way)
    if len(moving) == 0:
        return np.zeros(len(position))
    last = np.maximum.accumulate(np.where(way != 0, np.arange(len(way)), moving[0]))
    held = way[last]
    turned = np.concatenate([[True], held[1:] != held[:-1]])
    origin = np.maximum.accumulate(np.where(turned, np.arange(len(way)), 0))
    distance: FloatArray = np.abs(position - position[origin])
    return distance


@dataclass(frozen=True)
class Floor:
    """Rms of the sensor noise in the band, and its standard error; unit of the channel."""

    rms: float
    standard_error: float


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


def above_noise(views: Sequence[View]) -> Above:
    """What is left of a channel above the noise, its recordings pooled."""
    return excess([v.left for v in views], [v.blocks for v in views], [v.floor for v in views])


def excess(residuals: Sequence[FloatArray], blocks: Sequence[IntegerArray], floors: Sequence[Floor]) -> Above:
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
    return Above(share, error, math.sqrt(square), math.sqrt(noise))
