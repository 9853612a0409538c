"""What is left of a recording, beside the variables it may depend on.

No variable holds what is being explained: motion and load are those of the plant driven by the measured motor, not the
recorded torque nor the recorded table position.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from feeddrive.diagnosis.likelihood.evidence import Evidence
from feeddrive.diagnosis.likelihood.fit import Problem
from feeddrive.diagnosis.likelihood.folds import FOLDS, block_of_rows, dealt_blocks
from feeddrive.diagnosis.unexplained.floor import Floor, noise_floor
from feeddrive.diagnosis.unexplained.functional_sums import Sample
from feeddrive.diagnosis.unexplained.term import Term
from feeddrive.plant.plant import Plant
from feeddrive.typing import BoolArray, FloatArray, IntegerArray

SLOW = 1e-3
"""Share of the highest speed at which a direction turns, where the plant declares no guide friction that says."""


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
    shown: dict[Term, FloatArray]

    def columns(self, term: Term) -> FloatArray:
        """Columns of a term as the recording would show them: in the band, at the rows that count, (m, k)."""
        if term not in self.shown:
            columns = [self.evidence.thinned_band(column) for column in term.columns(self.values).T]
            self.shown[term] = np.column_stack(columns)
        return self.shown[term][self.rows[:: self.evidence.thinning]]

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
        shown: dict[Term, FloatArray] = {}
        for channel in channels:
            if channel not in evidence.channels:
                continue
            residual = evidence.measured[channel] - predicted[channel]
            radius = plant.chain.motor_radius if channel == "table_position" else 0.0
            floor = noise_floor(evidence, channel, radius)
            views[channel].append(
                View(evidence, channel, residual, thinned & np.isfinite(residual), values, floor, shown)
            )
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


def sample_of(views: Sequence[View], least: float) -> Sample:
    """All recordings as one sample; each has its own offset, and blocks are counted on."""
    residual = np.concatenate([view.residual[view.rows] for view in views])
    counts = [int(view.rows.sum()) for view in views]
    owner = np.repeat(np.arange(len(views)), counts)
    blocks, first = [], 0
    for view in views:
        blocks.append(first + view.dealt)
        first += FOLDS * (int(view.dealt.max(initial=0)) // FOLDS + 1)
    floors = np.array([view.floor.rms**2 for view in views])
    return Sample(
        residual,
        np.concatenate(blocks),
        (owner[:, None] == np.arange(len(views))).astype(float),
        lambda term: np.vstack([view.columns(term) for view in views]),
        float(np.average(floors, weights=counts)),
        least,
    )
