"""The search: add the effect that lowers the error on data not fitted the most, until none pays; then drop what does not.

Every round starts each candidate from values read off the residual, refines it on all channels, and compares it by
blocked cross-validation. The best few are refitted together with what was found before.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace

import numpy as np

from feeddrive.diagnose.candidates import CANDIDATES, Candidate, Scene, scene_of
from feeddrive.diagnose.cross_validation import LEAST_GAIN, Comparison, block_errors, block_numbers, compare
from feeddrive.diagnose.coordinates import read_coordinates
from feeddrive.diagnose.fit import Fit, Problem, fit
from feeddrive.diagnose.predictability import predictable_samples
from feeddrive.diagnose.result import Trial
from feeddrive.effects.base import Effect, TransmissionEffect
from feeddrive.effects.catalogue import EFFECTS
from feeddrive.errors import InputError
from feeddrive.typing import FloatArray

MOST_EFFECTS = 8
"""Rounds at most; an axis that lacks more needs another declaration."""

FINALISTS = 3
"""Candidates of a round that are refitted together with what was found before."""

TIE = 0.05
"""Share of the squared error by which a simpler candidate may be worse, if the difference is not significant."""

SUPERADDITIVE = 1.5
"""Gain of two effects together over the sum of their gains alone, from which they are said to hide each other."""

PAIRS_FITTED = 2
"""Pairs of effects that mask each other, fitted where they promise more than the best single one."""

JOINT_ITERATIONS = 4
"""Steps of a joint fit inside the search; what is left is polished at its end."""

CLEARLY_NEEDED = 0.1
"""Share of the squared error that an effect must bring, by one linear step, not to be refitted without it."""

FIT_ITERATIONS = 12
"""Steps of a candidate's fit at most."""

PROMISE = 0.001
"""Share of the squared error that the first step of a fit must take away for the fit to go on."""

HOPELESS_ITERATIONS = 3
"""Steps for a candidate none of whose scanned starts is better than nothing."""

WORKERS = 2
"""Candidates tried at the same time; the loop over samples runs outside Python's lock."""


@dataclass(frozen=True)
class Attempt:
    """A candidate refined in one round, against the same recordings without it.

    Attributes:
        name: effect name.
        fit: of all free effects.
        comparison: against the effects found before.
        problem: recordings with the samples that this candidate can predict.
        errors: squared error per block, left out of the fit, shape (blocks,).
    """

    name: str
    fit: Fit
    comparison: Comparison
    problem: Problem
    errors: FloatArray


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

    Args:
        problem: declared plant and recordings.
        said: told what is going on, for a progress display.

    Returns:
        The effects found, fitted together, and the ledger of the search.
    """
    found = fit(problem, ())
    trials: list[Trial] = []
    rounds: list[tuple[Attempt, ...]] = []
    impossible: dict[str, str] = {}
    while len(rounds) < MOST_EFFECTS:
        said(f"round {len(rounds) + 1}: {len(found.effects)} effects so far")
        scene = scene_of(problem, found.effects)
        attempts = _round(scene, found, impossible)
        rounds.append(tuple(attempts))
        winner = _simplest_of_the_best(attempts)
        pair = _masked_pair(attempts, found, winner)
        if pair is not None:
            winner, attempts = pair, [pair, *attempts]
        trials += [_trial(len(rounds), attempt, attempt is winner) for attempt in attempts]
        if winner is None:
            break
        count = len(found.effects)
        problem, found = winner.problem, _without_idle(winner.problem, winner.fit)
        said(f"found so far: {', '.join(effect.name for effect in found.effects)}")
        if len(found.effects) <= count:  # the new one only took the place of an old one
            break
    found = fit(problem, found.effects)
    return Search(problem, found, tuple(trials), tuple(rounds), impossible)


def _simplest_of_the_best(attempts: Sequence[Attempt]) -> Attempt | None:
    """The best attempt, or one with fewer parameters that cannot be told from it; None if the best does not pay."""
    if not attempts or not attempts[0].comparison.pays:
        return None
    best = attempts[0]
    tied = [best]
    for other in attempts[1:]:
        if other.comparison.pays and len(other.errors) == len(best.errors):
            better = compare(other.errors, best.errors)
            if better.gain < max(LEAST_GAIN, min(2 * better.standard_error, TIE)):
                tied.append(other)
    return min(tied, key=lambda a: len(read_coordinates(a.fit.effects[-1:], a.problem.plant)))


def _masked_pair(attempts: Sequence[Attempt], found: Fit, winner: Attempt | None) -> Attempt | None:
    """Two candidates that hide each other, as a rise with speed hides a drop of the level: together worth much more.

    Much more than the best single one, and than the sum of what they are worth alone. Pairs are ranked by one linear step from the Jacobians at hand, at no simulation; the best are fitted.
    """
    least = winner.comparison.gain if winner is not None else 0.0
    usable = [a for a in attempts if a.comparison.gain > -0.1 and len(a.fit.effects) == len(found.effects) + 1]
    ranked = []
    for i, first in enumerate(usable):
        for second in usable[i + 1 :]:
            linear = _linear_pair(first, second, found)
            alone = max(first.comparison.gain, 0.0) + max(second.comparison.gain, 0.0)
            if linear is not None and linear.pays and linear.gain > max(SUPERADDITIVE * alone, least):
                ranked.append((linear.gain, first, second))
    ranked.sort(key=lambda entry: -entry[0])
    for _, first, second in ranked[:PAIRS_FITTED]:
        problem = first.problem
        try:
            result = fit(problem, (*found.effects, first.fit.effects[-1], second.fit.effects[-1]))
        except InputError:
            continue
        pair = _attempt(problem, f"{first.name} with {second.name}", result, found.effects)
        if pair.comparison.pays and pair.comparison.gain > least:
            return pair
    return None


def _linear_pair(first: Attempt, second: Attempt, found: Fit) -> Comparison | None:
    """Gain of both candidates together by one linear step; None where they count other samples."""
    rows = {len(part.residual) for part in (first.fit, second.fit, found)}
    if len(rows) != 1:
        return None
    columns = _own_columns(first), _own_columns(second)
    jacobian = np.hstack([found.jacobian, *columns])
    blocks = block_numbers(first.problem)
    step = np.linalg.lstsq(jacobian, first.fit.residual, rcond=1e-10)[0]
    together = block_errors(first.fit.residual - jacobian @ step, jacobian, blocks)
    return compare(block_errors(found.residual, found.jacobian, blocks), together)


def _own_columns(attempt: Attempt) -> FloatArray:
    """Columns of the Jacobian that belong to the candidate itself."""
    own = len(read_coordinates(attempt.fit.effects[-1:], attempt.problem.plant))
    return attempt.fit.jacobian[:, attempt.fit.jacobian.shape[1] - own :]


def _trial(number: int, attempt: Attempt, taken: bool) -> Trial:
    return Trial(number, attempt.name, attempt.comparison.gain, attempt.comparison.standard_error, taken)


def _round(scene: Scene, found: Fit, impossible: dict[str, str]) -> list[Attempt]:
    """All candidates of one round, the best first."""
    ready = []
    for candidate in CANDIDATES:
        if _already(candidate.name, found.effects):
            continue
        reason = candidate.needs(scene)
        if reason:
            impossible[candidate.name] = reason
        else:
            ready.append(candidate)
    with ThreadPoolExecutor(WORKERS) as pool:
        groups = pool.map(lambda candidate: _alone(scene, candidate), ready)
        alone = [attempt for group in groups for attempt in group]
        alone.sort(key=lambda attempt: attempt.comparison.gain, reverse=True)
        best = _best_per_name(alone)
        if found.effects:
            finalists = [attempt for attempt in best[:FINALISTS] if attempt.comparison.gain > 0]
            joint = list(pool.map(lambda attempt: _together(attempt, found), finalists))
            best = _best_per_name(sorted([*joint, *best[len(finalists) :]], key=lambda a: -a.comparison.gain))
    return best


def _already(name: str, effects: Sequence[Effect]) -> bool:
    return any(effect.name == name for effect in effects) and not EFFECTS[name].repeatable


def _best_per_name(attempts: Sequence[Attempt]) -> list[Attempt]:
    best: dict[str, Attempt] = {}
    for attempt in attempts:
        best.setdefault(attempt.name, attempt)
    return list(best.values())


def _alone(scene: Scene, candidate: Candidate) -> list[Attempt]:
    """Each form of a candidate, refined while what was found before stays as it is."""
    attempts: list[Attempt] = []
    for starts in candidate.forms(scene):
        if candidate.scanned and attempts and attempts[0].comparison.gain < LEAST_GAIN:
            break  # another form of a law that does not pay at all is not worth its simulations
        try:
            attempts.append(_refined(scene, candidate, starts))
        except InputError:  # cannot act together with what was found, or cannot be simulated
            continue
    return attempts


def _refined(scene: Scene, candidate: Candidate, starts: Sequence[Effect]) -> Attempt:
    """The best start of one form, refined unless not even its first step promises anything."""
    name, before = candidate.name, scene.found
    frozen = [False] * len(before)
    jumps = isinstance(starts[0], TransmissionEffect)
    problem = with_predictable(scene.problem, (*before, starts[0])) if jumps else scene.problem
    base = fit(problem, before, frozen, iterations=0).squared_error
    free = [*frozen, True]
    tried = [fit(problem, (*before, start), free, 0, error_only=candidate.scanned) for start in starts]
    if not candidate.scanned:
        tried = [_one_linear_step(attempt) for attempt in tried]
    result = min(tried, key=lambda attempt: attempt.squared_error)
    promising = result.squared_error < (1 - PROMISE) * base
    if promising or candidate.scanned:
        steps = FIT_ITERATIONS if promising else HOPELESS_ITERATIONS
        result = fit(problem, result.effects, free, steps)
    if not (np.isfinite(result.squared_error) and np.all(np.isfinite(result.jacobian))):
        raise InputError(f"{name} could not be simulated", name)
    if jumps:
        problem = with_predictable(scene.problem, result.effects)
    return _attempt(problem, name, result, before)


def _one_linear_step(fitted: Fit) -> Fit:
    """The fit as one linear step would leave it, the values as they were; ranks starts at no simulation."""
    if not np.all(np.isfinite(fitted.jacobian)):
        return fitted
    step = np.linalg.lstsq(fitted.jacobian, fitted.residual, rcond=1e-10)[0]
    return replace(fitted, residual=fitted.residual - fitted.jacobian @ step)


def _together(attempt: Attempt, found: Fit) -> Attempt:
    result = fit(attempt.problem, attempt.fit.effects, iterations=JOINT_ITERATIONS)
    return _attempt(attempt.problem, attempt.name, result, found.effects)


def _attempt(problem: Problem, name: str, result: Fit, before: Sequence[Effect]) -> Attempt:
    """Compare a fit with the effects before it, both on the same samples and both with their own effects free."""
    blocks = block_numbers(problem)
    if len(blocks) != len(result.residual):
        result = fit(problem, result.effects, _free(result, before), iterations=0)
    reference = _reference(problem, before, result)
    without = block_errors(reference.residual, reference.jacobian, blocks)
    errors = block_errors(result.residual, result.jacobian, blocks)
    return Attempt(name, result, compare(without, errors), problem, errors)


def _free(result: Fit, before: Sequence[Effect]) -> list[bool]:
    """Which effects a fit had free: the last alone, or all."""
    joint = result.effects[: len(before)] != tuple(before)
    return [joint] * len(before) + [True] * (len(result.effects) - len(before))


def _reference(problem: Problem, before: Sequence[Effect], result: Fit) -> Fit:
    joint = result.effects[: len(before)] != tuple(before)
    return fit(problem, before, [joint] * len(before), iterations=0)


def with_predictable(problem: Problem, effects: Sequence[Effect]) -> Problem:
    """The problem without the samples that a plant with these effects cannot predict."""
    plant = problem.plant.with_effects(*effects)
    kept = tuple(e.where_predictable(predictable_samples(plant, e)) for e in problem.evidence)
    if any(not e.fit_rows.any() for e in kept):
        return problem
    return replace(problem, evidence=kept)


def _without_idle(problem: Problem, found: Fit) -> Fit:
    """The fit without effects that no longer pay once the others are there."""
    if len(found.effects) < 2:
        return found
    blocks = block_numbers(problem)
    errors = block_errors(found.residual, found.jacobian, blocks)
    for i in range(len(found.effects) - 1):
        if _cost_of_dropping(problem, found, i, blocks, errors) > CLEARLY_NEEDED:
            continue
        rest = fit(problem, found.effects[:i] + found.effects[i + 1 :], iterations=JOINT_ITERATIONS)
        gain = compare(block_errors(rest.residual, rest.jacobian, blocks), errors)
        if not gain.pays:
            return _without_idle(problem, fit(problem, rest.effects, iterations=JOINT_ITERATIONS))
    return found


def _cost_of_dropping(problem: Problem, found: Fit, index: int, blocks: FloatArray, errors: FloatArray) -> float:
    """Gain that the effect brings over a model without it, the others moved by one linear step only."""
    rest = found.effects[:index] + found.effects[index + 1 :]
    counts = [len(read_coordinates([effect], problem.plant)) for effect in found.effects]
    start = sum(counts[:index])
    jacobian = np.delete(found.jacobian, slice(start, start + counts[index]), axis=1)
    residual = problem.residual(rest)
    step = np.linalg.lstsq(jacobian, residual, rcond=1e-10)[0]
    return compare(block_errors(residual - jacobian @ step, jacobian, blocks), errors).gain
