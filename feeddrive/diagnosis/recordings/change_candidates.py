"""What may be other from one recording to the next: every fitted parameter, and levels that change by themselves.

Levels are tried whether an effect was found there or not: friction at each port (wear, lubricant, temperature), a force
(another load or balance), a mass (another workpiece), the screw's lead (its temperature) and its stiffness (preload).

A shift is a column of the Jacobian cut to the rows of its recording, so that all are ranked by one linear step at no
further simulation.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from feeddrive.diagnosis.finding.materiality import is_material
from feeddrive.diagnosis.friction_at_port import declared_level, declared_viscous
from feeddrive.diagnosis.likelihood.coordinate_kinds import Sine, TwoHeats
from feeddrive.diagnosis.likelihood.coordinates import coordinates_of
from feeddrive.diagnosis.likelihood.cross_validation import Comparison, compare_left_out, least_gain, left_out_residual
from feeddrive.diagnosis.likelihood.fit import Fit, linear_step
from feeddrive.diagnosis.likelihood.folds import block_numbers
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.recordings.recordings import (
    RecordingPredictor,
    RecordingShift,
    Target,
    in_recording,
    is_shift,
    shift_of,
    target_of,
)
from feeddrive.effects.base import Effect
from feeddrive.effects.chain.payload import Payload
from feeddrive.effects.chain.stiffness_deviation import StiffnessDeviation
from feeddrive.effects.friction.friction_deviation import FrictionDeviation
from feeddrive.effects.source.constant_force import ConstantForce
from feeddrive.effects.travel.lead_error_cumulative import LeadErrorCumulative
from feeddrive.typing import FloatArray, IntegerArray

UNCHANGING = ("order", "break_away")
"""Parameters that no wear and no temperature changes, and those of a law's form."""

LEVELS = (FrictionDeviation.name, ConstantForce.name, Payload.name, StiffnessDeviation.name)

LEAST_CHANGE = 0.05
"""Change over the larger value from which a parameter without a physical minimum of its own has changed."""


@dataclass(frozen=True)
class Movable:
    """One coordinate of one effect, that may be other in some recordings.

    Attributes:
        target: the effect and its coordinate.
        parameter: what the coordinate stands for, in words.
        effect: number of the effect in the list.
        columns: of the coordinate in the Jacobian of the list.
    """

    target: Target
    parameter: str
    effect: int
    columns: tuple[int, ...]

    def shifts(self, recordings: Sequence[int]) -> tuple[RecordingShift, ...]:
        """Shifts of nothing yet, one per recording."""
        return tuple(shift_of(self.target, number, len(self.columns)) for number in recordings)


def levels(problem: Problem, effects: Sequence[Effect]) -> tuple[Effect, ...]:
    """Neutral effects for the levels that no effect of the list holds yet; none where temperatures are predicted."""
    plant = problem.plant
    if not problem.predictor.of_motion:
        return ()
    ports = [p for p in FrictionDeviation.ports if declared_level(plant, p) or declared_viscous(plant, p)]
    neutral: list[Effect] = [FrictionDeviation.of(port) for port in ports]
    neutral += [ConstantForce.of(force=0.0), Payload.of(mass=0.0)]
    if all("table_position" in evidence.channels for evidence in problem.evidence):
        neutral.append(LeadErrorCumulative.of(slope=0.0))
        if plant.chain.elastic:
            neutral.append(StiffnessDeviation.of(factor=1.0))
    present = {(effect.name, effect.port) for effect in effects}
    # the plant may hold one that cannot act twice
    present |= {(effect.name, effect.port) for effect in plant.effects if not effect.additive}
    return tuple(effect for effect in neutral if (effect.name, effect.port) not in present)


def movables(effects: Sequence[Effect], problem: Problem) -> tuple[Movable, ...]:
    """Every coordinate of the list that may change; shifts themselves are passed over."""
    result, at = [], 0
    for number, effect in enumerate(effects):
        for index, coordinate in enumerate(coordinates_of(effect, problem.plant)):
            count = len(coordinate.read(effect))
            parameter = str(getattr(coordinate, "key", "amplitude and phase"))
            if parameter not in UNCHANGING and not is_shift(effect):
                columns = tuple(range(at, at + count))
                result.append(Movable(target_of(effect, index), parameter, number, columns))
            at += count
    return tuple(result)


Offer = tuple[Movable, Comparison]


def offers(problem: Problem, current: Fit, free: Sequence[Movable], recordings: Sequence[int]) -> list[Offer]:
    """What every parameter promises, the likeliest first.

    Args:
        problem: recordings, with a predictor that knows their numbers.
        current: fit with everything in common that does not yet differ.
        free: parameters asked about.
        recordings: numbers of those that may differ.

    Returns:
        The best first; before it a friction level like it to the recordings, since that changes first.
    """
    blocks, rows = block_numbers(problem), recording_of_rows(problem)
    without = _left_out(problem, current, blocks)
    found: list[tuple[Movable, Comparison, FloatArray]] = []
    for one in free:
        errors = _left_out(problem, _with_shifts(problem, current, one, rows, recordings), blocks)
        found.append((one, compare_left_out(without, errors, blocks, least_gain(problem, without, errors)), errors))
    found.sort(key=lambda offer: -offer[1].gain)
    for other in found:
        if other[0].target.name == "friction_deviation":
            better = compare_left_out(other[2], found[0][2], blocks, 0.0)
            if better.gain <= 2 * better.standard_error and other[1].pays:
                found = [other, *(offer for offer in found if offer is not other)]
            break
    return [(one, comparison) for one, comparison, _ in found]


def recording_of_rows(problem: Problem) -> IntegerArray:
    """Number of the recording of every row of the residual, (m,)."""
    predictor = problem.predictor
    assert isinstance(predictor, RecordingPredictor)
    parts = []
    for evidence in problem.evidence:
        count = int(evidence.thinned(evidence.fit_rows).sum()) * len(evidence.channels)
        parts.append(np.full(count, predictor.numbers[evidence.recording]))
    parts.append(np.full(len(problem.numbers), -1))  # measured numbers are of none
    return np.concatenate(parts).astype(np.int64)


def _left_out(problem: Problem, fitted: Fit, blocks: IntegerArray) -> FloatArray:
    """Residual on blocks left out, after one linear step."""
    jacobian, residual = fitted.jacobian, fitted.residual
    step = linear_step(jacobian, residual)
    moved = replace(fitted, residual=residual - jacobian @ step, coordinates=fitted.coordinates + step)
    return left_out_residual(problem, moved, blocks)


def _with_shifts(problem: Problem, current: Fit, one: Movable, rows: IntegerArray, recordings: Sequence[int]) -> Fit:
    """The fit with shifts of nothing yet, their columns cut to the rows of their recordings."""
    parts = current.jacobian[:, list(one.columns)]
    columns = np.hstack([np.where((rows == number)[:, None], parts, 0.0) for number in recordings])
    return replace(
        current,
        effects=(*current.effects, *one.shifts(recordings)),
        jacobian=np.hstack([current.jacobian, columns]),
        coordinates=np.concatenate([current.coordinates, np.zeros(columns.shape[1])]),
    )


def targeted(effects: Sequence[Effect], problem: Problem, target: Target, number: int | None) -> Effect:
    """The effect of a target as it is in a recording."""
    return [e for e in in_recording(effects, problem.plant, number) if target.meets(e)][-1]


def keys_of(effects: Sequence[Effect], problem: Problem, target: Target) -> tuple[str, ...]:
    """Parameters that the coordinate of a target stands for; none of a curve."""
    effect = targeted(effects, problem, target, None)
    coordinate = coordinates_of(effect, problem.plant)[target.coordinate]
    if isinstance(coordinate, Sine):
        return ("amplitude", "phase")
    if isinstance(coordinate, TwoHeats):
        return (coordinate.key, coordinate.share)
    return () if isinstance(effect.values[coordinate.key], tuple) else (coordinate.key,)


def material_difference(
    problem: Problem, effects: Sequence[Effect], target: Target, number: int, other: int | None = None
) -> bool:
    """Whether a parameter differs between two recordings by as much as matters; None for one without shifts."""
    here = targeted(effects, problem, target, number)
    there = targeted(effects, problem, target, other)
    coordinate = coordinates_of(there, problem.plant)[target.coordinate]
    # levels have a physical minimum of their own, smaller than that of other parameters
    certain = 0.0 if here.name in LEVELS else 1.0
    a, b = np.array(coordinate.read(here)), np.array(coordinate.read(there))
    if not np.linalg.norm(a - b) >= LEAST_CHANGE * max(np.linalg.norm(a), np.linalg.norm(b)) * certain:
        return False
    key = getattr(coordinate, "key", "")
    values = here.values.get(key), there.values.get(key)
    if not all(isinstance(value, float) for value in values):
        return True
    # the difference as an effect of its own meets the physical minimum, the other parameters being neutral
    neutral = {p.key: p.default for p in here.parameters if p.default is not None and p.key in here.values}
    change = float(values[0]) - float(values[1])  # type: ignore[arg-type]
    at_rest = neutral.get(key, 1.0 if here.name == StiffnessDeviation.name else 0.0)
    alone = here.with_values(**{**neutral, key: change + at_rest})
    return is_material(alone, problem.plant)
