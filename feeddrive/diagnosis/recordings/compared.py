"""All that a diagnosis says about differences between its recordings, fitted and judged.

What is other in a recording that was not fitted is stated beside the errors, which it never lowers. The fitted
recordings are taken together with the judged ones, which may differ in one parameter after the other. What is found
says why an error stays, and whether the effects carry once the levels of that recording are allowed for: an effect
does not fail because the lubricant was warmer. The errors themselves are those of the plant as it was fitted.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from feeddrive.diagnosis.calibration.calibrate import with_recordings
from feeddrive.diagnosis.finding.materiality import is_material
from feeddrive.diagnosis.finding.search import Search
from feeddrive.diagnosis.judging.judge import (
    Judged,
    error_series,
    judged_channels,
    prepared_for_judging,
    share_beyond,
    share_of,
)
from feeddrive.diagnosis.judging.result import EffectResult
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.likelihood.standing import declining
from feeddrive.diagnosis.recordings.change_report import (
    Question,
    gone_back,
    is_as_declared,
    is_none,
    parameter_changes,
    per_recording,
    shared_parameters,
)
from feeddrive.diagnosis.recordings.change_result import ParameterChange, RecordingChanges
from feeddrive.diagnosis.recordings.changes import Changes, find_changes
from feeddrive.diagnosis.recordings.recordings import RecordingShift, without_shifts
from feeddrive.diagnosis.recordings.recordings_search import Searched, numbered
from feeddrive.effects.base import Effect


@dataclass(frozen=True)
class Compared:
    """What differs, and what follows from it for the effects.

    Attributes:
        changes: to be reported.
        judged: differences of the judged recordings; None where all were fitted.
        listed: which effects of the machine the declared plant lacks in every recording.
    """

    changes: RecordingChanges
    judged: JudgedChanges | None
    listed: tuple[bool, ...]

    def allowing(self, found: Search, judged: Sequence[Judged]) -> tuple[Problem, tuple[Effect, ...], Sequence[Judged]]:
        """Problem, effects and judged recordings with what differs in these; as they are where nothing does."""
        own = self.judged
        if own is None or not own.changes.targets:
            return found.problem, tuple(found.fit.effects), judged
        return own.problem, tuple(own.changes.fit.effects), own.allowed


def compared_recordings(searched: Searched, judged: Sequence[Judged]) -> Compared:
    """Differences between the fitted recordings, and of the judged ones from them."""
    found, own = searched.search, searched.changes
    names = recording_names([evidence.recording.name for evidence in found.problem.evidence])
    left_out = found.problem.budget.skips("what differs in the recordings that are judged on")
    others = None if left_out else judged_changes(found, judged)
    stated: tuple[ParameterChange, ...] = ()
    result = RecordingChanges()
    if own is not None:
        questions = [Question(n, names[n], 0, names[0], fitted=True) for n in range(1, len(names))]
        stated = parameter_changes(found.problem, own, questions)
        stated = (*stated, *gone_back(found.problem, own, names, stated))
        result = RecordingChanges(
            per_recording=per_recording(found.problem, own, names),
            shared=shared_parameters(found.problem, found.fit.effects, own),
            trials=own.trials,
        )
    if others is not None:
        trials = (*result.trials, *(replace(one, judged=True) for one in others.changes.trials))
        result = replace(result, trials=trials, explains=others.explains)
        stated = (*stated, *others.stated)
    return Compared(replace(result, changes=stated), others, _listed(searched, len(names)))


def recording_names(names: Sequence[str]) -> list[str]:
    """Names of recordings, numbered where two files have the same name."""
    return [name if names.count(name) == 1 else f"{name} ({number})" for number, name in enumerate(names, start=1)]


def _listed(searched: Searched, count: int) -> tuple[bool, ...]:
    found, own = searched.search, searched.changes
    differ = _differing(searched)
    return tuple(
        own is None
        or effect not in differ
        or not any(is_as_declared(found.problem, own, effect, number) for number in range(count))
        for effect in without_shifts(found.fit.effects)
    )


def _differing(searched: Searched) -> list[Effect]:
    """Effects of the machine of which a level differs between the recordings."""
    effects = searched.search.fit.effects
    moved = [one.target for one in effects if isinstance(one, RecordingShift)]
    return [one for one in without_shifts(effects) if any(target.meets(one) for target in moved)]


def machine_as_last(searched: Searched, listed: Sequence[bool]) -> tuple[Effect, ...]:
    """Effects of the machine as it was in the last recording: those listed, then levels that changed to matter."""
    found, own = searched.search, searched.changes
    machine, last = without_shifts(found.fit.effects), len(found.problem.evidence) - 1
    first = [effect for effect, named in zip(machine, listed, strict=True) if named]
    rest = [
        effect
        for effect, named in zip(machine, listed, strict=True)
        if not named
        and is_material(effect, found.problem.plant)
        and not (own is not None and is_none(found.problem, own, effect, last))
    ]
    return (*first, *rest)


def last_state(searched: Searched) -> tuple[str, ...]:
    """Names the recording whose plant was found, where they differ."""
    if searched.changes is None or not searched.changes.targets:
        return ()
    last = searched.search.problem.evidence[-1].recording.name
    return (f"the recordings differ: values and plant_after.toml are of the machine as it was in {last}",)


def with_carrying(results: Sequence[EffectResult], compared: Compared) -> tuple[EffectResult, ...]:
    """The listed effects; whether they carry is asked with the levels of the judged recordings, and that is stated."""
    carries = compared.judged.carries if compared.judged is not None else ()
    kept = []
    for number, (result, named) in enumerate(zip(results, compared.listed, strict=True)):
        if not named:
            continue
        one = result
        if carries and carries[number] != result.carries:
            seen = "it carries" if carries[number] else "it does not carry"
            one = replace(one, carries=carries[number], evidence=f"{one.evidence} With the changes allowed for {seen}.")
        if not one.carries:
            one = replace(one, evidence=f"{one.evidence}{_why_not(one, compared)}")
        kept.append(one)
    return tuple(kept)


def _why_not(result: EffectResult, compared: Compared) -> str:
    """Why an effect does not carry, where its own parameter is known to be other there."""
    port = result.parameters.get("port")
    for change in compared.changes.changes:
        same = change.effect == result.name and (port is None or port.value == change.port)
        if same and not change.fitted:
            return f" Not in {change.recording} as fitted: {change.statement}."
    return ""


@dataclass(frozen=True)
class JudgedChanges:
    """Differences of the judged recordings.

    Attributes:
        changes: as fitted, with what was tried.
        stated: the clear ones.
        carries: whether each effect of the machine carries with them allowed for; empty where nothing differs.
        other: whether a value of each effect differs itself, and with that value it carries: it is there, as another.
        explains: channel to the share of the squared error after that the differences are.
        problem: whose predictor knows the differences.
        allowed: the judged recordings with the differences in the plant after.
    """

    changes: Changes
    stated: tuple[ParameterChange, ...]
    carries: tuple[bool, ...]
    other: tuple[bool, ...]
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
    known: JudgedChanges
    for effects, after, known in found.asked:  # every name that is denied asks, and the report
        if effects == found.fit.effects and after == [one.after for one in judged]:
            return known
    result = _judged_changes(found, judged, apart)
    found.asked.append((found.fit.effects, [one.after for one in judged], result))
    return result


def _judged_changes(found: Search, judged: Sequence[Judged], apart: Sequence[Judged]) -> JudgedChanges:
    """What differs in the judged recordings; `apart` are those of which nothing was fitted."""
    # fitted and judged recordings in one problem, all of them fitted
    more = [replace(one.evidence, fitted=np.ones(len(one.evidence.fitted), dtype=bool)) for one in apart]
    problem = with_recordings(numbered(found.problem, more), found.fit.effects, more)
    first = len(found.problem.evidence)
    changes = find_changes(problem, found.fit.effects, range(first, first + len(apart)))
    if not changes.targets:
        return JudgedChanges(changes, (), (), (), {}, problem, tuple(judged))
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
    there = problem.machine(changes.fit.effects)
    allowed = [prepared_for_judging(problem, j.evidence.whole, j.before, there) for j in judged]
    carrying = replace(problem, evidence=found.problem.evidence)
    count = len(without_shifts(found.fit.effects))
    numbers = [question.here for question in questions]
    carries = tuple(_carries(carrying, judged, changes.fit.effects, i, numbers) for i in range(count))
    differs = [any(t.meets(e) for t in changes.targets) for e in found.fit.effects[:count]]
    other = tuple(one and _is_there(carrying, allowed, changes.fit.effects, i) for i, one in enumerate(differs))
    return JudgedChanges(
        changes, stated, carries, other, _explained(carrying, judged, allowed), carrying, tuple(allowed)
    )


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
    there = [prepared_for_judging(problem, j.evidence.whole, j.before, plant) for j in judged]
    return bool(share_of(problem, there, own, index).carries)


def _is_there(problem: Problem, allowed: Sequence[Judged], effects: Sequence[Effect], index: int) -> bool:
    """Whether an effect shows and carries with the values that it has in the judged recordings; else it is gone."""
    mine = effects[index]
    without = [
        effect
        for i, effect in enumerate(effects)
        if i != index and not (isinstance(effect, RecordingShift) and effect.target.meets(mine))
    ]
    share = share_beyond(problem, allowed, without)
    return share.shows and share.carries


def _explained(problem: Problem, judged: Sequence[Judged], allowed: Sequence[Judged]) -> dict[str, float]:
    """Channel to 1 - (rms with the differences / rms without)^2 on the judged data."""
    result = {}
    for name in judged_channels(judged):
        pairs = [(j, a) for j, a in zip(judged, allowed, strict=True) if name in a.evidence.channels]
        without, having = [], []
        for j, a in pairs:
            both = a.evidence.within(j.evidence)
            before, after = (error_series(problem, plant, both)[name][both.judged_rows] for plant in (j.after, a.after))
            alone = j.evidence.beside(a.evidence)
            if alone.judged_rows.any():  # which the machine with the differences does not predict
                its, own = (
                    error_series(problem, plant, alone)[name][alone.judged_rows] for plant in (j.after, a.after)
                )
                before = np.concatenate([before, its])
                after = np.concatenate([after, declining(its, own, float(np.mean(after**2)))])
            without.append(before)
            having.append(after)
        squares = [float(np.sum(np.concatenate(errors) ** 2)) for errors in (without, having)]
        result[name] = 1 - squares[1] / squares[0] if squares[0] > 0 else 0.0
    return result
