"""Which samples of a recording can be predicted at all, and how much a fit can learn from each.

With free play the load side can be chaotic: under a torque chirp, an angle error far below the encoder's step moves the
table by micrometres. The rule looks at that directly: the same plant is driven by the measured motion and by motions
that differ from it as the true one may, by the encoder's own error, and stretches where the table then goes elsewhere
are left out.

The size of that error matters. A table that flies from flank to flank is never further off than the play is wide, and
once it has settled on a flank all that went before is forgotten: a tiny error that grows ten-million-fold on the way
says no more than one of the encoder's size that grows a hundredfold, and scaled up it would outlast the flight by
strokes. So the error is simulated as large as it is.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.ndimage import label, maximum_filter1d, uniform_filter1d

from feeddrive.diagnosis.motion.axis_evidence import AxisEvidence
from feeddrive.diagnosis.motion.band import white_noise
from feeddrive.effects.base import Effect, TransmissionEffect
from feeddrive.plant.plant import Plant
from feeddrive.recording.checks.flaws import quantisation_step
from feeddrive.simulate.driven import MotorMotion, simulate_driven
from feeddrive.simulate.row_steps import on_grid
from feeddrive.typing import BoolArray, FloatArray

TINY_ANGLE = 1e-9
"""Least error of a motor angle [rad], a thousandth of a 22-bit step: no motion between rows is known better."""

AMPLIFICATION = 30.0
"""Growth of the encoder's error, in the band, beyond which it is chaotic; a linear load side stays below about five."""

CONTACT = 0.1
"""Time [s] for which what came after a contact is not believed: of a few motions some come together by chance."""

REACH = 1.0
"""Periods of the band's edge on either side over which an error is averaged: the filter carries it no further."""

LINEAR = 3.0
"""Growth that is no sign of free play; without it, it is about one."""

DRAWS = 8
"""Motions that differ. By one alone a contact may by chance not be moved; two came together for hundredths of a second
in the middle of chaos: nearly all of the error that was told was of those, and a tight place was fitted."""


@dataclass(frozen=True)
class Missed:
    """What the encoder's error makes of a plant's table.

    Attributes:
        table: rms about each sample and over the draws, in the band [m], shape (n,).
        cause: rms of the encoder's error, as a way of the table [m].
    """

    table: FloatArray
    cause: float


def predictable_samples(plant: Plant, evidence: AxisEvidence) -> BoolArray:
    """Samples that the plant can predict, shape (n,); all of them where there is no free play."""
    if not has_play(plant.effects):
        return np.ones(len(evidence.recording), dtype=bool)
    return ~_lost(_missed(plant, evidence), evidence)


def weights_to_fit(plant: Plant, evidence: AxisEvidence) -> BoolArray | FloatArray:
    """Weights of the samples of the table position, shape (n,): 0 where it cannot be predicted.

    At a contact the encoder's own error is magnified. What it then moves the table by is expected beside the noise of
    the scale: weighed as that alone, effects would be named for it. It is held against that noise, and not against what
    an effect that is missing still leaves: weights would stay even once it is found.
    """
    if not has_play(plant.effects):
        return np.ones(len(evidence.recording), dtype=bool)
    missed = _missed(plant, evidence)
    lost = _lost(missed, evidence)
    if "table_position" not in evidence.noise or (not lost.any() and np.max(missed.table) <= LINEAR * missed.cause):
        return ~lost
    noise = evidence.known_to("table_position")
    beyond = np.maximum(missed.table**2 - (LINEAR * missed.cause) ** 2, 0.0)
    weights: FloatArray = np.where(lost, 0.0, noise / np.sqrt(noise**2 + beyond))
    return weights


def has_play(effects: Sequence[Effect]) -> bool:
    """Whether one of the effects is a free play."""
    return any(isinstance(effect, TransmissionEffect) and effect.has_play for effect in effects)


def _missed(plant: Plant, evidence: AxisEvidence) -> Missed:
    plant = evidence.placed(plant)
    radius, error = plant.chain.motor_radius, _encoder_error(evidence)
    base, squares = _behind(plant, evidence.motion, evidence), np.zeros(len(evidence.recording))
    count = len(evidence.drawn[:DRAWS]) or DRAWS
    for other in _other_motions(evidence, error):
        squares += evidence.band.filter(_behind(plant, other, evidence) - base) ** 2 / count
    about = 2 * round(REACH / (evidence.band.edge * evidence.recording.sample_time)) + 1
    table = np.sqrt(np.maximum(uniform_filter1d(squares, about), 0.0))  # a running sum may end below zero
    return Missed(table, error * radius)


def _behind(plant: Plant, motion: MotorMotion, evidence: AxisEvidence) -> FloatArray:
    """Way [m] of the table beyond that of the motor, (n,): a slow error of the motor is followed, and not magnified."""
    run = simulate_driven(plant, motion, rests=evidence.rests)
    behind: FloatArray = run.table_position - plant.chain.motor_radius * motion.angle[motion.samples]
    return behind


def _encoder_error(evidence: AxisEvidence) -> float:
    """Rms of what noise and steps of the encoder add to a row [rad]."""
    measured = evidence.recording["motor_angle"]
    steps = quantisation_step(measured) / math.sqrt(12)
    return max(math.hypot(white_noise(measured, evidence.band.sample_rate), steps), TINY_ANGLE)


def _other_motions(evidence: AxisEvidence, error: float) -> Iterator[MotorMotion]:
    """Motions that the motor may have made as well: with the encoder's error [rad] once more, as many as there are."""
    if evidence.drawn:
        yield from evidence.drawn[:DRAWS]
        return
    generator, motion = np.random.default_rng(20240501), evidence.motion
    for _ in range(DRAWS):
        drawn = error * generator.standard_normal(len(evidence.recording))
        yield replace(motion, angle=motion.angle + on_grid(drawn, motion.substeps))


def _lost(missed: Missed, evidence: AxisEvidence) -> BoolArray:
    """Samples of chaos, and those after them, shape (n,).

    Where the recording tells rests, a bounce that magnifies the error at all is lost from the rest before it to the one
    behind it: a motor that is given takes no power from it, and what it does between rows at a contact is not known.
    """
    contact = max(1, round(CONTACT / evidence.recording.sample_time))
    chaotic = missed.table > AMPLIFICATION * missed.cause
    lost: BoolArray = maximum_filter1d(chaotic, contact, origin=(contact - 1) // 2)
    if evidence.bouncing is None:
        return lost
    bounces, _ = label(evidence.bouncing)
    return lost | (evidence.bouncing & np.isin(bounces, bounces[missed.table > LINEAR * missed.cause]))
