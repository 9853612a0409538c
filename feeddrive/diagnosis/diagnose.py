"""The main job: from a plant and recordings to the effects that the plant lacks, judged on data not fitted."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from feeddrive.blas_threads import one_thread
from feeddrive.diagnosis.budget import Budget
from feeddrive.diagnosis.calibration.calibrate import calibrated, levelled_alike, weighed_alike
from feeddrive.diagnosis.calibration.calibrated_result import calibrated_results, known_together
from feeddrive.diagnosis.certainty.ambiguity import Rival, ambiguous_sets, other_places, rivals_of
from feeddrive.diagnosis.certainty.correlation import correlation
from feeddrive.diagnosis.certainty.inclusion import asserted, odds_for, possible_effects
from feeddrive.diagnosis.certainty.next_experiment import next_experiments
from feeddrive.diagnosis.certainty.one_sided import all_intervals
from feeddrive.diagnosis.certainty.preferred import judged_apart, judged_as_good, with_the_preferred
from feeddrive.diagnosis.certainty.uncertainty import certainty
from feeddrive.diagnosis.finding.search import Search, search
from feeddrive.diagnosis.judging.denied_again import settled_names
from feeddrive.diagnosis.judging.effect_results import effect_results, refused_effects
from feeddrive.diagnosis.judging.judge import Judged, channel_results, judged_recordings, prepared_for_judging
from feeddrive.diagnosis.judging.law_tables import with_law_tables, without_tables
from feeddrive.diagnosis.judging.result import (
    Diagnosis,
    FileStamp,
)
from feeddrive.diagnosis.judging.veto import not_worse_than_declared, without_denied
from feeddrive.diagnosis.judging.where_fitted import share_where_fitted
from feeddrive.diagnosis.ledger.entry import kept_of
from feeddrive.diagnosis.likelihood.evidence import Evidence
from feeddrive.diagnosis.likelihood.fit import fit
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.motion.row_steps import in_told_steps
from feeddrive.diagnosis.numbers.doubted import sentence, without_wrong
from feeddrive.diagnosis.numbers.measured_file import MeasuredNumber
from feeddrive.diagnosis.numbers.number_rows import MeasuredRows, NumberResult, number_results, refuse_ungiven
from feeddrive.diagnosis.preparation import Shown, informative, prepared, shown
from feeddrive.diagnosis.recordings.compared import compared_recordings, last_state, machine_as_last, with_carrying
from feeddrive.diagnosis.recordings.recordings import without_shifts
from feeddrive.diagnosis.recordings.recordings_search import Searched, search_recordings
from feeddrive.diagnosis.recordings.rehoming import rehomed_plant
from feeddrive.diagnosis.simulated.loop_evidence import refuse_unfit_loop
from feeddrive.diagnosis.simulated.refinement import Refinement, refined
from feeddrive.diagnosis.starts.needs import WITHOUT_TORQUE
from feeddrive.diagnosis.suspicion.as_recorded import error_within_tolerances
from feeddrive.diagnosis.suspicion.fault_alone import alone_explains, faults_alone
from feeddrive.diagnosis.suspicion.logged import declared_hold, declared_sentence, hold_of, may_be_logged, open_lag
from feeddrive.diagnosis.suspicion.logged import sentence as held_for
from feeddrive.diagnosis.suspicion.logged_rows import with_recorder_that_holds
from feeddrive.diagnosis.suspicion.quality import Quality, flawed, read_otherwise
from feeddrive.diagnosis.suspicion.recording_faults import refuse_faulty
from feeddrive.diagnosis.suspicion.suspects import (
    MOST,
    Suspect,
    again,
    beyond_its_constant,
    is_better,
    is_worth_a_search,
    suspected,
)
from feeddrive.diagnosis.suspicion.torque_channel import without_torque_sentence
from feeddrive.diagnosis.unexplained.carry import with_carried
from feeddrive.diagnosis.unexplained.unexplained import explain_rest, without_stand_ins
from feeddrive.diagnosis.unexplained.unexplained_result import beside_changes
from feeddrive.effects.base import Effect
from feeddrive.errors import InputError
from feeddrive.plant.plant import Plant
from feeddrive.recording import Recording

Progress = Callable[[str], None]


@one_thread()
def diagnose(
    plant: Plant,
    recordings: Sequence[Recording],
    validation: Sequence[Recording] = (),
    split: float = 0.75,
    simulate: bool = False,
    progress: Progress = lambda text: None,
    start: Sequence[Effect] = (),
    measured: Sequence[MeasuredNumber] = (),
    budget: Budget | None = None,
) -> tuple[Diagnosis, tuple[Effect, ...]]:
    """Find what the plant lacks.

    Args:
        plant: as declared.
        recordings: fitted; without `validation` their last part is kept for judging.
        validation: judged only.
        split: share of each recording that is fitted where there is no `validation`.
        simulate: simulate the closed loop and refine what was found in it, where the controller is declared.
        progress: called with a line that says what is going on.
        start: effects found earlier, asked again before others are searched.
        measured: numbers (a stiffness, a frequency, a drag torque, a lost motion) beside recordings of motion.
        budget: of time; as long as it takes if None.

    Returns:
        The diagnosis, and the effects to add to the plant: the named ones, then tables of what no name explains.

    Raises:
        InputError: recordings that cannot be used with this plant.
    """
    if not 0.2 <= split <= 0.95:
        raise InputError(f"--split is {split:g}", "", "use a share between 0.2 and 0.95, such as 0.75")
    allowed = budget or Budget()
    recordings = informative(plant, recordings, 1.0 if validation else split)
    validation = informative(plant, validation)
    every = (*recordings, *validation)
    in_motion = shown(plant, recordings) is Shown.MOTION
    in_the_loop = simulate and in_motion
    if in_the_loop:
        refuse_unfit_loop(plant, every)
    declared = declared_hold(plant, every) if in_motion else None
    if measured and not in_motion:
        mend = "diagnose the numbers alone, or beside a recording of motion and torque"
        raise InputError("measured numbers beside recordings of heat", plant.name, mend)

    def begin(files: Files, hold: float | None, numbers: Sequence[MeasuredNumber]) -> _Begun:
        problem, judged, notes = prepared(plant, *files, split, hold)
        problem = replace(problem, numbers=MeasuredRows(tuple(numbers)), budget=allowed)
        refuse_ungiven(problem.numbers, plant)
        refuse_faulty(problem, (*problem.evidence, *judged))
        held = held_for if declared is None else declared_sentence
        also = () if hold is None else (held(hold, files[0][0].sample_time),)
        problem, judged, quality = with_recorder_that_holds(problem, judged)
        return _Begun(files, problem, judged, (*notes, *also), quality)

    def settle(begun: _Begun) -> _Settled:
        return _settled(begun, in_the_loop, progress, start)

    begun = begin((recordings, validation), declared, measured)
    begun = begun if start else begun.ready()  # what was found earlier stands beside the declared values
    alone = _fault_alone(begun, lambda files: begin(files, declared, measured), settle, progress)
    begun, settled = alone or (begun, settle(begun))
    hold = declared
    if hold is None and may_be_logged(every):
        found = settled.searched.search
        spans = all_intervals(found.problem, found.fit, certainty(found.problem, found.fit))
        hold = hold_of(found.fit.effects, spans, every)
        if hold is not None and allowed.skips("a torque that is logged more slowly than the drive holds it"):
            hold = None
        if hold is not None:
            progress("the torque is logged more slowly than the drive holds it: again")
            begun = begin(begun.files, hold, measured)
            settled = settle(begun)
    begun, settled, doubted = _without_wrong_numbers(begun, settled, settle)
    progress("asking whether it is the recorder")
    kept = [number for number in measured if number not in doubted]
    if alone is None:
        begun, settled = _without_fault(begun, settled, lambda files: begin(files, hold, kept), settle)
    logged = () if hold is not None else open_lag(settled.searched.search.fit.effects, every)
    begun = replace(begun, notes=(*begun.notes, *logged))
    return _reported(plant, begun, settled, doubted, progress)


def _reported(
    plant: Plant, begun: _Begun, settled: _Settled, doubted: Sequence[MeasuredNumber], progress: Progress
) -> tuple[Diagnosis, tuple[Effect, ...]]:
    """What was found, as it is reported, and the effects to add to the plant."""
    recordings, validation = begun.files
    searched, judged, refinement = settled.searched, settled.judged, settled.refinement
    found = searched.search
    budget = begun.problem.budget
    progress("looking at what is left")
    alike = ambiguous_sets(found, settled.rivals)
    compared, known = compared_recordings(searched, judged), certainty(found.problem, found.fit)
    there, with_changes, allowed = compared.allowing(found, judged)  # what is stated to differ is not left
    bare, plain = without_tables(there, with_changes, allowed)
    tables = {name: own for name, own in found.problem.tables.items() if name in {e.name for e in found.fit.effects}}
    rest = explain_rest(bare, with_changes, plain, channel_results(bare, plain), tables)
    after = with_carried(without_tables(found.problem, found.fit.effects, judged)[1], *rest.effects)
    unexplained = rest.unexplained if allowed is judged else beside_changes(rest.unexplained)
    spans = all_intervals(found.problem, found.fit, known)
    effects = machine_as_last(searched, compared.listed)
    count = len(without_shifts(found.fit.effects))
    shares = [share_where_fitted(found.problem, found.fit, judged, i) for i in range(count)]
    progress("looking for what would settle doubts")
    no_time = budget.skips("which experiment settles a doubt")
    experiments = () if no_time else next_experiments(found, settled.rivals, spans)
    result = Diagnosis(
        plant=plant.name,
        fit=_stamps(recordings),
        validate=_stamps(validation or recordings),
        channels=channel_results(found.problem, after),
        effects=with_carrying(effect_results(found, shares, spans, odds_for(found, settled.rivals)), compared),
        possible=possible_effects(found, settled.rivals),
        refused=refused_effects(found),
        ambiguous=tuple(one.names for one in alike),
        rehomed=settled.rehomed,
        unexplained=unexplained,
        trials=found.trials,
        recordings=judged_recordings(found.problem, after),
        simulation=refinement.reported(after if rest.effects else judged),
        changes=compared.changes,
        quality=(
            *begun.quality,
            *beyond_its_constant(found.problem, found.fit),
            *read_otherwise(effects, plant, any("motor_torque" in e.channels for e in begun.problem.evidence)),
            *flawed((*recordings, *validation)),
        ),
        calibrated=calibrated_results(found.problem, found.fit),
        measured=_numbers_met(found, doubted),
        kept=kept_of(found, known),
        alike=alike,
        next_experiments=experiments,
        correlation=correlation(found.problem, found.fit, known),
        notes=(
            *begun.notes,
            *other_places(found, judged),
            *known_together(found.problem, found.fit),
            *last_state(searched),
            *_notes(begun.problem.evidence, begun.judged, found),
            *refinement.notes,
            *((budget.sentence,) if budget.sentence else ()),
        ),
        untried=budget.sentence,
    )
    return result, (*effects, *rest.effects)


def _numbers_met(found: Search, doubted: Sequence[MeasuredNumber]) -> tuple[NumberResult, ...]:
    """The measured numbers beside what the declared plant gives, and the plant with what was found."""
    problem = found.problem.settled(found.fit.effects)
    if not len(problem.numbers) and not doubted:
        return ()
    rows = MeasuredRows((*problem.numbers.numbers, *doubted))
    return number_results(rows, problem.plant, problem.machine(found.fit.effects), len(doubted))


Files = tuple[Sequence[Recording], Sequence[Recording]]
"""Recordings to fit and to judge on."""


@dataclass(frozen=True)
class _Begun:
    """Recordings before anything was searched.

    Attributes:
        files: the recordings.
        problem: of those that are fitted.
        judged: what is judged on.
        notes: remarks about them.
        quality: what was mended of them.
        calibrated: the problem with its declared values fitted beside no effect, where that was asked for.
    """

    files: Files
    problem: Problem
    judged: list[Evidence]
    notes: tuple[str, ...]
    quality: tuple[Quality, ...]
    calibrated: Problem | None = None

    def ready(self) -> _Begun:
        """The recordings with the declared values calibrated; as they are where what differs in several goes first."""
        return self if len(self.problem.evidence) > 1 else replace(self, calibrated=calibrated(self.problem))


@dataclass(frozen=True)
class _Settled:
    """What was found, once data not fitted have had their say.

    Attributes:
        searched: the search, without effects that stand in for others, refined in simulation where that was asked.
        rivals: per effect, those that would do as well.
        judged, rehomed: the recordings judged on, and remarks about their zeros.
        refinement: in closed-loop simulation.
    """

    searched: Searched
    rivals: list[list[Rival]]
    judged: list[Judged]
    rehomed: tuple[str, ...]
    refinement: Refinement


def _settled(begun: _Begun, simulate: bool, progress: Progress, start: Sequence[Effect]) -> _Settled:
    searched, evidence = search_recordings(begun.calibrated or begun.problem, progress, start), begun.judged
    budget = begun.problem.budget
    budget.end_of_search()
    found = searched.search
    machine = found.problem.machine(found.fit.effects)
    noise = begun.problem.evidence, found.problem.evidence
    evidence = [
        in_told_steps(levelled_alike(one, *noise, machine), machine, found.problem.predictor) for one in evidence
    ]
    progress("judging on data not fitted")
    judged, rehomed = _judged(found, evidence)
    if searched.changes is None:
        carrying = with_law_tables(found, judged, lambda other: _judged(other, evidence)[0])
        if carrying is not found:
            found = carrying
            judged, rehomed = _judged(found, evidence)
    if (fewer := without_stand_ins(found, judged)) is not found:
        found = fewer
        judged, rehomed = _judged(found, evidence)

    def judge(other: Search) -> list[Judged]:
        return _judged(other, evidence)[0]

    found, judged = settled_names(found, judged, judge, progress)
    rivals = rivals_of(found, judged)
    preferred, ranked = with_the_preferred(found, rivals)
    put_in = judged if preferred is found else judge(preferred)
    if preferred is not found and judged_as_good(found.problem, judged, put_in):
        new = _names(preferred) - _names(found)
        kept, after = without_denied(
            preferred, put_in, judge, () if judged_apart(found.problem, judged, put_in) else new
        )
        denied = new - _names(kept)
        if denied:  # what its own evidence denies takes no place: what was taken stands
            rivals = [[rival for rival in alike if rival.effect.name not in denied] for alike in rivals]
        else:
            found, judged = kept, after
            rivals = ranked if kept is preferred else rivals_of(kept, after)
    sure = asserted(found)
    if sure is not found:
        found, judged = sure, judge(sure)
        rivals = rivals_of(found, judged)
    found, judged = not_worse_than_declared(found, judged, judge)
    judged, rehomed = _judged(found, evidence)
    refinement = Refinement(found, (judged, rehomed))
    if simulate and not budget.skips("the simulated loop"):
        progress("simulating the closed loop, and refining in simulation")
        refinement = refined(found, refinement.outcome, lambda other: _judged(other, evidence))
        found, (judged, rehomed) = refinement.found, refinement.outcome
    changes = searched.changes
    if changes is not None:  # beside the declared values of the names that are left
        changes = replace(changes, problem=found.problem, fit=found.fit)
    return _Settled(Searched(found, changes), rivals, judged, rehomed, refinement)


def _names(found: Search) -> set[str]:
    return {effect.name for effect in found.fit.effects}


def _fault_alone(
    begun: _Begun, begin: Callable[[Files], _Begun], settle: Callable[[_Begun], _Settled], progress: Progress
) -> tuple[_Begun, _Settled] | None:
    """What was found in the recordings as mended of a fault of the recorder that alone leaves noise; None for none.

    Asked before any effect. A round beside the recordings as they are says whether one effect leaves as little.
    """
    problem = begun.calibrated
    if problem is None:
        return None
    mended = [_mended(begun, fault, begin) for fault in faults_alone(problem)]
    able = [one for one in mended if one is not None and alone_explains(one.problem, problem)]
    if not able:
        return None
    best = min(able, key=lambda one: error_within_tolerances(one.problem, fit(one.problem, ()), problem))
    progress("it may be the recorder: asking for an effect that leaves as little")
    first = search(problem, progress, most_rounds=1)
    if not is_worth_a_search(best.fault, best.problem, first):
        return None
    settled = settle(best.begun)
    return (best.reported(), settled) if is_better(best.fault, settled.searched.search, first) else None


@dataclass(frozen=True)
class _Mended:
    """Recordings mended of a fault, the problem with their declared values calibrated, and the fault."""

    begun: _Begun
    problem: Problem
    fault: Suspect

    def reported(self) -> _Begun:
        """The recordings with the fault among what was mended of them."""
        return replace(self.begun, quality=(*self.begun.quality, self.fault.quality(self.begun.files[0])))


def _mended(begun: _Begun, fault: Suspect, begin: Callable[[Files], _Begun]) -> _Mended | None:
    """The recordings without a fault, and without what is left of it in them, as a size is read from slopes.

    None where that leads to recordings of no machine, or to a fault of no recorder.
    """
    for _ in range(2):
        files = [[fault.mended(recording) for recording in part] for part in begun.files]
        try:
            other = begin((files[0], files[1]))
        except InputError:  # a recording that no machine has made
            return None
        problem = calibrated(other.problem)
        other = replace(other, calibrated=problem) if len(problem.evidence) == 1 else other
        left = again(problem, fault.kind)
        if left is None:
            break
        fault = replace(fault, deviation=left.deviation)
        if abs(left.size) < left.deviation:
            break
        fault = replace(fault, size=fault.size + left.size)
        if abs(fault.size) > MOST[fault.kind]:
            return None
    return _Mended(other, problem, fault)


def _without_fault(
    begun: _Begun, settled: _Settled, begin: Callable[[Files], _Begun], settle: Callable[[_Begun], _Settled]
) -> tuple[_Begun, _Settled]:
    """What was found, in recordings mended of a fault where that says more than what was found in them as they are."""
    budget = begun.problem.budget
    fault = None if budget.skips("whether it is the recorder") else suspected(settled.searched.search)
    mended = None if fault is None else _mended(begun, fault, begin)
    if mended is None or not is_worth_a_search(mended.fault, mended.problem, settled.searched.search):
        return begun, settled
    again_settled = settle(mended.begun)
    if not is_better(mended.fault, again_settled.searched.search, settled.searched.search):
        return begun, settled
    return mended.reported(), again_settled


def _without_wrong_numbers(
    begun: _Begun, settled: _Settled, settle: Callable[[_Begun], _Settled]
) -> tuple[_Begun, _Settled, tuple[MeasuredNumber, ...]]:
    """What was found without measured numbers that are wrong, and these."""

    def again_with(problem: Problem) -> _Settled:
        return settle(replace(begun, problem=problem, calibrated=None))

    problem, settled, wrong = without_wrong(begun.problem, settled, lambda one: one.searched.search, again_with)
    notes = tuple(sentence(one, settled.searched.search) for one in wrong)
    return replace(begun, problem=problem, calibrated=None, notes=(*begun.notes, *notes)), settled, wrong


def _judged(found: Search, evidence: Sequence[Evidence]) -> tuple[list[Judged], tuple[str, ...]]:
    """The recordings to judge on, their position-locked effects re-homed where the encoder's zero differs."""
    problem = found.problem.settled(found.fit.effects)
    declared, after = problem.plant, problem.machine(found.fit.effects)
    judged, rehomed = [], []
    for one in (weighed_alike(each, problem.evidence) for each in evidence):
        homed = rehomed_plant(problem, found.fit.effects, one)
        if homed is None:
            judged.append(prepared_for_judging(problem, one, declared, after))
        else:
            judged.append(prepared_for_judging(problem, homed.evidence, declared, homed.plant, homed.shift))
            rehomed.append(f"{one.recording.name}: {homed.statement}")
    return judged, tuple(rehomed)


def _notes(fitted: Sequence[Evidence], judged: Sequence[Evidence], found: Search) -> tuple[str, ...]:
    ready = dict.fromkeys((*fitted, *judged))  # a recording may be both
    notes = [f"{evidence.recording.name}: {note}" for evidence in ready for note in evidence.recording.notes]
    declared = found.problem.plant
    notes += found.problem.predictor.remarks(declared, found.problem.machine(found.fit.effects))
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
