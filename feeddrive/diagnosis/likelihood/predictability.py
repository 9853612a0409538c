"""Which samples of a recording can be predicted at all, and which of them a fit can learn from.

With free play the load side can be chaotic: under a torque chirp, an angle error far below the encoder's step moves the
table by micrometres. The rule looks at that directly: the same plant is driven by the measured motion and by one that
differs by a tiny noise, and stretches where the difference grows are left out.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from feeddrive.diagnosis.likelihood.band import white_noise
from feeddrive.diagnosis.likelihood.evidence import AxisEvidence
from feeddrive.effects.base import TransmissionEffect
from feeddrive.plant.plant import Plant
from feeddrive.recording.checks.flaws import quantisation_step
from feeddrive.simulate.driven import on_grid, simulate_driven
from feeddrive.typing import BoolArray, FloatArray

TINY_ANGLE = 1e-9
"""Rms of the noise put on the motor angle [rad]; a thousandth of a 22-bit encoder's step."""

AMPLIFICATION = 30.0
"""Growth of that noise, in the band, beyond which a stretch is chaotic; a linear load side stays below about five."""

WINDOW = 0.5
"""Length of the stretches that are judged [s]."""


CONTACT = 0.1
"""Length of the stretches that are fitted or not [s]: a contact and what it sets ringing."""

LINEAR = 3.0
"""Growth that does not keep a stretch from being fitted; without free play it is about one."""

DRAWS = 2
"""Motions that differ; by one alone a contact may by chance not be moved."""


def predictable_samples(plant: Plant, evidence: AxisEvidence) -> BoolArray:
    """Samples that the plant can predict, shape (n,); all of them where there is no free play."""
    n = len(evidence.recording)
    if not _has_play(plant):
        return np.ones(n, dtype=bool)
    return _predictable(_growth(plant, evidence), evidence)


def samples_to_fit(plant: Plant, evidence: AxisEvidence) -> BoolArray:
    """Samples that the plant can predict and that tell of the plant, shape (n,).

    At a contact the encoder's own noise is magnified. Where it moves the table by more than the noise of the scale,
    what is missed is the encoder's, and effects would be named for it.
    """
    n = len(evidence.recording)
    if not _has_play(plant):
        return np.ones(n, dtype=bool)
    growth = _growth(plant, evidence)
    lost = _over_stretches(growth, evidence, CONTACT) > _limit(plant, evidence)
    # a contact at the edge of a stretch rings on into the next, and the filter carries it into the one before
    after, before = np.roll(lost, 1), np.roll(lost, -1)
    after[0] = before[-1] = False
    return _predictable(growth, evidence) & ~_at_samples(lost | after | before, evidence, CONTACT)


def _has_play(plant: Plant) -> bool:
    return any(isinstance(effect, TransmissionEffect) and effect.has_play for effect in plant.effects)


def _predictable(growth: FloatArray, evidence: AxisEvidence) -> BoolArray:
    chaotic = _over_stretches(growth, evidence, WINDOW) > AMPLIFICATION
    # what was shaken loose needs a moment to settle
    chaotic[1:] |= chaotic[:-1].copy()
    return ~_at_samples(chaotic, evidence, WINDOW)


def _growth(plant: Plant, evidence: AxisEvidence) -> FloatArray:
    """Motion of the table in the band over that of the encoder's noise that caused it, shape (n,)."""
    generator = np.random.default_rng(20240501)
    plant = evidence.placed(plant)
    motion = evidence.motion
    base = simulate_driven(plant, motion).table_position.copy()  # not with all else that was simulated
    squares = np.zeros(len(base))
    for _ in range(DRAWS):
        noise = on_grid(TINY_ANGLE * generator.standard_normal(len(base)), motion.substeps)
        other = simulate_driven(plant, replace(motion, angle=motion.angle + noise)).table_position
        squares += (evidence.band.filter(other - base) / (TINY_ANGLE * plant.chain.motor_radius)) ** 2 / DRAWS
    return np.sqrt(squares)


def _limit(plant: Plant, evidence: AxisEvidence) -> float:
    """Growth at which the encoder's noise moves the table as much as its scale's noise does."""
    angle = evidence.recording["motor_angle"]
    encoder = math.hypot(white_noise(angle, evidence.band.sample_rate), quantisation_step(angle) / math.sqrt(12))
    scale = evidence.noise.get("table_position")
    if scale is None or encoder == 0:
        return AMPLIFICATION
    return min(max(scale / (encoder * plant.chain.motor_radius), LINEAR), AMPLIFICATION)


def _over_stretches(growth: FloatArray, evidence: AxisEvidence, seconds: float) -> FloatArray:
    """Rms of every stretch."""
    length = max(1, int(seconds / evidence.recording.sample_time))
    padded = np.zeros(-(-len(growth) // length) * length)
    padded[: len(growth)] = growth**2
    rms: FloatArray = np.sqrt(padded.reshape(-1, length).mean(axis=1))
    return rms


def _at_samples(stretches: BoolArray, evidence: AxisEvidence, seconds: float) -> BoolArray:
    """What holds for the stretches, at every sample."""
    length = max(1, int(seconds / evidence.recording.sample_time))
    return np.repeat(stretches, length)[: len(evidence.recording)]
