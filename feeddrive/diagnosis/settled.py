"""What was found, once data not fitted have had their say."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from feeddrive.diagnosis.begun import Begun
from feeddrive.diagnosis.calibration.calibrate import levelled_alike, showing_encoder, weighed_alike
from feeddrive.diagnosis.certainty.ambiguity import Rival, rivals_of
from feeddrive.diagnosis.certainty.inclusion import asserted
from feeddrive.diagnosis.certainty.preferred import judged_apart, judged_as_good, with_the_preferred
from feeddrive.diagnosis.finding.elsewhere import at_likelier_place
from feeddrive.diagnosis.finding.search import Search
from feeddrive.diagnosis.judging.asked_of_fit import sizes_around_none
from feeddrive.diagnosis.judging.denied_again import settled_names
from feeddrive.diagnosis.judging.judge import Judged, prepared_for_judging
from feeddrive.diagnosis.judging.law_tables import with_law_tables
from feeddrive.diagnosis.judging.veto import without_denied
from feeddrive.diagnosis.judging.worse import not_worse_than_declared
from feeddrive.diagnosis.likelihood.evidence import Evidence
from feeddrive.diagnosis.likelihood.fit import fitted_to_the_end
from feeddrive.diagnosis.motion.row_steps import in_told_steps
from feeddrive.diagnosis.recordings.recordings_search import Searched, search_recordings
from feeddrive.diagnosis.recordings.rehoming import rehomed_plant
from feeddrive.diagnosis.simulated.refinement import Refinement, refined
from feeddrive.diagnosis.unexplained.unexplained import without_stand_ins
from feeddrive.effects.base import Effect

Progress = Callable[[str], None]


@dataclass(frozen=True)
class Settled:
    """What was found, once data not fitted have had their say.

    Attributes:
        searched: the search, without effects that stand in for others, refined in simulation where that was asked.
        rivals: per effect, those that would do as well.
        judged, rehomed: the recordings judged on, and remarks about their zeros.
        refinement: in closed-loop simulation.
        weighed: the search as its names were weighed, before that refinement.
    """

    searched: Searched
    rivals: list[list[Rival]]
    judged: list[Judged]
    rehomed: tuple[str, ...]
    refinement: Refinement
    weighed: Search


def settle(begun: Begun, simulate: bool, progress: Progress, start: Sequence[Effect]) -> Settled:
    """What a search finds and data not fitted bear out.

    Args:
        begun: the recordings.
        simulate: refine what was found in the simulated closed loop.
        progress: called with a line that says what is going on.
        start: effects found earlier.
    """
    problem, evidence = begun.calibrated or begun.problem, begun.judged
    searched = search_recordings(problem, progress, start, begun.searched)
    budget = begun.problem.budget
    budget.end_of_search()
    found = searched.search
    machine = found.problem.machine(found.fit.effects)
    noise = begun.problem.evidence, found.problem.evidence
    shown = showing_encoder(found.problem, found.fit.effects)
    evidence = [in_told_steps(levelled_alike(one, *noise, shown), machine, found.problem.predictor) for one in evidence]
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
    found, judged, rivals = _with_preferred_names(found, judged, rivals_of(found, judged), judge)
    sure = asserted(found)
    if sure is not found:
        found, judged = sure, judge(sure)
        rivals = rivals_of(found, judged)
    found, judged, rivals = _at_the_end(found, judged, rivals, judge)
    found, judged = not_worse_than_declared(found, judged, judge)
    judged, rehomed = _judged(found, evidence)
    weighed, refinement = found, Refinement(found, (judged, rehomed))
    if simulate and not budget.skips("the simulated loop"):
        progress("simulating the closed loop, and refining in simulation")
        refinement = refined(found, refinement.outcome, lambda other: _judged(other, evidence))
        found, (judged, rehomed) = refinement.found, refinement.outcome
    changes = searched.changes
    if changes is not None:  # beside the declared values of the names that are left
        changes = replace(changes, problem=found.problem, fit=found.fit)
    return Settled(Searched(found, changes), rivals, judged, rehomed, refinement, weighed)


def _at_the_end(
    found: Search, judged: list[Judged], rivals: list[list[Rival]], judge: Callable[[Search], list[Judged]]
) -> tuple[Search, list[Judged], list[list[Rival]]]:
    """The search with its fit at the end, without names whose intervals hold none of them there.

    A play that stands in for the law of a friction was told from none where the fit was asked, and not where it ended.
    """
    further = fitted_to_the_end(found.problem, found.fit)
    if further is found.fit:
        return found, judged, rivals
    found = replace(found, fit=further)
    judged = judge(found)
    if not any(sizes_around_none(found.problem, further)):
        return found, judged, rivals
    kept, after = without_denied(found, judged, judge)
    if len(kept.fit.effects) == len(further.effects):
        return found, judged, rivals
    return kept, after, rivals_of(kept, after)


def _with_preferred_names(
    found: Search, judged: list[Judged], rivals: list[list[Rival]], judge: Callable[[Search], list[Judged]]
) -> tuple[Search, list[Judged], list[list[Rival]]]:
    """The search with a name replaced that has a rival to be preferred, each at its likeliest place; else as it is.

    What its own evidence denies takes no place: what was taken stands.
    """
    preferred, ranked = with_the_preferred(found, rivals)
    if preferred is found:
        return found, judged, rivals
    put_in = judge(preferred)
    if not judged_as_good(found.problem, judged, put_in):
        return found, judged, rivals
    new = _names(preferred) - _names(found)
    kept, after = without_denied(preferred, put_in, judge, () if judged_apart(found.problem, judged, put_in) else new)
    if denied := new - _names(kept):
        return found, judged, [[rival for rival in alike if rival.effect.name not in denied] for alike in rivals]
    placed = at_likelier_place(kept.problem, kept.fit, kept.count)
    if placed is not None:
        kept = replace(kept, problem=placed[0], fit=placed[1])
        after = judge(kept)
    return kept, after, ranked if kept is preferred else rivals_of(kept, after)


def _names(found: Search) -> set[str]:
    return {effect.name for effect in found.fit.effects}


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
