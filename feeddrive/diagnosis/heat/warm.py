"""A log of hours made ready for comparison: torque and table position where the motor turned uniformly, temperatures.

Motion is compared as it is, at its instants; temperatures as means over a step of the heat network, since a skin warms
with each stroke. All channels count at the same rows, those of uniform motion: they are many, so that temperatures lose
nothing.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import ClassVar

import numpy as np

from feeddrive.diagnosis.finding.candidates import CANDIDATES
from feeddrive.diagnosis.finding.remembered import Remembered, plant_key
from feeddrive.diagnosis.finding.scene import Candidate
from feeddrive.diagnosis.heat.heat_candidates import HEAT_CANDIDATES
from feeddrive.diagnosis.heat.heat_evidence import (
    HEAT_BLOCK,
    MODEL_ERROR,
    HeatEvidence,
    fitted_rows,
    model_error_of,
    smooth_noise,
)
from feeddrive.diagnosis.heat.heat_prediction import wide_model, with_bodies_of
from feeddrive.diagnosis.likelihood.predictor import Predictor
from feeddrive.engine.program import StepReport
from feeddrive.errors import InputError
from feeddrive.plant.plant import Plant
from feeddrive.recording import Recording
from feeddrive.simulate.driven import LoadMotion
from feeddrive.simulate.warm.warm_log import (
    HEAT_STEP,
    WarmLog,
    WarmRun,
    friction_powers,
    simulate_log,
    steady_mean,
    thermometers,
    warm_log,
)
from feeddrive.thermal.machine_heat import Heat
from feeddrive.thermal.reduced.parametric_model import HeatModel
from feeddrive.typing import BoolArray, FloatArray

MOTION = ("motor_torque", "table_position")

TORQUE_ERROR = 2e-3
"""Share of a torque that friction's law may miss while temperatures change: half of what a kelvin makes of an oil is
1 %, and a surface stands for the oil to a few tenths of a kelvin."""


MOST_ROWS = 1200
"""Rows that are compared: what temperatures do in minutes they hold several times over, and each takes its time."""

STILL = 300.0
"""Seconds in which a machine warms along a straight line: its time constants are longer than half an hour."""


IN_UNIFORM_MOTION = (
    "friction_deviation", "constant_force", "position_spring", "coulomb_asymmetry", "viscous_asymmetry",
    "stribeck", "friction_vs_position", "lead_error_cumulative", "stiffness_deviation", "backlash",
)  # fmt: skip
"""Effects on motion that show at rows of uniform motion. Masses and delays show while accelerating, ripples need a row
many times a turn, and a warming that knows no temperature (`thermal_growth`, `viscous_warmup`) stands in for the heat
that is declared here."""


@dataclass(frozen=True, eq=False)
class WarmEvidence(HeatEvidence):
    """A log of motion and temperatures.

    Attributes:
        log: what it tells of the motion.
    """

    log: WarmLog

    @property
    def motion_speed(self) -> FloatArray:
        """Speed of the motor's strokes [rad/s], (n,)."""
        return self.log.speed

    def without_open(self, name: str, part: FloatArray, rows: BoolArray) -> FloatArray:
        """One channel over its noise, (k,), without the zero of a scale or the gain of a thermometer."""
        if name in MOTION:
            part = part / self.noise[name]
            return part - np.mean(part) if name in self.floating else part
        return super().without_open(name, part, rows)

    def missed(self, name: str) -> float:
        """Rms of what model and sensor may miss of a channel."""
        return self.model_error[name] if name in MOTION else super().missed(name)


def is_warm_log(recording: Recording, heat: Heat) -> bool:
    """Whether a recording holds a motion and temperatures of one machine."""
    seen = any(channel in recording for channel in thermometers(heat))
    return "motor_angle" in recording and seen and any(name in recording for name in MOTION)


def prepare_warm(recording: Recording, plant: Plant, share: float) -> WarmEvidence:
    """Evidence of a log, its first `share` fitted and the rest judged.

    Args:
        recording: with a motor angle, a torque or table position, and temperatures that the plant's sensors read.
        plant: the machine.
        share: 1 to fit on all of it, 0 to judge on all of it.

    Raises:
        InputError: channels that are needed are missing, or no stroke tells its speed.
    """
    known = thermometers(plant.heat)
    names = [*(name for name in MOTION if name in recording), *(name for name in known if name in recording)]
    if not is_warm_log(recording, plant.heat):
        mend = "record the motor angle, its torque or the table position, and a temperature that the plant has"
        raise InputError("no log of motion and temperatures", recording.name, mend)
    log = warm_log(recording, plant.heat.ambient)
    kept = replace(log, uniform=_some(log.uniform))
    with_air = recording
    if "ambient_temperature" not in recording:
        with_air = replace(recording, channels={**recording.channels, "ambient_temperature": log.ambient})
    noise, missed = {}, {}
    for name in names:
        series = np.asarray(recording[name])
        if name in MOTION:
            beside = series - (plant.chain.motor_radius * log.angle if name == "table_position" else 0.0)
            noise[name] = _repeated(beside, log)
            scale = float(np.sqrt(np.mean(series[log.uniform] ** 2)))
            missed[name] = MODEL_ERROR["m"] if name == "table_position" else TORQUE_ERROR * scale
        else:
            # means of rows that overlap: as many independent values as means fit into the log
            inside = HEAT_STEP * kept.uniform.sum() / log.time[-1]
            noise[name] = (known[name][1] or smooth_noise(series)) * np.sqrt(max(inside, 1.0) * log.step / HEAT_STEP)
            missed[name] = model_error_of(name, with_air)
    time = log.time + log.step
    return WarmEvidence(
        recording=with_air,
        measured={
            name: np.asarray(recording[name] if name in MOTION else steady_mean(recording[name], log.step))
            for name in names
        },
        noise={name: float(np.hypot(noise[name], missed[name])) for name in names},
        counted=kept.uniform,
        fitted=fitted_rows(time, share),
        edge=0.5 / log.step,
        block=HEAT_BLOCK,
        thinning=1,
        floating=tuple(name for name in names if name == "table_position"),
        model_error=missed,
        speed=np.abs(log.speed) * (log.share > 0),
        ambient=log.ambient,
        start_rows=0,
        log=kept,
    )


def _some(rows: BoolArray) -> BoolArray:
    """At most `MOST_ROWS` of some rows, evenly taken, (n,)."""
    chosen = np.zeros(len(rows), dtype=bool)
    places = np.flatnonzero(rows)
    chosen[places[:: len(places) // MOST_ROWS + 1]] = True
    return chosen


def _repeated(series: FloatArray, log: WarmLog) -> float:
    """Rms of the noise of a channel: what a smooth change with place and time leaves of like strokes.

    Of each signed speed, within `STILL` seconds, a parabola over the angle and a line over time are taken out; what is
    left counts by its degrees of freedom, and the median of all such stretches is taken.
    """
    found = []
    number = (log.time // STILL).astype(np.int64)
    for block in np.unique(number[log.uniform]):
        for speed in np.unique(log.speed[log.uniform & (number == block)]):
            rows = log.uniform & (number == block) & (log.speed == speed)
            if rows.sum() < 10:
                continue
            x, t = log.angle[rows], log.time[rows]
            columns = np.column_stack([np.ones(len(x)), x - x.mean(), (x - x.mean()) ** 2, t - t.mean()])
            left = series[rows] - columns @ np.linalg.lstsq(columns, series[rows], rcond=None)[0]
            found.append(float(left @ left) / (len(x) - 4))
    if not found:
        raise InputError("too few strokes alike to tell the noise of a channel", "the log", "log some minutes of them")
    return float(np.sqrt(np.median(found)))


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
    def answers_chain(self) -> bool:
        """Torque and table position do."""
        return True

    @property
    def candidates(self) -> tuple[Candidate, ...]:
        """Effects on heat, and those on motion that uniform motion shows."""
        return (*HEAT_CANDIDATES, *(one for one in CANDIDATES if one.name in IN_UNIFORM_MOTION))

    def run(self, plant: Plant, evidence: WarmEvidence) -> WarmRun:
        """What the plant does in the log."""
        log = evidence.log
        powers = self._powers.found(log, plant_key(plant, plant.motion_effects), lambda: friction_powers(plant, log))
        return self._known.found(
            log, plant_key(plant, plant.effects), lambda: simulate_log(plant, self._model(plant), log, powers)
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
