"""The search: add the effect that lowers the error on data not fitted the most, until none pays; drop what does not.

Every round starts each candidate from values read off the residual, moves it one linear step, and compares it by
blocked cross-validation. Those that promise a fair part of the best are fitted; the best few of these are fitted
together with what was found before.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from feeddrive.diagnosis.calibration.beyond import beyond_tolerance
from feeddrive.diagnosis.calibration.calibrate import calibrated, recalibrated
from feeddrive.diagnosis.finding.attempt import JOINT_ITERATIONS, Attempt, together
from feeddrive.diagnosis.finding.pairs import masked_pair
from feeddrive.diagnosis.finding.round import TIE, one_round, simplest_of_the_best
from feeddrive.diagnosis.finding.scene import scene_of
from feeddrive.diagnosis.judging.result import Trial
from feeddrive.diagnosis.likelihood.coordinates import read_coordinates
from feeddrive.diagnosis.likelihood.cross_validation import (
    LEAST_GAIN,
    compare_left_out,
    least_gain,
    left_out_residual,
)
from feeddrive.diagnosis.likelihood.fit import Fit, Problem, fit, linear_step
from feeddrive.diagnosis.likelihood.folds import block_numbers
from feeddrive.typing import FloatArray, IntegerArray

MOST_EFFECTS = 8
"""Rounds at most; an axis that lacks more needs another declaration."""

CLEARLY_NEEDED = 0.1
"""Share of the squared error that an effect must bring, by one linear step, not to be refitted without it."""

UNEXPLAINED = 1.3
"""Weighted squared error per sample beyond which much is left; noise alone gives one."""

NEARLY = 0.5
"""Gain over that of the candidate taken, from which another was nearly taken."""


@dataclass(frozen=True)
class Search:
    """What the search found, and everything that it tried.

    Attributes:
        problem: recordings with the samples that the effects found can predict.
        fit: of the effects found.
        trials: every candidate of every round.
        rounds: the same as fitted, the best first.
        impossible: candidate to why the recordings cannot show it.
        before: what each round began with.
    """

    problem: Problem
    fit: Fit
    trials: tuple[Trial, ...]
    rounds: tuple[tuple[Attempt, ...], ...]
    impossible: dict[str, str]
    before: tuple[tuple[Problem, Fit], ...] = ()


@dataclass(frozen=True)
class _Turn:
    """A candidate that was nearly taken, and the number of its round, from 0."""

    search: Search
    number: int
    attempt: Attempt


def search(problem: Problem, said: Callable[[str], None] = lambda text: None) -> Search:
    """Find the effects that the declared plant lacks.

    Two effects at once can look most like a third, and one with many values like any. Where much is left, or many
    values were fitted, the search goes back to the turns where another candidate was nearly taken.

    Args:
        problem: declared plant and recordings.
        said: told what is going on, for a progress display.

    Returns:
        The effects found, fitted together, and the ledger of the search.
    """
    said("fitting declared values within their tolerances")
    problem = calibrated(problem)
    best = _greedy(problem, said)
    for turn in _turns(best)[: problem.predictor.retries]:
        if not _is_doubtful(best):
            break
        said(f"again, {turn.attempt.name} in round {turn.number + 1}")
        other = _greedy(problem, said, turn)
        if _is_better(other, best):
            best = replace(other, impossible=best.impossible)
    return best


def _is_doubtful(found: Search) -> bool:
    return _error(found.fit) > UNEXPLAINED or len(found.fit.coordinates) > found.problem.predictor.many


def _error(fitted: Fit) -> float:
    """Squared error per sample."""
    return fitted.squared_error / max(len(fitted.residual), 1)


def _is_better(other: Search, best: Search) -> bool:
    """Whether a search ends clearly nearer, or as near (Akaike) with fewer values."""
    fewer = len(best.fit.coordinates) - len(other.fit.coordinates)
    ratio, samples = _error(other.fit) / _error(best.fit), len(best.fit.residual)
    return ratio < 1 - TIE or (fewer > 0 and (ratio - 1) * _error(best.fit) * samples < 2 * fewer)


def _turns(found: Search) -> list[_Turn]:
    """Candidates that were nearly taken, the nearest first."""
    turns = []
    for number in range(len(found.before)):
        # a declared value that was named took the place of no candidate
        taken = next((t for t in found.trials if t.round == number + 1 and t.taken and t.gain > 0), None)
        for attempt in found.rounds[number] if taken is not None else ():
            near = attempt.comparison.gain / taken.gain if taken is not None else 0.0
            if taken is not None and attempt.name not in taken.name.split(" with ") and attempt.comparison.pays:
                turns.append((near, _Turn(found, number, attempt)))
    return [turn for near, turn in sorted(turns, key=lambda entry: -entry[0]) if near > NEARLY]


def _greedy(problem: Problem, said: Callable[[str], None], turn: _Turn | None = None) -> Search:
    """Round after round from the beginning, or from a turn on; then given up where it falls behind that search."""
    found = fit(problem, ())
    trials: list[Trial] = []
    rounds: list[tuple[Attempt, ...]] = []
    before: list[tuple[Problem, Fit]] = []
    if turn is not None:
        rounds, before = [*turn.search.rounds[: turn.number]], [*turn.search.before[: turn.number]]
        trials = [trial for trial in turn.search.trials if trial.round <= turn.number]
        problem, found = turn.search.before[turn.number]
    impossible: dict[str, str] = {}
    met: set[tuple[str, ...]] = set()
    while len(rounds) < MOST_EFFECTS:
        said(f"round {len(rounds) + 1}: {len(found.effects)} effects so far")
        before.append((problem, found))
        winner: Attempt | None
        if turn is not None and len(rounds) == turn.number:
            attempts, pair = [*turn.search.rounds[turn.number]], None
            winner = together(turn.attempt, found)
            rounds.append(tuple(attempts))
        else:
            attempts = one_round(scene_of(problem, found.effects), found, impossible)
            rounds.append(tuple(attempts))
            winner = simplest_of_the_best(attempts, found)
            pair = masked_pair(attempts, found, winner)
        if pair is not None:
            winner, attempts = pair, [pair, *attempts]
        rounds[-1] = tuple(attempt.for_the_record() for attempt in rounds[-1])
        taken = winner.name if winner is not None else ""
        trials += [_trial(len(rounds), attempt, attempt.name == taken) for attempt in attempts]
        attempts = []  # their series do not stay through the next round
        if winner is None:
            beyond = beyond_tolerance(problem, found)
            if beyond is None:
                break
            problem, effect = beyond
            problem, found = _refitted(problem, fit(problem, (*found.effects, effect)))
            trials.append(Trial(len(rounds), effect.name, 0.0, 0.0, True))
            continue
        problem, found = winner.problem, winner.fit
        if found.held:  # fitted while the others stayed: the slopes of all are needed from here on
            found = fit(problem, found.effects, iterations=0)
        problem, found = _refitted(problem, found)
        found = _without_idle(problem, found, 0 if pair is not None else 1)
        said(f"found so far: {', '.join(effect.name for effect in found.effects)}")
        names = tuple(sorted(effect.name for effect in found.effects))
        if names in met or _is_behind(found, len(rounds), turn):  # the new ones only take each other's place
            break
        met.add(names)
    problem, found = _refitted(problem, fit(problem, found.effects))
    return Search(problem, found, tuple(trials), tuple(rounds), impossible, tuple(before))


def _refitted(problem: Problem, found: Fit) -> tuple[Problem, Fit]:
    """Declared values and effects fitted in turn, with new slopes of the values."""
    if problem.calibration is None:
        return problem, found
    problem = recalibrated(problem, found.effects)
    return problem, fit(problem, found.effects, iterations=JOINT_ITERATIONS)


def _is_behind(found: Fit, rounds: int, turn: _Turn | None) -> bool:
    """Whether a search from a turn on, a round after it or later, is no nearer than the first was by then."""
    if turn is None or rounds <= turn.number + 1:
        return False
    first = turn.search.before[rounds][1] if rounds < len(turn.search.before) else turn.search.fit
    many = len(first.coordinates) - len(found.coordinates)
    return many <= 0 and _error(found) > _error(first)


def _trial(number: int, attempt: Attempt, taken: bool) -> Trial:
    return Trial(number, attempt.name, attempt.comparison.gain, attempt.comparison.standard_error, taken)


def _without_idle(problem: Problem, found: Fit, proved: int) -> Fit:
    """The fit without effects that no longer pay once the others are there.

    The last `proved` of them have just paid by themselves; of a pair either may have paid for both.
    """
    if len(found.effects) < 2:
        return found
    blocks = block_numbers(problem)
    errors = left_out_residual(problem, found, blocks)
    for i in range(len(found.effects) - proved):
        if _cost_of_dropping(problem, found, i, blocks, errors) > CLEARLY_NEEDED:
            continue
        rest = fit(problem, found.effects[:i] + found.effects[i + 1 :], iterations=JOINT_ITERATIONS)
        without = left_out_residual(problem, rest, blocks)
        gain = compare_left_out(without, errors, blocks, least_gain(problem, without, errors))
        if not gain.pays:
            return _without_idle(problem, fit(problem, rest.effects, iterations=JOINT_ITERATIONS), proved)
    return found


def _cost_of_dropping(problem: Problem, found: Fit, index: int, blocks: IntegerArray, errors: FloatArray) -> float:
    """Gain that the effect brings over a model without it, the others moved by one linear step only."""
    rest = found.effects[:index] + found.effects[index + 1 :]
    counts = [len(read_coordinates([effect], problem.plant)) for effect in found.effects]
    start = sum(counts[:index])
    columns = slice(start, start + counts[index])
    jacobian = np.delete(found.jacobian, columns, axis=1)
    residual = problem.residual(rest)
    step = linear_step(jacobian, residual)
    moved = Fit(rest, residual - jacobian @ step, jacobian, np.delete(found.coordinates, columns) + step)
    without = left_out_residual(problem, moved, blocks)
    return compare_left_out(without, errors, blocks, LEAST_GAIN).gain
