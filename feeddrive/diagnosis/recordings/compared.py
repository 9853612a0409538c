"""All that a diagnosis says about differences between its recordings, fitted and judged."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from feeddrive.diagnosis.finding.materiality import is_material
from feeddrive.diagnosis.judging.judge import Judged
from feeddrive.diagnosis.judging.result import EffectResult
from feeddrive.diagnosis.recordings.change_report import (
    Question,
    common_trials,
    neutral_somewhere,
    parameter_changes,
    per_recording,
    shared_parameters,
)
from feeddrive.diagnosis.recordings.change_result import ParameterChange, RecordingChanges
from feeddrive.diagnosis.recordings.judged_changes import JudgedChanges, judged_changes
from feeddrive.diagnosis.recordings.recordings import RecordingShift, without_shifts
from feeddrive.diagnosis.recordings.recordings_search import Searched
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


def compared_recordings(searched: Searched, judged: Sequence[Judged]) -> Compared:
    """Differences between the fitted recordings, and of the judged ones from them."""
    found, own = searched.search, searched.changes
    names = recording_names([evidence.recording.name for evidence in found.problem.evidence])
    others = judged_changes(found, judged)
    stated: tuple[ParameterChange, ...] = ()
    result = RecordingChanges()
    if own is not None:
        questions = [Question(n, names[n], 0, names[0], fitted=True) for n in range(1, len(names))]
        stated = parameter_changes(found.problem, own, questions)
        result = RecordingChanges(
            per_recording=per_recording(found.problem, own, names),
            shared=shared_parameters(found.problem, found.fit.effects, own),
            trials=common_trials(own, judged=False),
        )
    if others is not None:
        result = replace(
            result, trials=(*result.trials, *common_trials(others.changes, judged=True)), explains=others.explains
        )
        stated = (*stated, *others.stated)
    return Compared(replace(result, changes=stated), others, _listed(searched, len(names)))


def recording_names(names: Sequence[str]) -> list[str]:
    """Names of recordings, numbered where two files have the same name."""
    return [name if names.count(name) == 1 else f"{name} ({number})" for number, name in enumerate(names, start=1)]


def _listed(searched: Searched, count: int) -> tuple[bool, ...]:
    found = searched.search
    effects = found.fit.effects
    moved = [effect.target for effect in effects if isinstance(effect, RecordingShift)]
    return tuple(
        not (any(t.meets(one) for t in moved) and neutral_somewhere(found.problem, effects, one, count))
        for one in without_shifts(effects)
    )


def machine_as_last(searched: Searched, listed: Sequence[bool]) -> tuple[Effect, ...]:
    """Effects of the machine as it was in the last recording: those listed, then levels that changed to matter."""
    found = searched.search
    machine = without_shifts(found.fit.effects)
    first = [effect for effect, named in zip(machine, listed, strict=True) if named]
    rest = [
        effect
        for effect, named in zip(machine, listed, strict=True)
        if not named and is_material(effect, found.problem.plant)
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
