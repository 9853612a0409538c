"""The main job: from a plant and recordings to the effects that the plant lacks, judged on data not fitted."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from feeddrive.blas_threads import one_thread
from feeddrive.diagnosis.begun import Begun, Files
from feeddrive.diagnosis.budget import Budget
from feeddrive.diagnosis.calibration.calibrated_result import calibrated_results, known_together
from feeddrive.diagnosis.certainty.ambiguity import ambiguous_sets, other_places
from feeddrive.diagnosis.certainty.correlation import correlation
from feeddrive.diagnosis.certainty.inclusion import odds_for, possible_effects
from feeddrive.diagnosis.certainty.next_experiment import next_experiments
from feeddrive.diagnosis.certainty.one_sided import all_intervals
from feeddrive.diagnosis.certainty.uncertainty import certainty
from feeddrive.diagnosis.finding.search import Search
from feeddrive.diagnosis.judging.effect_results import effect_results, refused_effects
from feeddrive.diagnosis.judging.fitted_stroke import beyond_fitted_stroke, fitted_stroke
from feeddrive.diagnosis.judging.judge import channel_results, judged_recordings
from feeddrive.diagnosis.judging.law_tables import without_tables
from feeddrive.diagnosis.judging.result import (
    Diagnosis,
    FileStamp,
)
from feeddrive.diagnosis.judging.where_fitted import share_where_fitted
from feeddrive.diagnosis.ledger.entry import kept_of
from feeddrive.diagnosis.likelihood.evidence import Evidence
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.mended import fault_alone, without_fault
from feeddrive.diagnosis.numbers.doubted import sentence, without_wrong
from feeddrive.diagnosis.numbers.measured_file import MeasuredNumber
from feeddrive.diagnosis.numbers.number_rows import MeasuredRows, NumberResult, number_results, refuse_ungiven
from feeddrive.diagnosis.preparation import Shown, informative, prepared, shown
from feeddrive.diagnosis.recordings.compared import compared_recordings, last_state, machine_as_last, with_carrying
from feeddrive.diagnosis.recordings.recordings import without_shifts
from feeddrive.diagnosis.settled import Progress, Settled, settle
from feeddrive.diagnosis.simulated.loop_evidence import refuse_unfit_loop
from feeddrive.diagnosis.starts.needs import WITHOUT_TORQUE
from feeddrive.diagnosis.suspicion.logged import declared_hold, declared_sentence, hold_of, may_be_logged, open_lag
from feeddrive.diagnosis.suspicion.logged import sentence as held_for
from feeddrive.diagnosis.suspicion.logged_rows import with_recorder_that_holds
from feeddrive.diagnosis.suspicion.quality import flawed, read_otherwise
from feeddrive.diagnosis.suspicion.recording_faults import refuse_faulty
from feeddrive.diagnosis.suspicion.suspects import (
    beyond_its_constant,
)
from feeddrive.diagnosis.suspicion.torque_channel import without_torque_sentence
from feeddrive.diagnosis.unexplained.carry import with_carried
from feeddrive.diagnosis.unexplained.unexplained import explain_rest
from feeddrive.diagnosis.unexplained.unexplained_result import beside_changes
from feeddrive.effects.base import Effect
from feeddrive.errors import InputError
from feeddrive.plant.plant import Plant
from feeddrive.recording import Recording


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

    def begin(files: Files, hold: float | None, numbers: Sequence[MeasuredNumber]) -> Begun:
        problem, judged, notes = prepared(plant, *files, split, hold)
        problem = replace(problem, numbers=MeasuredRows(tuple(numbers)), budget=allowed)
        refuse_ungiven(problem.numbers, plant)
        refuse_faulty(problem, (*problem.evidence, *judged))
        held = held_for if declared is None else declared_sentence
        also = () if hold is None else (held(hold, files[0][0].sample_time),)
        problem, judged, quality = with_recorder_that_holds(problem, judged)
        return Begun(files, problem, judged, (*notes, *also), quality)

    find = partial(settle, simulate=in_the_loop, progress=progress, start=start)
    begun = begin((recordings, validation), declared, measured)
    begun = begun if start else begun.ready()  # what was found earlier stands beside the declared values
    begun, alone = fault_alone(begun, lambda files: begin(files, declared, measured), find, progress)
    settled = alone or find(begun)
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
            settled = find(begun)
    begun, settled, doubted = _without_wrong_numbers(begun, settled, find)
    progress("asking whether it is the recorder")
    kept = [number for number in measured if number not in doubted]
    if alone is None:
        begun, settled = without_fault(begun, settled, lambda files: begin(files, hold, kept), find)
    logged = () if hold is not None else open_lag(settled.searched.search.fit.effects, every)
    begun = replace(begun, notes=(*begun.notes, *logged))
    return _reported(plant, begun, settled, doubted, progress)


def _reported(
    plant: Plant, begun: Begun, settled: Settled, doubted: Sequence[MeasuredNumber], progress: Progress
) -> tuple[Diagnosis, tuple[Effect, ...]]:
    """What was found, as it is reported, and the effects to add to the plant."""
    recordings, validation = begun.files
    searched, judged, refinement = settled.searched, settled.judged, settled.refinement
    odds = odds_for(settled.weighed, settled.rivals)
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
        effects=with_carrying(effect_results(found, shares, spans, odds), compared),
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
            *beyond_fitted_stroke(found.problem.evidence, judged),
            *refinement.notes,
            *((budget.sentence,) if budget.sentence else ()),
        ),
        untried=budget.sentence,
        fitted_stroke=fitted_stroke(found.problem.evidence, plant.chain.motor_radius if plant.has_motion else 0.0),
    )
    return result, (*effects, *rest.effects)


def _numbers_met(found: Search, doubted: Sequence[MeasuredNumber]) -> tuple[NumberResult, ...]:
    """The measured numbers beside what the declared plant gives, and the plant with what was found."""
    problem = found.problem.settled(found.fit.effects)
    if not len(problem.numbers) and not doubted:
        return ()
    rows = MeasuredRows((*problem.numbers.numbers, *doubted))
    return number_results(rows, problem.plant, problem.machine(found.fit.effects), len(doubted))


def _without_wrong_numbers(
    begun: Begun, settled: Settled, find: Callable[[Begun], Settled]
) -> tuple[Begun, Settled, tuple[MeasuredNumber, ...]]:
    """What was found without measured numbers that are wrong, and these."""

    def again_with(problem: Problem) -> Settled:
        return find(replace(begun, problem=problem, calibrated=None, searched=None))

    problem, settled, wrong = without_wrong(begun.problem, settled, lambda one: one.searched.search, again_with)
    notes = tuple(sentence(one, settled.searched.search) for one in wrong)
    return replace(begun, problem=problem, calibrated=None, searched=None, notes=(*begun.notes, *notes)), settled, wrong


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
