"""What a heat network predicts for a recording: temperatures and growth from speed and surroundings alone."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import ClassVar

import numpy as np

from feeddrive.diagnosis.finding.remembered import Remembered, effects_key
from feeddrive.diagnosis.finding.scene import Candidate
from feeddrive.diagnosis.heat.heat_candidates import HEAT_CANDIDATES
from feeddrive.diagnosis.heat.heat_evidence import HeatEvidence
from feeddrive.diagnosis.likelihood.predictor import Predictor
from feeddrive.plant.plant import Plant
from feeddrive.thermal.machine_heat import Heat
from feeddrive.thermal.reduced.parametric_model import HeatModel, Path
from feeddrive.thermal.reduced.reduction import reduce_model
from feeddrive.thermal.run.heat_sensitivity import simulate_with_slopes
from feeddrive.thermal.run.warm_up import channel_of, simulate
from feeddrive.typing import FloatArray

ORDER = 48
"""States of the reduced model, for a range wide enough for every effect."""

WIDEST_FILM, WIDEST_CONTACT, MOST_COOLING = 5.0, 10.0, 5.0
"""Factors beyond the declared conductances, and coolant's conductance [W/K], for which the reduced model is made."""


@dataclass
class HeatPredictor(Predictor[HeatEvidence]):
    """Predicts recordings with one reduced model; bodies that effects attach are added to it.

    Not a frozen record: it remembers.

    Attributes:
        declared: network that the model was made for.
        model: its reduced model.
    """

    chance: ClassVar[float] = 18.0  # as that of motion, of some hundred starts

    declared: Heat
    model: HeatModel
    _known: Remembered[dict[str, FloatArray]] = field(default_factory=lambda: Remembered(_size))

    @property
    def candidates(self) -> tuple[Candidate, ...]:
        """Effects on temperatures and growth."""
        return HEAT_CANDIDATES

    def predict(self, plant: Plant, evidence: HeatEvidence) -> dict[str, FloatArray]:
        """Channel to its prediction, (n,) [degC, m]."""
        key = effects_key(plant.heat.effects)
        return self._known.found(evidence.recording, key, lambda: self._simulated(plant, evidence))

    def slopes(self, plant: Plant, evidence: HeatEvidence, numbers: Sequence[str]) -> dict[str, FloatArray] | None:
        """Exact slopes, carried along with the run."""
        step = evidence.recording.sample_time
        run = simulate_with_slopes(plant.heat, self._model(plant), step, evidence.speed, evidence.ambient, numbers)
        none = np.zeros((evidence.start_rows, len(numbers)))
        return {name: np.vstack([none, run[name][1]]) for name in evidence.channels}

    def variables(self, plant: Plant, evidence: HeatEvidence) -> dict[str, FloatArray]:
        """Speed, surroundings, time, and the predicted rise of the nut."""
        n = len(evidence.recording)
        run = self._all_channels(plant, evidence)
        nut = {sensor.output: sensor.channel for sensor in plant.heat.sensors}.get("nut", channel_of("nut"))
        return {
            "screw_speed": _from_start(evidence.speed, 0.0, n),
            "time": np.arange(n, dtype=np.float64) * evidence.recording.sample_time,
            "ambient_temperature": _from_start(evidence.ambient, float(evidence.ambient[0]), n),
            "nut_rise": _from_start(run[nut] - float(evidence.ambient[0]), 0.0, n),
        }

    def reference(self, name: str, plant: Plant, evidence: HeatEvidence) -> FloatArray:
        """The measured channel itself, a temperature in degC."""
        measured: FloatArray = evidence.measured[name][evidence.judged_rows]
        return measured

    def _all_channels(self, plant: Plant, evidence: HeatEvidence) -> dict[str, FloatArray]:
        step = evidence.recording.sample_time
        return simulate(plant.heat, self._model(plant), step, evidence.speed, evidence.ambient)

    def _model(self, plant: Plant) -> HeatModel:
        return with_bodies_of(plant.heat, self.declared, self.model)

    def _simulated(self, plant: Plant, evidence: HeatEvidence) -> dict[str, FloatArray]:
        """The compared channels of `_all_channels`, (n,) each."""
        run, n = self._all_channels(plant, evidence), len(evidence.recording)
        first = float(evidence.ambient[0])
        return {
            name: _from_start(run[name], 0.0 if name.startswith("table_growth") else first, n)
            for name in evidence.channels
        }


def heat_predictor(plant: Plant) -> HeatPredictor:
    """The predictor of a plant's heat."""
    return HeatPredictor(plant.heat, wide_model(plant.heat))


def wide_model(heat: Heat) -> HeatModel:
    """The model of a network, reduced once and wide enough for every effect."""
    limits = dict(heat.limits(WIDEST_FILM))
    limits[Path.CONTACT] = (heat.contact / WIDEST_CONTACT, heat.contact * WIDEST_CONTACT)
    limits[Path.COOLING] = (0.0, MOST_COOLING)
    reduced = reduce_model([heat.full_model()], limits, ORDER)[0]
    # a fit may pass through values outside; what it ends at is inside the physical range of its effect
    return replace(reduced, limits={})


def with_bodies_of(heat: Heat, declared: Heat, model: HeatModel) -> HeatModel:
    """A reduced model of the declared network with the bodies that further effects attach."""
    own = {body.name for body in declared.attached}
    for body in heat.attached:
        if body.name not in own:
            model = model.with_body(body)
    return model


def _size(prediction: dict[str, FloatArray]) -> int:
    """Bytes of a prediction."""
    return sum(series.nbytes for series in prediction.values())


def _from_start(values: FloatArray, start: float, count: int) -> FloatArray:
    """Values with the start in front where the recording has a row for it, (count,)."""
    whole: FloatArray = np.concatenate([np.full(count - len(values), start), values])
    return whole
