"""From fitted shifts to what is reported: every change with its values, and what all recordings share."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from feeddrive.diagnosis.calibration.stated import is_within_tolerance
from feeddrive.diagnosis.certainty.uncertainty import certainty
from feeddrive.diagnosis.finding.materiality import is_material
from feeddrive.diagnosis.likelihood.coordinates import (
    absent_coordinates,
    coordinates_of,
    read_coordinates,
    write_coordinates,
)
from feeddrive.diagnosis.likelihood.fit import Fit
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.recordings.change_candidates import keys_of, material_difference, targeted
from feeddrive.diagnosis.recordings.change_result import Measure, ParameterChange, PerRecording
from feeddrive.diagnosis.recordings.change_words import Moved, change_reading, change_statement
from feeddrive.diagnosis.recordings.changes import Changes
from feeddrive.diagnosis.recordings.recordings import Target, in_recording, without_shifts
from feeddrive.effects.base import Effect
from feeddrive.effects.base import number as number_of
from feeddrive.typing import FloatArray

STEP = 1e-6
"""Step of the differences in coordinates of size one."""


@dataclass(frozen=True)
class Question:
    """One recording beside the one that it is compared with.

    Attributes:
        here: number of the recording.
        name: of the recording.
        there: number of the other; None for the fitted recordings as they were last.
        against: name of the other.
        fitted: whether the recording was fitted.
    """

    here: int
    name: str
    there: int | None
    against: str
    fitted: bool


def parameter_changes(problem: Problem, changes: Changes, questions: Sequence[Question]) -> tuple[ParameterChange, ...]:
    """Every parameter that is clearly other in a recording, the recordings in their order."""
    result: list[ParameterChange] = []
    for q in questions:
        found = [
            (target, moved)
            for target in changes.targets
            for moved in _without_phase_of_none(_compared_values(problem, changes.fit, target, q.here, q.there))
        ]
        together = [moved for _, moved in found]
        for target, one in found:
            if one.clear and material_difference(problem, changes.fit.effects, target, q.here, q.there):
                result.append(
                    ParameterChange(
                        one.effect, one.key, str(one.port), q.name, one.unit, one.here, q.against, one.there,
                        one.difference, change_statement(one, q.name, q.against), change_reading(one, together),
                        q.fitted,
                    )
                )  # fmt: skip
    return tuple(result)


def gone_back(
    problem: Problem, changes: Changes, names: Sequence[str], stated: Sequence[ParameterChange]
) -> tuple[ParameterChange, ...]:
    """What was other in one recording and is as in the first again in the next: a return that no first value tells.

    Args:
        problem: of the fit.
        changes: of it.
        names: of the recordings.
        stated: changes of each recording against the first.
    """
    against_first = {(one.recording, one.effect, one.parameter, one.port) for one in stated}
    result: list[ParameterChange] = []
    for number in range(2, len(names)):
        question = Question(number, names[number], number - 1, names[number - 1], fitted=True)
        for one in parameter_changes(problem, changes, [question]):
            key = one.effect, one.parameter, one.port
            if (names[number - 1], *key) in against_first and (names[number], *key) not in against_first:
                result.append(one)
    return tuple(result)


def _without_phase_of_none(found: list[Moved]) -> list[Moved]:
    """The parameters of a target; without a phase where there is no sine to have one in one of the recordings."""
    sines = [one for one in found if one.key == "amplitude"]
    there_is_none = not all(one.is_told(end) for one in sines for end in (one.here, one.there))
    return sines if there_is_none else found


def _compared_values(problem: Problem, fitted: Fit, target: Target, here: int, there: int | None) -> list[Moved]:
    """The parameters of a target in one recording and in another, with intervals.

    `here`, `there` are numbers of recordings; None for those without shifts.
    """
    covariance = certainty(problem, fitted).half_covariance
    found = []
    for key in keys_of(fitted.effects, problem, target):

        def values(effects: Sequence[Effect], key: str = key) -> FloatArray:
            return np.array([targeted(effects, problem, target, n).values[key] for n in (here, there)], dtype=float)

        def at(vector: FloatArray, values: Callable[[Sequence[Effect]], FloatArray] = values) -> FloatArray:
            return values(write_coordinates(fitted.effects, problem.plant, vector))

        base = at(fitted.coordinates)
        units = np.eye(len(fitted.coordinates))
        slope = np.column_stack([(at(fitted.coordinates + STEP * unit) - base) / STEP for unit in units])
        rows = np.vstack([slope, slope[:1] - slope[1:]])
        widths = np.sqrt(np.maximum(np.einsum("ij,jk,ik->i", rows, covariance, rows), 0.0))
        first, second = map(float, values(fitted.effects))
        numbers = zip((first, second, first - second), map(float, widths), strict=True)
        unit = targeted(fitted.effects, problem, target, here).parameter(key).unit
        found.append(Moved(target.name, target.port, key, unit, *(Measure(*number) for number in numbers)))
    return found


def per_recording(problem: Problem, changes: Changes, names: Sequence[str]) -> tuple[PerRecording, ...]:
    """Values of what differs, in every fitted recording."""
    result = []
    for target in changes.targets:
        rows = [_compared_values(problem, changes.fit, target, number, None) for number in range(len(names))]
        for same in zip(*rows, strict=True):
            values = {name: one.here for name, one in zip(names, same, strict=True)}
            result.append(PerRecording(target.name, same[0].key, str(target.port), same[0].unit, values))
    return tuple(result)


def shared_parameters(problem: Problem, effects: Sequence[Effect], changes: Changes) -> tuple[str, ...]:
    """Fitted parameters that all recordings have in common, as `effect.parameter`."""
    own = {(t.name, t.port, key) for t in changes.targets for key in keys_of(changes.fit.effects, problem, t)}
    return tuple(
        f"{effect.name}.{key}"
        for effect in without_shifts(effects)
        for key in effect.values
        if (effect.name, effect.port, key) not in own
    )


def is_as_declared(problem: Problem, changes: Changes, effect: Effect, number: int) -> bool:
    """Whether a level that differs is as declared in one of the recordings: the declared plant lacks none of it there.

    A declared value is as declared within its tolerance; any other level where it is too small to matter, or is not
    told from none.
    """
    here = in_recording(changes.fit.effects, problem.plant, number)
    same = [e for e in here if (e.name, e.port, e.place) == (effect.name, effect.port, effect.place)]
    if not same:
        return False
    within = bool(is_within_tolerance(same[-1], problem.plant))
    return within or not is_material(same[-1], problem.plant) or is_none(problem, changes, effect, number)


def is_none(problem: Problem, changes: Changes, effect: Effect, number: int) -> bool:
    """Whether an effect of which a level differs is not told from none in one of the recordings.

    No size that differs is `SURE` deviations from none, and it has no other. A place, an order or another choice
    of its form is no size. A declared value is never none.
    """
    if is_within_tolerance(effect, problem.plant) is not None:
        return False
    absent, _ = absent_coordinates([effect], problem.plant)
    at = read_coordinates([effect], problem.plant)
    (none,) = write_coordinates([effect], problem.plant, np.where(np.isnan(absent), at, absent))
    targets = {target.coordinate: target for target in changes.targets if target.meets(effect)}
    sizes, first = 0, 0
    for index, coordinate in enumerate(coordinates_of(effect, problem.plant)):
        places = slice(first, first + len(coordinate.read(effect)))
        first = places.stop
        if np.isnan(absent[places]).any():
            continue
        target = targets.get(index)
        if target is None or not keys_of(changes.fit.effects, problem, target):
            return False
        one = _compared_values(problem, changes.fit, target, number, None)[0]  # of a sine that is its amplitude
        if one.is_told(one.here, number_of(none.values[one.key])):
            return False
        sizes += 1
    return sizes > 0
