"""What a plant predicts for a recording, in the band: motor torque and table position from the motor motion alone."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np

from feeddrive.diagnosis.finding.candidates import CANDIDATES
from feeddrive.diagnosis.finding.remembered import Remembered, effects_key, plant_key
from feeddrive.diagnosis.finding.scene import Candidate
from feeddrive.diagnosis.likelihood.coordinates import is_absent
from feeddrive.diagnosis.likelihood.predictor import Predictor
from feeddrive.diagnosis.motion.axis_evidence import AxisEvidence
from feeddrive.diagnosis.motion.predictability import predictable_samples, weights_to_fit
from feeddrive.diagnosis.suspicion.channel_timing import lag_of, lagging, repeated
from feeddrive.diagnosis.suspicion.torque_channel import scale_of, scale_sentence
from feeddrive.effects.base import ChainEffect, DriveEffect, Effect, Kind, Motion, Port, SourceEffect
from feeddrive.engine.step.linear_part import SimulationError
from feeddrive.plant.motor_torque import acting_torques, asked_torques, declared_gain, droops
from feeddrive.plant.plant import Plant
from feeddrive.simulate.driven import LoadMotion, MotorMotion, simulate_steps, unfollowed
from feeddrive.simulate.row_steps import at_rate
from feeddrive.typing import BoolArray, FloatArray

MOTOR_ROOM = 32_000_000
"""Bytes of motor torques kept: those of thirty effects over a minute at 2 kHz, while the values of others are moved."""

INERTIA = "motor_inertia"
"""Value of an elastic chain that the load side does not notice where the motion of the motor is given."""


@dataclass
class AxisPredictor(Predictor[AxisEvidence]):
    """Predicts recordings, and remembers what the load side did.

    Not a frozen record: it is a cache.

    Attributes:
        scaled: fitted recordings whose torque is known but for its scale, which every plant sets for itself.
        declared_scale: that their torque was brought to [N m per unit of the channel].
    """

    scaled: tuple[AxisEvidence, ...] = ()
    declared_scale: float = 1.0
    _scales: dict[object, float] = field(default_factory=dict)
    _runs: Remembered[LoadMotion] = field(default_factory=lambda: Remembered(lambda run: run.size))
    _asked: Remembered[FloatArray] = field(default_factory=lambda: Remembered(lambda torque: torque.nbytes, MOTOR_ROOM))

    def load_motion(self, plant: Plant, evidence: AxisEvidence) -> LoadMotion:
        """Motion of the load side, without what acts at the motor alone but its inertia."""
        run = self._steps(plant, evidence).at(evidence.motion, plant.chain.motor_radius)
        return replace(run, torque=run.torque + self._turning(plant, evidence.motion))

    def _steps(self, plant: Plant, evidence: AxisEvidence) -> LoadMotion:
        """Motion of the load side without the motor's inertia, at the steps of the simulation."""
        bare = evidence.placed(_load_side(plant))
        return self._runs.found(evidence.motion, plant_key(bare, bare.effects), lambda: _simulated(bare, evidence))

    def _turning(self, plant: Plant, motion: MotorMotion) -> FloatArray | float:
        """Torque that the motor of an elastic chain takes to turn itself [N m], shape (n,)."""
        inertia = plant.chain_values()[INERTIA] if plant.chain.elastic else 0.0
        if not inertia:
            return 0.0
        return inertia * self._asked.found(motion, INERTIA, lambda: at_rate(motion.acceleration, motion.substeps))

    def predict(self, plant: Plant, evidence: AxisEvidence) -> dict[str, FloatArray]:
        """Channel to predicted series in the band, shape (n,), SI."""
        run, motion = self._steps(plant, evidence), evidence.motion
        at_motor = self._turning(plant, motion) + self._motor_sources(plant, motion)
        torque = self._asked_of(plant, evidence, run.torque_at(motion) + at_motor)
        step = evidence.recording.sample_time
        if evidence.torque_rows is not None:
            if "motor_torque" in evidence.gains:  # what the encoder's steps make beyond the band would fold into it
                torque = evidence.band.filter(torque)
            # the drive's own row begins half a row before what it acts about
            torque = repeated(lagging(torque, -0.5 * step, step), evidence.torque_rows)
        raw = {"motor_torque": torque, "table_position": run.table_at(motion, plant.chain.motor_radius)}
        series = {name: evidence.band.filter(raw[name]) for name in evidence.channels}
        if evidence.scaled_from:
            series["motor_torque"] *= self.scale(plant)
        return {name: lagging(one, lag_of(plant, name), step) for name, one in series.items()}

    def _asked_of(self, plant: Plant, evidence: AxisEvidence, acting: FloatArray) -> FloatArray:
        """Torque that is asked for, so that a torque [N m], (n,), acts.

        Beyond the band the second difference of an encoder's steps is many times what the motor does, and a torque per
        ampere that falls would turn it into torque in the band, as a rectifier does. What falls is therefore told of
        the predicted torque in the band and of the recorded one beyond it.
        """
        if evidence.acting is None or evidence.torque_rows is not None or not droops(plant):
            return asked_torques(plant, acting)
        drives = effects_key([effect for effect in plant.effects if isinstance(effect, DriveEffect)])
        recorded = self._asked.found(evidence.motion, drives, partial(acting_torques, plant, evidence.acting))
        known = recorded + evidence.band.filter(acting - recorded)
        return asked_torques(plant, known) + declared_gain(plant) * (acting - known)

    def _motor_sources(self, plant: Plant, motion: MotorMotion) -> FloatArray:
        """Torque that the sources at the motor ask for [N m], shape (n,)."""
        at = motion.samples
        total = np.zeros(len(motion.time[at]))
        for effect in plant.effects:
            if isinstance(effect, SourceEffect) and effect.port == Port.MOTOR:
                total += self._asked.found(motion, effects_key([effect]), partial(_asked_for, effect, motion))
        return total

    def scale(self, plant: Plant) -> float:
        """Factor on the predicted torque that fits the recordings in `scaled` best."""
        key = plant_key(plant, plant.effects)
        if key not in self._scales:
            self._scales[key] = self._fitted_scale(plant)
        return self._scales[key]

    def _fitted_scale(self, plant: Plant) -> float:
        measured, predicted = [], []
        for evidence in self.scaled:
            rows = evidence.thinned(evidence.fit_rows)
            unscaled = self.predict(plant, replace(evidence, scaled_from=""))
            predicted.append(unscaled["motor_torque"][rows])
            measured.append(evidence.measured["motor_torque"][rows])
        return scale_of(np.concatenate(measured), np.concatenate(predicted))

    def remarks(self, before: Plant, after: Plant) -> tuple[str, ...]:
        """The scale of the torque, where it is fitted."""
        scales = [self.declared_scale / self.scale(plant) for plant in (before, after)] if self.scaled else []
        return tuple(scale_sentence(self.scaled[0].scaled_from, *scales) for _ in scales[:1])

    @property
    def of_motion(self) -> bool:
        """It does."""
        return True

    @property
    def candidates(self) -> tuple[Candidate, ...]:
        """Effects on motion and torque."""
        return CANDIDATES

    def smooth(self, plant: Plant) -> bool:
        """A chain that varies with the table's position is simulated from cell to cell."""
        return not plant.chain.varies

    def predictable(self, plant: Plant, evidence: AxisEvidence) -> BoolArray:
        """Samples without chaos."""
        return predictable_samples(plant, evidence)

    def to_fit(self, plant: Plant, evidence: AxisEvidence) -> BoolArray | FloatArray:
        """Samples without chaos, weighed by what the encoder's error makes of contacts."""
        return weights_to_fit(plant, evidence)

    def variables(self, plant: Plant, evidence: AxisEvidence) -> dict[str, FloatArray]:
        """Motion that a residual may depend on."""
        run = self.load_motion(plant, evidence)
        return {
            "table_velocity": run.table_velocity,
            "table_position": run.table_position,
            "motor_angle": run.motor_angle,
        }

    def reference(self, name: str, plant: Plant, evidence: AxisEvidence) -> FloatArray:
        """The torque; of the table its motion beyond lead / 2 pi times the motor's."""
        rows = evidence.judged_rows
        if name != "table_position":
            torque: FloatArray = evidence.measured[name][rows]
            return torque
        geared = plant.chain.motor_radius * evidence.band.filter(evidence.recording["motor_angle"])
        beyond = (evidence.measured[name] - geared)[rows]
        about_mean: FloatArray = beyond - beyond.mean()
        return about_mean


def _asked_for(effect: SourceEffect, motion: MotorMotion) -> FloatArray:
    at = motion.samples
    seen = Motion(motion.angle[at], motion.speed[at], motion.time[at])
    return np.asarray(effect.force(seen, effect.values), dtype=float).ravel()


def _simulated(plant: Plant, evidence: AxisEvidence) -> LoadMotion:
    """The driven simulation; no numbers where the plant cannot be followed with these values."""
    try:
        return simulate_steps(plant, evidence.motion, rests=evidence.rests)
    except SimulationError:
        return unfollowed(evidence.motion.steps)


def _load_side(plant: Plant) -> Plant:
    """The plant as the load side sees it: chain effects in the chain's values, nothing that acts at the motor alone.

    What the motor takes to turn itself in an elastic chain is in proportion to its inertia: left out, every inertia has
    one motion of the load.

    What does nothing with the values that it has is left out as well: a candidate that begins with none of it is the
    machine without it.
    """
    kept = tuple(e for e in plant.motion_effects if not (_at_motor_alone(e) or _in_values(e) or is_absent(e, plant)))
    values = plant.chain_values()
    unseen = {INERTIA: 0.0} if plant.chain.elastic else {}
    chain = replace(plant.chain, values={key: values[key] for key in plant.chain.values} | unseen)
    return replace(plant, mechanics=chain, effects=kept)


def _in_values(effect: Effect) -> bool:
    """Whether the chain's values hold all that the effect does."""
    return isinstance(effect, ChainEffect) and not effect.adds_coordinate


def _at_motor_alone(effect: Effect) -> bool:
    """Whether the load side does not notice the effect when the motor motion is given."""
    if effect.kind == Kind.TIMING or isinstance(effect, DriveEffect):
        return True
    return isinstance(effect, SourceEffect) and effect.port == Port.MOTOR
