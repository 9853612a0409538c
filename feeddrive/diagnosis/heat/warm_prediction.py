"""What a machine of motion and heat predicts for a log of hours, and which effects on either are tried."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np

from feeddrive.diagnosis.finding.candidates import CANDIDATES
from feeddrive.diagnosis.finding.remembered import Remembered, effects_key
from feeddrive.diagnosis.finding.scene import Candidate
from feeddrive.diagnosis.heat.heat_candidates import HEAT_CANDIDATES
from feeddrive.diagnosis.heat.heat_prediction import wide_model, with_bodies_of
from feeddrive.diagnosis.heat.warm_evidence import WarmEvidence
from feeddrive.diagnosis.likelihood.predictor import Predictor
from feeddrive.engine.program import StepReport
from feeddrive.plant.plant import Plant
from feeddrive.simulate.driven import LoadMotion
from feeddrive.simulate.warm.warm_log import WarmRun, friction_powers, simulate_log
from feeddrive.thermal.machine_heat import Heat
from feeddrive.thermal.reduced.parametric_model import HeatModel
from feeddrive.typing import FloatArray

IN_UNIFORM_MOTION = (
    "friction_deviation", "constant_force", "position_spring", "coulomb_asymmetry", "viscous_asymmetry",
    "stribeck", "friction_vs_position", "lead_error_cumulative", "stiffness_deviation", "backlash",
)  # fmt: skip
"""Effects on motion that show at rows of uniform motion. Masses and delays show while accelerating, ripples need a row
many times a turn, and a warming that knows no temperature (`thermal_growth`, `viscous_warmup`) stands in for the heat
that is declared here."""


@dataclass
class WarmPredictor(Predictor[WarmEvidence]):
    """Predicts logs with one reduced heat model and the plant's equations in uniform motion.

    Not a frozen record: it remembers.

    Attributes:
        declared: whose heat the model was made for.
        model: reduced.
    """

    chance: ClassVar[float] = 18.0

    declared: Heat
    model: HeatModel
    _known: Remembered[WarmRun] = field(default_factory=lambda: Remembered(lambda run: run.size))
    _powers: Remembered[dict[str, FloatArray]] = field(default_factory=lambda: Remembered(_size_of_powers))

    @property
    def candidates(self) -> tuple[Candidate, ...]:
        """Effects on heat, and those on motion that uniform motion shows."""
        return (*HEAT_CANDIDATES, *(one for one in CANDIDATES if one.name in IN_UNIFORM_MOTION))

    def run(self, plant: Plant, evidence: WarmEvidence) -> WarmRun:
        """What the plant does in the log."""
        log = evidence.log
        powers = self._powers.found(log, effects_key(plant.motion_effects), lambda: friction_powers(plant, log))
        return self._known.found(
            log, effects_key(plant.effects), lambda: simulate_log(plant, self._model(plant), log, powers)
        )

    def predict(self, plant: Plant, evidence: WarmEvidence) -> dict[str, FloatArray]:
        """Channel to its prediction, (n,) [N m, m, degC]."""
        channels = self.run(plant, evidence).channels
        return {name: channels[name] for name in evidence.channels}

    def variables(self, plant: Plant, evidence: WarmEvidence) -> dict[str, FloatArray]:
        """Speed, position, time, and the predicted rise of the nut."""
        radius = plant.chain.motor_radius
        return {
            "motor_speed": evidence.log.speed,
            "nut_position": plant.coupling.nut_at_zero + radius * evidence.log.angle,
            "time": evidence.log.time,
            "nut_rise": self.run(plant, evidence).rises[:, 0],
        }

    def reference(self, name: str, plant: Plant, evidence: WarmEvidence) -> FloatArray:
        """The channel itself; of the table its motion beyond lead / 2 pi times the motor's."""
        rows = evidence.judged_rows
        if name != "table_position":
            return np.asarray(evidence.measured[name][rows])
        beyond = evidence.measured[name] - plant.chain.motor_radius * evidence.log.angle
        return np.asarray(beyond[rows] - np.mean(beyond[rows]))

    def _model(self, plant: Plant) -> HeatModel:
        return with_bodies_of(plant.heat, self.declared, self.model)

    def load_motion(self, plant: Plant, evidence: WarmEvidence) -> LoadMotion:
        """The motion as starts of candidates read it, (n,); its forces at uniform rows alone."""
        log, found = evidence.log, self.run(plant, evidence).motion
        radius = plant.chain.motor_radius
        torque = np.zeros(len(log.time))
        torque[log.uniform] = found.torque
        return LoadMotion(
            time=log.time, motor_angle=log.angle, motor_speed=log.speed, screw_angle=log.angle, screw_speed=log.speed,
            table_position=radius * log.angle, table_velocity=radius * log.speed, torque=torque,
            force=np.zeros(len(log.time)), report=StepReport(0, 0, 0, 0, 0, 0.0, 0, 0.0, 0.0),
        )  # fmt: skip


def _size_of_powers(powers: dict[str, FloatArray]) -> int:
    return sum(table.nbytes for table in powers.values())


def warm_predictor(plant: Plant) -> WarmPredictor:
    """The predictor of a machine of motion and heat."""
    return WarmPredictor(plant.heat, wide_model(plant.heat))
