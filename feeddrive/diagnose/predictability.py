"""Which samples of a recording can be predicted at all.

With free play the load side can be chaotic: under a torque chirp, an angle error far below the encoder's step moves the
table by micrometres. The rule looks at that directly: the same plant is driven by the measured motion and by one that
differs by a tiny noise, and stretches where the difference grows are left out.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from feeddrive.diagnose.evidence import AxisEvidence
from feeddrive.effects.base import TransmissionEffect
from feeddrive.plant.plant import Plant
from feeddrive.simulate.driven import simulate_driven
from feeddrive.typing import BoolArray

TINY_ANGLE = 1e-9
"""Rms of the noise put on the motor angle [rad]; a thousandth of a 22-bit encoder's step."""

AMPLIFICATION = 30.0
"""Growth of that noise, in the band, beyond which a stretch is chaotic; a linear load side stays below about five."""

WINDOW = 0.5
"""Length of the stretches that are judged [s]."""


def predictable_samples(plant: Plant, evidence: AxisEvidence) -> BoolArray:
    """Samples that the plant can predict, shape (n,); all of them where there is no free play."""
    n = len(evidence.recording)
    if not any(isinstance(effect, TransmissionEffect) and effect.has_play for effect in plant.effects):
        return np.ones(n, dtype=bool)
    generator = np.random.default_rng(20240501)
    moved = evidence.motion.angle + TINY_ANGLE * generator.standard_normal(len(evidence.motion.angle))
    base = simulate_driven(plant, evidence.motion).table_position
    other = simulate_driven(plant, replace(evidence.motion, angle=moved)).table_position
    growth = np.abs(evidence.band.filter(other - base)) / (TINY_ANGLE * plant.chain.motor_radius)
    length = max(1, int(WINDOW / evidence.recording.sample_time))
    blocks = -(-n // length)
    padded = np.zeros(blocks * length)
    padded[:n] = growth**2
    chaotic = np.sqrt(padded.reshape(blocks, length).mean(axis=1)) > AMPLIFICATION
    # what was shaken loose needs a moment to settle
    chaotic |= np.roll(chaotic, 1) & (np.arange(blocks) > 0)
    return ~np.repeat(chaotic, length)[:n]
