"""Parameters that are other in one recording than in the others, and the predictor that applies them.

A shift is a difference in the coordinates in which an effect is fitted, bound to one recording. It stands in the list
of effects, so that fits, intervals and cross-validation treat it like any other unknown; before anything is simulated
the predictor takes it out and moves the effect that it is about. Recordings without a shift keep the effect as it is.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from feeddrive.diagnosis.finding.scene import Candidate
from feeddrive.diagnosis.likelihood.coordinates import coordinates_of, read_coordinates, write_coordinates
from feeddrive.diagnosis.likelihood.evidence import Evidence
from feeddrive.diagnosis.likelihood.predictor import Predictor
from feeddrive.effects.base import Effect, Kind, Parameter, Port, Signature
from feeddrive.effects.heat.thermal_effect import ThermalEffect
from feeddrive.plant.plant import Plant
from feeddrive.recording import Recording
from feeddrive.simulate.driven import LoadMotion
from feeddrive.typing import BoolArray, FloatArray

SAME_ORDER = 0.02
"""Relative difference of two orders that are taken for one sine."""


@dataclass(frozen=True)
class Target:
    """The part of an effect that a shift moves.

    Attributes:
        name: of the effect.
        port: where it acts.
        place: the word that says where it acts, or an empty text.
        coordinate: number of the coordinate, in the order of `coordinates_of`.
        order: of a sine, by which it is distinguished from others of its name; None elsewhere.
    """

    name: str
    port: Port
    place: str
    coordinate: int
    order: float | None = None

    def meets(self, effect: Effect) -> bool:
        """Whether this effect is the one."""
        if (effect.name, effect.port, effect.place) != (self.name, self.port, self.place):
            return False
        order = effect.values.get("order")
        if self.order is None or not isinstance(order, float | int):
            return True
        return abs(order - self.order) <= SAME_ORDER * self.order


def target_of(effect: Effect, coordinate: int) -> Target:
    """The target for one coordinate of an effect."""
    order = effect.values.get("order")
    return Target(effect.name, effect.port, effect.place, coordinate, order if isinstance(order, float) else None)


@dataclass(frozen=True)
class RecordingShift(Effect):
    """What one recording has otherwise: coordinate = that of the effect + shift.

    Attributes:
        target: what is moved.
        recording: number of the recording that it belongs to.
    """

    name = "recording_shift"
    kind = Kind.SOURCE
    ports = (Port.TABLE,)
    parameters = (Parameter("shift", "1", table=True),)
    signature = Signature((), "recording")
    repeatable = True
    additive = True

    target: Target = Target("", Port.TABLE, "", 0)
    recording: int = -1


@dataclass(frozen=True)
class ThermalRecordingShift(RecordingShift, ThermalEffect):
    """A shift of an effect on heat."""

    ports = (Port.THERMAL,)


def is_shift(effect: Effect) -> bool:
    """Whether this is no effect of the machine but the difference of one recording."""
    return isinstance(effect, RecordingShift)


def without_shifts(effects: Sequence[Effect]) -> tuple[Effect, ...]:
    """The effects of the machine alone, as they are in the recordings that have no shift."""
    return tuple(effect for effect in effects if not is_shift(effect))


def in_recording(effects: Sequence[Effect], plant: Plant, number: int | None) -> tuple[Effect, ...]:
    """The effects as they are in one recording, the shifts taken out.

    Args:
        effects: with shifts.
        plant: that the coordinates belong to.
        number: of the recording; None for one without shifts.
    """
    result = list(without_shifts(effects))
    for shift in effects:
        if isinstance(shift, RecordingShift) and shift.recording == number:
            at = [i for i, effect in enumerate(result) if shift.target.meets(effect)]
            if at:  # what was found comes after what is declared
                result[at[-1]] = _moved(result[at[-1]], plant, shift)
    return tuple(result)


def _moved(effect: Effect, plant: Plant, shift: RecordingShift) -> Effect:
    coordinates = coordinates_of(effect, plant)
    by = shift.values["shift"]
    steps = by if isinstance(by, tuple) else (by,)
    start = sum(len(coordinate.read(effect)) for coordinate in coordinates[: shift.target.coordinate])
    vector = read_coordinates([effect], plant)
    vector[start : start + len(steps)] += steps
    return write_coordinates([effect], plant, vector)[0]


@dataclass
class RecordingPredictor(Predictor[Any]):
    """Predicts each recording with its own shifts.

    Attributes:
        inner: predicts one kind of recording.
        numbers: recording to its number; a recording that is not there has no shifts.
    """

    inner: Predictor[Any]
    numbers: Mapping[Recording, int]

    def machine(self, plant: Plant, evidence: Evidence) -> Plant:
        """The plant as it is in this recording, without shifts."""
        if not any(is_shift(effect) for effect in plant.effects):
            return plant
        number = self.numbers.get(evidence.recording)
        return replace(plant, effects=in_recording(plant.effects, plant, number))

    @property
    def of_motion(self) -> bool:
        """As the inner one."""
        return self.inner.of_motion

    @property
    def answers_chain(self) -> bool:
        """As the inner one."""
        return self.inner.answers_chain

    @property
    def candidates(self) -> tuple[Candidate, ...]:
        """Effects that are tried."""
        return self.inner.candidates

    def predict(self, plant: Plant, evidence: Any) -> dict[str, FloatArray]:
        """Channel to its prediction, (n,), SI."""
        return self.inner.predict(self.machine(plant, evidence), evidence)

    def load_motion(self, plant: Plant, evidence: Any) -> LoadMotion | None:
        """Motion of the load side."""
        return self.inner.load_motion(self.machine(plant, evidence), evidence)

    def variables(self, plant: Plant, evidence: Any) -> dict[str, FloatArray]:
        """Variables that a residual may depend on."""
        return self.inner.variables(self.machine(plant, evidence), evidence)

    def reference(self, name: str, plant: Plant, evidence: Any) -> FloatArray:
        """Series that a relative error refers to."""
        return self.inner.reference(name, plant, evidence)

    def remarks(self, before: Plant, after: Plant) -> tuple[str, ...]:
        """Remarks on the way to predict, recordings without shifts."""
        plain = [replace(plant, effects=without_shifts(plant.effects)) for plant in (before, after)]
        return self.inner.remarks(*plain)

    def predictable(self, plant: Plant, evidence: Any) -> BoolArray:
        """Samples that can be predicted."""
        return self.inner.predictable(self.machine(plant, evidence), evidence)

    def to_fit(self, plant: Plant, evidence: Any) -> BoolArray | FloatArray:
        """Samples that a fit can learn from, or their weights."""
        return self.inner.to_fit(self.machine(plant, evidence), evidence)


def shift_of(target: Target, recording: int, count: int) -> RecordingShift:
    """A shift of nothing yet, of as many coordinates as the target has."""
    on_heat = target.port is Port.THERMAL
    kind, port = (ThermalRecordingShift, Port.THERMAL) if on_heat else (RecordingShift, Port.TABLE)
    return kind(
        values={"shift": (0.0,) * count}, port=port, label=RecordingShift.name, target=target, recording=recording
    )
