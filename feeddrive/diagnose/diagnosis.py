"""The main job: from a plant and recordings to the effects that the plant lacks, judged on data not fitted."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from feeddrive.diagnose.ambiguity import ambiguous_sets, other_places, rivals_of, with_the_simplest
from feeddrive.diagnose.correlation import correlation
from feeddrive.diagnose.cross_validation import LEAST_GAIN
from feeddrive.diagnose.evidence import Evidence
from feeddrive.diagnose.fit import Fit
from feeddrive.diagnose.judge import Judged, Share, channel_results, judged_recordings, prepared_for_judging, share_of
from feeddrive.diagnose.ledger_entry import kept_of
from feeddrive.diagnose.loop_evidence import refuse_unfit_loop
from feeddrive.diagnose.needs import WITHOUT_TORQUE
from feeddrive.diagnose.next_experiment import next_experiments
from feeddrive.diagnose.physical_reading import physical_reading
from feeddrive.diagnose.preparation import prepared
from feeddrive.diagnose.recordings import without_shifts
from feeddrive.diagnose.recordings_compared import compared_recordings, last_state, machine_as_last, with_carrying
from feeddrive.diagnose.recordings_search import search_recordings
from feeddrive.diagnose.refinement import Refinement, refined
from feeddrive.diagnose.rehoming import rehomed_plant
from feeddrive.diagnose.result import (
    Diagnosis,
    EffectResult,
    FileStamp,
    ParameterResult,
    RefusedEffect,
)
from feeddrive.diagnose.search import Search
from feeddrive.diagnose.torque_channel import without_torque_sentence
from feeddrive.diagnose.uncertainty import Interval, certainty, intervals
from feeddrive.diagnose.unexplained import explain_rest
from feeddrive.diagnose.unexplained_instead import without_stand_ins
from feeddrive.effects.base import Effect
from feeddrive.errors import InputError
from feeddrive.plant.plant import Plant
from feeddrive.recording import Recording
from feeddrive.thermal.plant import ThermalPlant

Said = Callable[[str], None]


def diagnose(
    plant: Plant | ThermalPlant,
    recordings: Sequence[Recording],
    validation: Sequence[Recording] = (),
    split: float = 0.75,
    simulate: bool = False,
    said: Said = lambda text: None,
    start: Sequence[Effect] = (),
) -> tuple[Diagnosis, tuple[Effect, ...]]:
    """Find what the plant lacks.

    Args:
        plant: as declared.
        recordings: fitted; without `validation` their last part is kept for judging.
        validation: judged only.
        split: share of each recording that is fitted where there is no `validation`.
        simulate: simulate the closed loop and refine what was found in it, where the controller is declared.
        said: told what is going on.
        start: effects found earlier, asked again before others are searched.

    Returns:
        The diagnosis, and the effects to add to the plant: the named ones, then tables of what no name explains.

    Raises:
        InputError: recordings that cannot be used with this plant.
    """
    if not 0.2 <= split <= 0.95:
        raise InputError(f"--split is {split:g}", "", "use a share between 0.2 and 0.95, such as 0.75")
    if simulate and isinstance(plant, Plant):
        refuse_unfit_loop(plant, (*recordings, *validation))
    problem, kept_for_judging, told = prepared(plant, recordings, validation, split)
    searched = search_recordings(problem, said, start)
    found = searched.search
    said("judging on data not fitted")
    judged, rehomed = _judged(found, kept_for_judging)
    if (fewer := without_stand_ins(found, judged)) is not found:
        found, searched = fewer, replace(searched, search=fewer)
        judged, rehomed = _judged(found, kept_for_judging)
    found, rivals = with_the_simplest(found, rivals_of(found, judged))
    if found is not searched.search:
        searched = replace(searched, search=found)
        judged, rehomed = _judged(found, kept_for_judging)
    refinement = Refinement(found, (judged, rehomed))
    if simulate and isinstance(plant, Plant):
        said("simulating the closed loop, and refining in simulation")
        refinement = refined(found, refinement.outcome, lambda other: _judged(other, kept_for_judging))
        found, (judged, rehomed) = refinement.found, refinement.outcome
        searched = replace(searched, search=found)
    alike = ambiguous_sets(found, rivals)
    said("looking at what is left")
    rest = explain_rest(found.problem, found.fit.effects, judged, channel_results(found.problem, judged))
    channels = channel_results(found.problem, rest.judged)
    series = judged_recordings(found.problem, rest.judged)
    compared, known = compared_recordings(searched, judged), certainty(found.problem, found.fit)
    spans = intervals(found.problem, found.fit, known)
    effects = machine_as_last(searched, compared.listed)
    count = len(without_shifts(found.fit.effects))
    shares = [share_of(found.problem, judged, found.fit.effects, i) for i in range(count)]
    said("looking for what would settle doubts")
    further = next_experiments(found, rivals, spans)
    result = Diagnosis(
        plant=plant.name,
        fit=_stamps(recordings),
        validate=_stamps(validation or recordings),
        channels=channels,
        effects=with_carrying(_effect_results(found, shares, spans), compared),
        refused=_refused(found),
        ambiguous=tuple(one.names for one in alike),
        rehomed=rehomed,
        unexplained=rest.unexplained,
        trials=found.trials,
        recordings=series,
        simulation=refinement.reported(rest.judged if rest.effects else judged),
        changes=compared.changes,
        kept=kept_of(found, known),
        alike=alike,
        next_experiments=further,
        correlation=correlation(found.problem, found.fit, known),
        notes=(
            *told,
            *other_places(found, judged),
            *last_state(searched),
            *_notes(problem.evidence, kept_for_judging, found),
            *refinement.notes,
        ),
    )
    return result, (*effects, *rest.effects)


def _judged(found: Search, evidence: Sequence[Evidence]) -> tuple[list[Judged], tuple[str, ...]]:
    """The recordings to judge on, their position-locked effects re-homed where the encoder's zero differs."""
    declared = found.problem.plant
    after = declared.with_effects(*found.fit.effects)
    judged, rehomed = [], []
    for one in evidence:
        homed = rehomed_plant(found.problem, found.fit.effects, one)
        if homed is None:
            judged.append(prepared_for_judging(found.problem, one, declared, after))
        else:
            judged.append(prepared_for_judging(found.problem, homed.evidence, declared, homed.plant, homed.shift))
            rehomed.append(f"{one.recording.name}: {homed.statement}")
    return judged, tuple(rehomed)


def _effect_results(
    found: Search, shares: Sequence[Share], spans: Sequence[dict[str, list[Interval] | None]]
) -> tuple[EffectResult, ...]:
    results = []
    for effect, share, ends in zip(found.fit.effects, shares, spans, strict=False):  # shifts come last
        results.append(
            EffectResult(
                effect.name,
                _parameters(effect, ends),
                share.explains,
                share.carries,
                _evidence(effect, share, found.fit),
                physical_reading(effect),
            )
        )
    return tuple(results)


def _parameters(effect: Effect, known: dict[str, list[Interval] | None]) -> dict[str, ParameterResult]:
    """Values and intervals in SI; the summary of a tabulated curve is read off the table."""
    result: dict[str, ParameterResult] = {}
    if effect.name == "friction_deviation":
        result["port"] = ParameterResult(str(effect.port), "")
    if effect.place_key:
        result[effect.place_key] = ParameterResult(effect.place, "")
    for key, value in effect.values.items():
        unit, ends = effect.parameter(key).unit, known[key]
        if isinstance(value, tuple):
            result[key] = ParameterResult(list(value), unit, ends)
        else:
            result[key] = ParameterResult(value, unit, ends[0] if ends else None)
    if effect.name == "friction_vs_position":
        result.update(_curve_and_bump(effect))
    return result


def _curve_and_bump(effect: Effect) -> dict[str, ParameterResult]:
    """The form that was not fitted: a table of a bump, or peak, centre and half width of a table."""
    position, level = effect.values["position"], effect.values["delta_force"]
    if isinstance(position, tuple) and isinstance(level, tuple):
        x, force = np.array(position), np.array(level)
        above = force - np.median(force)
        top = int(np.argmax(np.abs(above)))
        wide = np.abs(above) > np.abs(above[top]) / np.e
        half = max(0.5 * float(np.ptp(x[wide])), float(np.min(np.diff(x))))
        summary = {"peak": (float(above[top]), "N"), "centre": (float(x[top]), "m"), "half_width": (half, "m")}
        return {key: ParameterResult(value, unit) for key, (value, unit) in summary.items()}
    peak, centre, width = (float(effect.values[key]) for key in ("peak", "centre", "half_width"))  # type: ignore[arg-type]
    x = centre + width * np.linspace(-2.5, 2.5, 11)
    force = peak * np.exp(-(((x - centre) / width) ** 2))
    return {"position": ParameterResult(x.tolist(), "m"), "delta_force": ParameterResult(force.tolist(), "N")}


def _evidence(effect: Effect, share: Share, fitted: Fit) -> str:
    channels = ", ".join(f"{value:.1%} of {name}" for name, value in share.explains.items() if value > 0.001)
    seen = f"Explains {channels} on data not fitted" if channels else "Explains nothing on the judged data"
    idle = "; it does not carry to them" if share.shows else "; they could hardly show it"
    more = "" if share.carries else idle
    return f"{seen}{more}. It shows as a function of {effect.signature.variable}."


def _refused(found: Search) -> tuple[RefusedEffect, ...]:
    """Candidates that were not taken, with the reason: the recording cannot show them, or they did not pay."""
    taken = {effect.name for effect in found.fit.effects}
    best = {trial.name: trial for trial in found.trials}  # the last round counts: everything else was in by then
    refused = []
    for candidate in found.problem.predictor.candidates:
        if candidate.name in taken:
            continue
        if candidate.name in found.impossible:
            refused.append(RefusedEffect(candidate.name, found.impossible[candidate.name]))
        elif candidate.name in best:
            trial = best[candidate.name]
            refused.append(RefusedEffect(candidate.name, _why_not(trial.gain, trial.standard_error)))
        else:
            refused.append(RefusedEffect(candidate.name, "it could not be fitted to these recordings"))
    return tuple(refused)


def _why_not(gain: float, error: float) -> str:
    if gain <= 0:
        return "it does not lower the error on data not fitted"
    if gain <= LEAST_GAIN:
        return f"it lowers the squared error on data not fitted by {gain:.2%}, less than the {LEAST_GAIN:.1%} asked for"
    scatter = f"within the scatter of the blocks ({error:.2%}), or others did better"
    return f"it lowers the squared error by {gain:.2%}, {scatter}"


def _notes(fitted: Sequence[Evidence], judged: Sequence[Evidence], found: Search) -> tuple[str, ...]:
    ready = {id(evidence): evidence.recording for evidence in (*fitted, *judged)}
    notes = [f"{recording.name}: {note}" for recording in ready.values() for note in recording.notes]
    declared = found.problem.plant
    notes += found.problem.predictor.told(declared, declared.with_effects(*found.fit.effects))
    unseen = {name for name, reason in found.impossible.items() if reason == WITHOUT_TORQUE}
    if unseen:
        notes.append(without_torque_sentence(unseen))
    for before, after in zip(fitted, found.problem.evidence, strict=True):
        lost = float(np.sum(before.counted & ~after.counted)) * before.recording.sample_time
        if lost > 0:
            notes.append(
                f"{before.recording.name}: {lost:.1f} s are not fitted: free play magnifies the encoder's noise there"
            )
    return tuple(notes)


def _stamps(recordings: Sequence[Recording]) -> tuple[FileStamp, ...]:
    return tuple(FileStamp(recording.source or recording.name, recording.sha256) for recording in recordings)
