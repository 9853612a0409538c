"""Refinement in simulation: the effects found keep their names, their values are fitted to the closed loop.

The values found by equation error are the start and, with their covariance, the prior (`loop_fit`). The same samples
are fitted as before. Refined values are kept only where, on data not fitted,

- the closed loop is simulated better: the mean square error of its channels, each in shares of what it was, falls, and
  no channel's rms rises by more than one percent;
- no predicted channel's squared error rises by a larger share than that of the loop falls: both are errors of one
  machine on the same samples.

Otherwise the values of the attribution stay, and the result says so.

The error of a loop is that of what the plant does on its own, set-point given. Torque in shares of its rms; the table
position in shares of the rms of the following error (recorded position less set-point, about its mean). Unfiltered,
over the judged samples that the declared controller commanded.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from feeddrive.diagnosis.certainty.uncertainty import certainty
from feeddrive.diagnosis.finding.search import Search
from feeddrive.diagnosis.judging.judge import Judged, channel_results
from feeddrive.diagnosis.likelihood.coordinates import write_coordinates
from feeddrive.diagnosis.likelihood.fit import fit
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.recordings.recordings import RecordingPredictor, is_shift
from feeddrive.diagnosis.simulated.loop_evidence import LoopEvidence, loop_evidence
from feeddrive.diagnosis.simulated.loop_fit import LoopProblem, coordinate_count, fit_loop, foretold, loop_problem
from feeddrive.diagnosis.simulated.simulation_result import (
    ErrorFigure,
    RefinedValue,
    SimulatedChannel,
    SimulationResult,
)
from feeddrive.effects.base import Effect, Kind
from feeddrive.errors import InputError
from feeddrive.plant.plant import Plant
from feeddrive.recording.channels import channel_unit
from feeddrive.typing import BoolArray, FloatArray
from feeddrive.units.quantity import percent

CHANNEL_MARGIN = 0.01
"""Share by which the rms of one simulated channel may rise where the others gain."""

DELAYED = "a delay moves the instants at which the torque switches, and has no derivative"
CHAOTIC = "the simulated loop does not follow a small change of it in proportion: free play, or a jump"

KEPT = "The values were refined in closed-loop simulation, which does better with them on data not fitted."
NOT_KEPT = "Values refined in closed-loop simulation were not kept: {reason}. The values are those of the attribution."

Outcome = tuple[list[Judged], tuple[str, ...]]
"""Judged recordings, and what was re-homed."""

Judge = Callable[[Search], Outcome]


LoopErrors = dict[str, ErrorFigure]
"""Channel to its simulation error, all judged recordings together."""


@dataclass(frozen=True)
class Refinement:
    """The search with the values that are reported, how it is judged, and what the simulation says.

    Attributes:
        found: with refined values where they were kept.
        outcome: of judging it.
        simulation: None where the loop could not be simulated.
        notes: why not.
        loops: judged recordings under their controller.
    """

    found: Search
    outcome: Outcome
    simulation: SimulationResult | None = None
    notes: tuple[str, ...] = ()
    loops: tuple[LoopEvidence, ...] = ()

    def saying(self, statement: str, kept_back: Mapping[str, str] | None = None) -> Refinement:
        """A copy with a statement and the effects that could not be moved."""
        assert self.simulation is not None
        simulation = replace(self.simulation, statement=statement, not_refined=kept_back or {})
        return replace(self, simulation=simulation)

    def reported(self, judged: Sequence[Judged]) -> SimulationResult | None:
        """The result with `after` of these judged recordings, which may have more than the effects that were found."""
        simulation = self.simulation
        if simulation is None or all(new is old for new, old in zip(judged, self.outcome[0], strict=True)):
            return simulation
        after = errors_after(self.found.problem, judged, self.loops)
        if not _finite(after):
            return simulation
        channels = tuple(replace(channel, after=after[channel.name]) for channel in simulation.channels)
        return replace(simulation, after=channels[0].after.relative, channels=channels)


def refined(found: Search, outcome: Outcome, judge: Judge) -> Refinement:
    """Simulate the closed loop, and refine the values of the effects found.

    Args:
        found: effects with the values of the equation error.
        outcome: of judging them.
        judge: judges other values of them.
    """
    plant, judged = found.problem.plant, outcome[0]
    try:
        loops = tuple(loop_evidence(plant, j.evidence) for j in judged)
    except InputError as refusal:
        return Refinement(found, outcome, notes=(f"no closed-loop simulation: {refusal.what} ({refusal.mend})",))
    before, attributed = loop_errors(loops, [j.before for j in judged]), errors_after(found.problem, judged, loops)
    if not before or not _finite(before, attributed):
        return Refinement(found, outcome, notes=("no closed-loop simulation: the loop cannot be followed",))
    plain = Refinement(found, outcome, _result(before, attributed, None, False), loops=loops)
    if not found.fit.effects:
        return plain.saying("Nothing to refine: no effect was found.")
    if any(is_shift(effect) for effect in found.fit.effects):
        return plain.saying("Not refined: the recordings differ, and have values of their own.")
    try:
        problem = _problem(found)
        effects = tuple(write_coordinates(found.fit.effects, plant, fit_loop(problem)))
    except InputError as refusal:  # a loop that cannot be simulated, or no compiler
        return plain.saying(f"Not refined: {refusal.what}.")
    kept_back = _kept_back(problem)
    if effects == found.fit.effects:
        return plain.saying("Refinement in simulation left every value where it was.", kept_back)
    other = replace(found, fit=fit(found.problem, effects, iterations=0))
    judged_other = judge(other)
    after = errors_after(other.problem, judged_other[0], loops)
    reason = why_not_kept(found, attributed, after, judged, judged_other[0])
    result = replace(
        _result(before, attributed, after, not reason),
        statement=KEPT if not reason else NOT_KEPT.format(reason=reason),
        refined=_values(found.fit.effects, effects),
        not_refined=kept_back,
    )
    return replace(plain, simulation=result) if reason else Refinement(other, judged_other, result, loops=loops)


def _problem(found: Search) -> LoopProblem:
    settled = found.problem.settled(found.fit.effects)
    plant = settled.machine().with_effects(*settled.tables_of(found.fit.effects))
    loops = [loop_evidence(plant, evidence) for evidence in found.problem.evidence]
    fitted = [loop for loop in loops if loop.fit_rows.any()]
    if not fitted:
        raise InputError("the declared controller commanded none of the fitted samples", plant.name)
    covariance = certainty(found.problem, found.fit).covariance
    problem = loop_problem(plant, found.fit.effects, fitted, covariance)
    return replace(problem, free=foretold(problem))


def why_not_kept(
    found: Search, attributed: LoopErrors, after: LoopErrors, old: Sequence[Judged], new: Sequence[Judged]
) -> str:
    """Why refined values are not kept; an empty text where they are.

    Args:
        found: the search.
        attributed, after: simulation errors before and after the refinement, on data not fitted.
        old, new: judged recordings before and after.
    """
    if not _finite(after):
        return "the loop cannot be followed with them"
    ratios = {name: after[name].rms / attributed[name].rms for name in attributed}
    gain = 1 - float(np.mean([ratio**2 for ratio in ratios.values()]))
    if not gain > 0:
        return f"they raise the simulated squared error on data not fitted by {percent(-gain, 2)}"
    for name, ratio in ratios.items():
        if ratio > 1 + CHANNEL_MARGIN:
            return f"the simulated {name} would be worse by {percent(ratio - 1, 1)} on data not fitted"
    pairs = zip(channel_results(found.problem, old), channel_results(found.problem, new), strict=True)
    for was, would in pairs:
        rise = (would.after.rms / was.after.rms) ** 2 - 1
        if rise > gain:
            return (
                f"they raise the squared error of the predicted {was.name} by {percent(rise, 2)}, "
                f"and lower that of the simulated loop by {percent(gain, 2)}"
            )
    return ""


def _kept_back(problem: LoopProblem) -> dict[str, str]:
    """Effects some of whose values the refinement could not move, with the reason."""
    reasons, first = {}, 0
    for effect in problem.effects:
        count = coordinate_count(effect, problem.plant)
        part: BoolArray = problem.free[first : first + count]
        first += count
        if not part.all():
            reasons[effect.name] = DELAYED if effect.kind is Kind.TIMING else CHAOTIC
    return reasons


def _values(before: Sequence[Effect], after: Sequence[Effect]) -> tuple[RefinedValue, ...]:
    return tuple(
        RefinedValue(old.name, key, old.parameter(key).unit, old.values[key], new.values[key])
        for old, new in zip(before, after, strict=True)
        for key in old.values
        if old.values[key] != new.values[key]
    )


def _result(before: LoopErrors, attributed: LoopErrors, after: LoopErrors | None, kept: bool) -> SimulationResult:
    tried = after or {}
    final = tried if kept else attributed
    channels = tuple(
        SimulatedChannel(name, channel_unit(name, ""), before[name], final[name], attributed[name], tried.get(name))
        for name in before
    )
    first = channels[0]
    refinement = first.after_refinement.relative if first.after_refinement is not None else None
    shares = first.before.relative, first.after.relative, first.after_attribution.relative
    return SimulationResult(first.name, *shares, refinement, kept, channels=channels)


def _finite(*errors: LoopErrors) -> bool:
    return all(np.isfinite(error.rms) for each in errors for error in each.values())


def loop_errors(loops: Sequence[LoopEvidence], plants: Sequence[Plant]) -> LoopErrors:
    """Channel to its simulation error over the judged samples.

    Args:
        loops: judged recordings.
        plants: one for each of them.

    Returns:
        Empty where nothing is left to judge; not a number where a plant could not be followed.
    """
    missed: dict[str, list[FloatArray]] = {}
    shown: dict[str, list[FloatArray]] = {}
    for loop, plant in zip(loops, plants, strict=True):
        rows = loop.judged_rows
        if not rows.any():
            continue
        for name, error in loop.missed(loop.simulated(plant), rows).items():
            missed.setdefault(name, []).append(error)
            shown.setdefault(name, []).append(_scale(loop, name)[rows])
    return {name: _error(np.concatenate(missed[name]), np.concatenate(shown[name])) for name in missed}


def errors_after(problem: Problem, judged: Sequence[Judged], loops: Sequence[LoopEvidence]) -> LoopErrors:
    """Errors of the plants after, each as it is in its recording, on the samples of the loops."""
    plants, predictor = [j.after for j in judged], problem.predictor
    if isinstance(predictor, RecordingPredictor):
        plants = [predictor.machine(j.after, j.evidence) for j in judged]
    return loop_errors(loops, plants)


def _scale(loop: LoopEvidence, name: str) -> FloatArray:
    series = loop.recording[name]
    if name != "table_position":
        return series
    behind = series - loop.recording["setpoint"]
    following: FloatArray = behind - behind.mean()
    return following


def _error(error: FloatArray, scale: FloatArray) -> ErrorFigure:
    rms = float(np.sqrt(np.mean(error**2)))
    return ErrorFigure(rms, rms / float(np.sqrt(np.mean(scale**2))))
