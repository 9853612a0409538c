"""Recordings mended of a fault of the recorder, before anything is searched in them or beside what was found.

The measures are those of `suspicion`: here the recordings are begun anew without the fault, and searched.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

from feeddrive.diagnosis.begun import Begun, Files
from feeddrive.diagnosis.calibration.calibrate import calibrated
from feeddrive.diagnosis.finding.search import search
from feeddrive.diagnosis.likelihood.fit import fit
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.settled import Progress, Settled
from feeddrive.diagnosis.suspicion.as_recorded import error_within_tolerances
from feeddrive.diagnosis.suspicion.fault_alone import alone_explains, faults_alone
from feeddrive.diagnosis.suspicion.suspects import MOST, Suspect, again, is_better, is_worth_a_search, suspected
from feeddrive.errors import InputError

ROUNDS = 2
"""Rounds beside the recordings as they are: a declared value that is off by far is asked where no set is likelier, and
one that is takes a round before (a table half as heavy was a clock, since a delay of a microsecond came first)."""


def fault_alone(
    begun: Begun, begin: Callable[[Files], Begun], settle: Callable[[Begun], Settled], progress: Progress
) -> tuple[Begun, Settled | None]:
    """What was found in the recordings as mended of a fault of the recorder that alone leaves noise.

    Asked before any effect. Rounds beside the recordings as they are say whether an effect leaves as little.

    Returns:
        The recordings as mended, and what was found in them. As they are and None where no fault is alone, with the
        rounds where these came to the end of a search.
    """
    problem = begun.calibrated
    if problem is None:
        return begun, None
    mended = [_mended(begun, fault, begin) for fault in faults_alone(problem)]
    able = [one for one in mended if one is not None and alone_explains(one.problem, problem)]
    if not able or problem.budget.skips("whether it is the recorder alone"):
        return begun, None
    best = min(able, key=lambda one: error_within_tolerances(one.problem, fit(one.problem, ()), problem))
    progress("it may be the recorder: asking for an effect that leaves as little")
    first = search(problem, progress, most_rounds=ROUNDS)
    as_it_is = replace(begun, searched=first if first.whole and len(problem.evidence) == 1 else None)
    if not is_worth_a_search(best.fault, best.problem, first):
        return as_it_is, None
    settled = settle(best.begun)
    return (best.reported(), settled) if is_better(best.fault, settled.searched.search, first) else (as_it_is, None)


def without_fault(
    begun: Begun, settled: Settled, begin: Callable[[Files], Begun], settle: Callable[[Begun], Settled]
) -> tuple[Begun, Settled]:
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


@dataclass(frozen=True)
class _Mended:
    """Recordings mended of a fault, the problem with their declared values calibrated, and the fault."""

    begun: Begun
    problem: Problem
    fault: Suspect

    def reported(self) -> Begun:
        """The recordings with the fault among what was mended of them."""
        return replace(self.begun, quality=(*self.begun.quality, self.fault.quality(self.begun.files[0])))


def _mended(begun: Begun, fault: Suspect, begin: Callable[[Files], Begun]) -> _Mended | None:
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
