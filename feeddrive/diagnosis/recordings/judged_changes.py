"""What is other in a recording that was not fitted: stated beside the errors, which it never lowers.

The fitted recordings are taken together with the judged ones, which may differ in one parameter after the other. What
is found says why an error stays, and whether the effects carry once the levels of that recording are allowed for: an
effect does not fail because the lubricant was warmer. The errors themselves are those of the plant as it was fitted.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from feeddrive.diagnosis.calibration.calibrate import with_recordings
from feeddrive.diagnosis.finding.search import Search
from feeddrive.diagnosis.judging.judge import Judged, error_series, judged_channels, share_of
from feeddrive.diagnosis.likelihood.fit import Problem
from feeddrive.diagnosis.recordings.change_report import Question, parameter_changes
from feeddrive.diagnosis.recordings.change_result import ParameterChange
from feeddrive.diagnosis.recordings.changes import Changes, find_changes
from feeddrive.diagnosis.recordings.recordings import RecordingShift, without_shifts
from feeddrive.diagnosis.recordings.recordings_search import numbered
from feeddrive.effects.base import Effect

FITTED = "the fitted recordings"
"""What judged recordings are compared with where there are several."""


@dataclass(frozen=True)
class JudgedChanges:
    """Differences of the judged recordings.

    Attributes:
        changes: as fitted, with what was tried.
        stated: the clear ones.
        carries: whether each effect of the machine carries with them allowed for; empty where nothing differs.
        explains: channel to the share of the squared error after that the differences are.
        problem: whose predictor knows the differences.
        allowed: the judged recordings with the differences in the plant after.
    """

    changes: Changes
    stated: tuple[ParameterChange, ...]
    carries: tuple[bool, ...]
    explains: dict[str, float]
    problem: Problem
    allowed: tuple[Judged, ...]


def judged_changes(found: Search, judged: Sequence[Judged]) -> JudgedChanges | None:
    """What differs in the judged recordings from the fitted ones as they were last; None where all were fitted.

    Args:
        found: the search, its effects followed by the shifts of earlier recordings.
        judged: recordings with the plants before and after.
    """
    apart = [one for one in judged if not one.evidence.fitted.any()]
    if not apart:
        return None
    problem = _together(found.problem, found.fit.effects, apart)
    first = len(found.problem.evidence)
    changes = find_changes(problem, found.fit.effects, range(first, first + len(apart)))
    if not changes.targets:
        return JudgedChanges(changes, (), (), {}, problem, tuple(judged))
    problem = changes.problem
    names = [evidence.recording.name for evidence in found.problem.evidence]
    against = names[-1] if len(names) == 1 or len(set(names)) < len(names) else f"{names[-1]}, the last one fitted"
    questions = [
        Question(first + number, one.evidence.recording.name, None, against, fitted=False)
        for number, one in enumerate(apart)
    ]
    stated = parameter_changes(problem, changes, questions)
    rehomed = {one.evidence.recording.name for one in apart if one.shift}
    stated = tuple(one for one in stated if not (one.parameter == "phase" and one.recording in rehomed))
    allowed = [Judged(j.evidence, j.before, problem.machine(changes.fit.effects)) for j in judged]
    carrying = replace(problem, evidence=found.problem.evidence)
    count = len(without_shifts(found.fit.effects))
    numbers = [question.here for question in questions]
    carries = tuple(_carries(carrying, judged, changes.fit.effects, i, numbers) for i in range(count))
    return JudgedChanges(changes, stated, carries, _explained(carrying, judged, allowed), carrying, tuple(allowed))


def _together(problem: Problem, effects: Sequence[Effect], apart: Sequence[Judged]) -> Problem:
    """Fitted and judged recordings in one problem, all of them fitted."""
    more = [replace(j.evidence, fitted=np.ones(len(j.evidence.fitted), dtype=bool)) for j in apart]
    return with_recordings(numbered(problem, more), effects, more)


def _carries(
    problem: Problem, judged: Sequence[Judged], effects: Sequence[Effect], index: int, numbers: Sequence[int]
) -> bool:
    """Whether an effect carries by its own values, everything else being as it is in the judged recordings."""
    mine = effects[index]
    own = [
        effect
        for effect in effects
        if not (isinstance(effect, RecordingShift) and effect.recording in numbers and effect.target.meets(mine))
    ]
    plant = problem.machine(own)
    return bool(share_of(problem, [Judged(j.evidence, j.before, plant) for j in judged], own, index).carries)


def _explained(problem: Problem, judged: Sequence[Judged], allowed: Sequence[Judged]) -> dict[str, float]:
    """Channel to 1 - (rms with the differences / rms without)^2 on the judged data."""
    result = {}
    for name in judged_channels(judged):
        squares = []
        for group in (judged, allowed):
            errors = [error_series(problem, j.after, j.evidence)[name] for j in group if name in j.evidence.channels]
            squares.append(sum(float(np.nansum(error**2)) for error in errors))
        result[name] = 1 - squares[1] / squares[0] if squares[0] > 0 else 0.0
    return result
