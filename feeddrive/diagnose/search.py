"""The search: add the effect that lowers the error on data not fitted the most, until none pays; drop what does not.

Every round starts each candidate from values read off the residual, moves it one linear step, and compares it by
blocked cross-validation. Those that promise a fair part of the best are fitted; the best few of these are fitted
together with what was found before.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace

import numpy as np

from feeddrive.diagnose.attempt import JOINT_ITERATIONS, PROMISE, Attempt, refined, started, together
from feeddrive.diagnose.coordinates import read_coordinates
from feeddrive.diagnose.cross_validation import (
    LEAST_GAIN,
    block_numbers,
    compare_left_out,
    least_gain,
    left_out_residual,
)
from feeddrive.diagnose.fit import Fit, Problem, fit
from feeddrive.diagnose.pairs import masked_pair
from feeddrive.diagnose.result import Trial
from feeddrive.diagnose.scene import Scene
from feeddrive.effects.base import Effect
from feeddrive.typing import FloatArray, IntegerArray

MOST_EFFECTS = 8
"""Rounds at most; an axis that lacks more needs another declaration."""

FINALISTS = 3
"""Candidates of a round that are refitted together with what was found before."""

FAIR_PART = 0.3
"""Gain over that of the best fitted candidate, from which a candidate is fitted too: starts are near by design (orders
from a periodogram, velocities and stiffnesses scanned), so that one linear step shows most of an effect's worth."""

TIE = 0.05
"""Share of the squared error by which a simpler candidate may be worse, if the difference is not significant."""

CLEARLY_NEEDED = 0.1
"""Share of the squared error that an effect must bring, by one linear step, not to be refitted without it."""

UNEXPLAINED = 1.3
"""Weighted squared error per sample beyond which much is left; noise alone gives one."""

WORKERS = 2
"""Candidates tried at the same time; the loop over samples runs outside Python's lock."""


@dataclass(frozen=True)
class Search:
    """What the search found, and everything that it tried."""

    problem: Problem
    fit: Fit
    trials: tuple[Trial, ...]
    rounds: tuple[tuple[Attempt, ...], ...]
    impossible: dict[str, str]


def search(problem: Problem, said: Callable[[str], None] = lambda text: None) -> Search:
    """Find the effects that the declared plant lacks.

    Where much is left unexplained and the machine is cheap to simulate, the search is begun again with the next best
    first effects: two effects at once can look most like a third.

    Args:
        problem: declared plant and recordings.
        said: told what is going on, for a progress display.

    Returns:
        The effects found, fitted together, and the ledger of the search.
    """
    best = _greedy(problem, said)
    openings = [] if not best.rounds else [a for a in best.rounds[0] if a.comparison.pays]
    taken = best.fit.effects[0].name if best.fit.effects else ""
    for first in [a for a in openings if a.name != taken][: problem.predictor.retries]:
        if _explained(best):
            break
        said(f"much is left: again, {first.name} first")
        other = _greedy(problem, said, (best.rounds[0], first))
        if other.fit.squared_error < (1 - TIE) * best.fit.squared_error:
            best = replace(other, impossible=best.impossible)
    return best


def _explained(found: Search) -> bool:
    return found.fit.squared_error < UNEXPLAINED * len(found.fit.residual)


def _greedy(
    problem: Problem, said: Callable[[str], None], opening: tuple[tuple[Attempt, ...], Attempt] | None = None
) -> Search:
    """The search, its first round as given where there is an opening: the attempts, and the one to be taken."""
    found = fit(problem, ())
    trials: list[Trial] = []
    rounds: list[tuple[Attempt, ...]] = []
    impossible: dict[str, str] = {}
    met: set[tuple[str, ...]] = set()
    while len(rounds) < MOST_EFFECTS:
        said(f"round {len(rounds) + 1}: {len(found.effects)} effects so far")
        winner: Attempt | None
        if opening is not None and not rounds:
            attempts, winner, pair = [*opening[0]], together(opening[1], found), None
            rounds.append(opening[0])
        else:
            attempts = _round(problem.predictor.scene(problem, found.effects), found, impossible)
            rounds.append(tuple(attempts))
            winner = _simplest_of_the_best(attempts)
            pair = masked_pair(attempts, found, winner)
        if pair is not None:
            winner, attempts = pair, [pair, *attempts]
        taken = winner.name if winner is not None else ""
        trials += [_trial(len(rounds), attempt, attempt.name == taken) for attempt in attempts]
        if winner is None:
            break
        problem, found = winner.problem, _without_idle(winner.problem, winner.fit, 0 if pair is not None else 1)
        said(f"found so far: {', '.join(effect.name for effect in found.effects)}")
        names = tuple(sorted(effect.name for effect in found.effects))
        if names in met:  # the new ones only take each other's place
            break
        met.add(names)
    found = fit(problem, found.effects)
    return Search(problem, found, tuple(trials), tuple(rounds), impossible)


def _simplest_of_the_best(attempts: Sequence[Attempt]) -> Attempt | None:
    """The best attempt, or one with fewer parameters that cannot be told from it; None if the best does not pay."""
    paying = [a for a in attempts if a.comparison.pays]  # a larger gain by chance does not hide a smaller sure one
    attempts = [a for a in paying if a.problem.predictor.is_material(a.fit.effects[-1], a.problem.plant)]
    if not attempts:
        return None
    best = attempts[0]
    tied = [best]
    for other in attempts[1:]:
        if other.comparison.pays and len(other.errors) == len(best.errors):
            better = compare_left_out(other.errors, best.errors, block_numbers(best.problem), LEAST_GAIN)
            if better.gain < max(LEAST_GAIN, min(2 * better.standard_error, TIE)):
                tied.append(other)
    return min(tied, key=lambda a: len(read_coordinates(a.fit.effects[-1:], a.problem.plant)))


def _trial(number: int, attempt: Attempt, taken: bool) -> Trial:
    return Trial(number, attempt.name, attempt.comparison.gain, attempt.comparison.standard_error, taken)


def _round(scene: Scene, found: Fit, impossible: dict[str, str]) -> list[Attempt]:
    """All candidates of one round, the best first."""
    ready = []
    for candidate in scene.problem.predictor.candidates:
        if _already(candidate.name, found.effects):
            continue
        reason = candidate.needs(scene)
        if reason:
            impossible[candidate.name] = reason
        else:
            ready.append(candidate)
    with ThreadPoolExecutor(WORKERS) as pool:
        groups = pool.map(lambda candidate: started(scene, candidate), ready)
        attempts = _promising_refined(scene, [attempt for group in groups for attempt in group], pool)
        best = _best_per_name(attempts)
        promising = max(PROMISE, FAIR_PART * best[0].comparison.gain) if best else PROMISE
        names = [attempt.name for attempt in best[:FINALISTS] if attempt.comparison.gain > promising]
        finalists = [attempt for attempt in _best_per_place(attempts) if attempt.name in names]
        joint = list(pool.map(lambda attempt: together(attempt, found), finalists))
        others = [attempt for attempt in best if attempt.name not in names]
        best = _best_per_name(sorted([*joint, *others], key=lambda a: -a.comparison.gain))
    return best


def _promising_refined(scene: Scene, attempts: list[Attempt], pool: ThreadPoolExecutor) -> list[Attempt]:
    """The attempts, the best first, those fitted that promise a fair part of the best."""
    waiting = sorted(attempts, key=lambda attempt: -attempt.comparison.gain)
    done: list[Attempt] = []
    while waiting:
        best = max((attempt.comparison.gain for attempt in done), default=0.0)
        if waiting[0].comparison.gain <= max(PROMISE, FAIR_PART * best):
            break
        now, waiting = waiting[:WORKERS], waiting[WORKERS:]
        done += [attempt for attempt in pool.map(lambda one: refined(scene, one), now) if attempt is not None]
    return sorted([*done, *waiting], key=lambda attempt: -attempt.comparison.gain)


def _best_per_place(attempts: Sequence[Attempt]) -> list[Attempt]:
    """The best of each name and place: which film, which sensor is settled only with the other effects free."""
    best: dict[tuple[str, str], Attempt] = {}
    for attempt in attempts:
        best.setdefault((attempt.name, attempt.fit.effects[-1].place), attempt)
    return list(best.values())


def _already(name: str, effects: Sequence[Effect]) -> bool:
    return any(effect.name == name and not effect.repeatable for effect in effects)


def _best_per_name(attempts: Sequence[Attempt]) -> list[Attempt]:
    best: dict[str, Attempt] = {}
    for attempt in attempts:
        best.setdefault(attempt.name, attempt)
    return list(best.values())


def _without_idle(problem: Problem, found: Fit, proved: int) -> Fit:
    """The fit without effects that no longer pay once the others are there.

    The last `proved` of them have just paid by themselves; of a pair either may have paid for both.
    """
    if len(found.effects) < 2:
        return found
    blocks = block_numbers(problem)
    errors = left_out_residual(found.residual, found.jacobian, blocks)
    for i in range(len(found.effects) - proved):
        if _cost_of_dropping(problem, found, i, blocks, errors) > CLEARLY_NEEDED:
            continue
        rest = fit(problem, found.effects[:i] + found.effects[i + 1 :], iterations=JOINT_ITERATIONS)
        without = left_out_residual(rest.residual, rest.jacobian, blocks)
        gain = compare_left_out(without, errors, blocks, least_gain(problem, without, errors))
        if not gain.pays:
            return _without_idle(problem, fit(problem, rest.effects, iterations=JOINT_ITERATIONS), proved)
    return found


def _cost_of_dropping(problem: Problem, found: Fit, index: int, blocks: IntegerArray, errors: FloatArray) -> float:
    """Gain that the effect brings over a model without it, the others moved by one linear step only."""
    rest = found.effects[:index] + found.effects[index + 1 :]
    counts = [len(read_coordinates([effect], problem.plant)) for effect in found.effects]
    start = sum(counts[:index])
    jacobian = np.delete(found.jacobian, slice(start, start + counts[index]), axis=1)
    residual = problem.residual(rest)
    step = np.linalg.lstsq(jacobian, residual, rcond=1e-10)[0]
    without = left_out_residual(residual - jacobian @ step, jacobian, blocks)
    return compare_left_out(without, errors, blocks, LEAST_GAIN).gain
