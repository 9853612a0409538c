"""From fitted shifts to what is reported: every change with its values, and what all recordings share."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from feeddrive.diagnosis.calibration.beyond import is_within_tolerance
from feeddrive.diagnosis.finding.materiality import is_material
from feeddrive.diagnosis.likelihood.fit import Problem
from feeddrive.diagnosis.recordings.change_result import CommonTrial, Measure, ParameterChange, PerRecording
from feeddrive.diagnosis.recordings.change_values import Compared, compared_values, keys_of, material_difference
from feeddrive.diagnosis.recordings.change_words import Moved, change_reading, change_statement
from feeddrive.diagnosis.recordings.changes import Changes
from feeddrive.diagnosis.recordings.recordings import Target, in_recording, without_shifts
from feeddrive.effects.base import Effect


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
    for question in questions:
        found = [
            (target, compared)
            for target in changes.targets
            for compared in compared_values(problem, changes.fit, target, question.here, question.there)
        ]
        moved = [_moved(target, compared) for target, compared in found]
        for (target, compared), one in zip(found, moved, strict=True):
            pair = question.here, question.there
            if one.clear and material_difference(problem, changes.fit.effects, target, *pair):
                result.append(_change(compared, one, moved, question))
    return tuple(result)


def _moved(target: Target, one: Compared) -> Moved:
    numbers = (one.here.value, one.there.value, one.difference.value, one.difference.half)
    return Moved(target.name, target.port, one.key, one.unit, *numbers)


def _change(compared: Compared, one: Moved, together: Sequence[Moved], question: Question) -> ParameterChange:
    here, there, difference = (Measure(v.value, v.ci95) for v in (compared.here, compared.there, compared.difference))
    return ParameterChange(
        one.effect, one.key, one.unit, str(one.port), question.name, here, question.against, there, difference,
        change_statement(one, question.name, question.against), change_reading(one, together), question.fitted,
    )  # fmt: skip


def per_recording(problem: Problem, changes: Changes, names: Sequence[str]) -> tuple[PerRecording, ...]:
    """Values of what differs, in every fitted recording."""
    result = []
    for target in changes.targets:
        for position, key in enumerate(keys_of(changes.fit.effects, problem, target)):
            values = {}
            for number, name in enumerate(names):
                one = compared_values(problem, changes.fit, target, number, None)[position]
                values[name] = Measure(one.here.value, one.here.ci95)
                unit = one.unit
            result.append(PerRecording(target.name, key, unit, str(target.port), values))
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


def common_trials(changes: Changes, judged: bool) -> tuple[CommonTrial, ...]:
    """What was tried with a value of its own per recording."""
    return tuple(
        CommonTrial(
            trial.target.name, trial.parameter, str(trial.target.port), trial.comparison.gain,
            trial.comparison.standard_error, trial.taken, trial.reason, judged,
        )
        for trial in changes.trials
    )  # fmt: skip


def neutral_somewhere(problem: Problem, effects: Sequence[Effect], effect: Effect, count: int) -> bool:
    """Whether a level is as declared in one of the recordings, so that the declared plant does not lack it.

    A declared value is as declared within its tolerance; any other level where it is too small to matter.
    """
    for number in range(count):
        here = in_recording(effects, problem.plant, number)
        same = [e for e in here if (e.name, e.port, e.place) == (effect.name, effect.port, effect.place)]
        if same:
            within = is_within_tolerance(same[-1], problem.plant)
            if within or not is_material(same[-1], problem.plant):
                return True
    return False
