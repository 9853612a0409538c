"""One round of the search: every candidate started, and the promising fitted while what was found stays."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

from feeddrive.diagnosis.finding.attempt import PROMISE, Attempt, refined, started
from feeddrive.diagnosis.finding.members import Member, member
from feeddrive.diagnosis.finding.scene import Candidate, Scene
from feeddrive.diagnosis.finding.too_small import with_what_matters
from feeddrive.diagnosis.likelihood.cross_validation import LEAST_GAIN
from feeddrive.diagnosis.likelihood.fit import Fit
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.likelihood.standing import same_samples
from feeddrive.effects.base import Effect

FAIR_PART = 0.3
"""Gain over that of the best fitted candidate, from which a candidate is fitted too: starts are near by design (orders
from a periodogram, velocities and stiffnesses scanned), so that one linear step shows most of an effect's worth."""

AT_ONCE = 2
"""Candidates fitted before the best of them is asked which others are worth it; the same for any number of workers."""

WORKERS = 2
"""Candidates tried at the same time; the loop over samples runs outside Python's lock."""


@dataclass(frozen=True)
class Round:
    """What may be added to a set, the best first, and how many candidates and starts were tried for it."""

    attempts: tuple[Attempt, ...]
    count: int


def one_round(
    scene: Scene, found: Fit, impossible: dict[str, str], denied: Mapping[str, str], number: int = 1
) -> Round:
    """All candidates but those denied, each fitted as far as it promises; why others are impossible is noted."""
    budget = scene.problem.budget

    def begun(candidate: Candidate) -> list[Attempt]:
        left_out = budget.skips(f"in round {number} of the search", candidate.name)
        return [] if left_out else started(scene, candidate)

    ready = []
    for candidate in scene.problem.predictor.candidates:
        if candidate.name in denied or _already(candidate.name, found.effects):
            continue
        reason = _calibrated(scene.problem, candidate.name) or candidate.needs(scene)
        if reason:
            impossible[candidate.name] = reason
        else:
            impossible.pop(candidate.name, None)  # beside another set it may have been
            ready.append(candidate)
    with ThreadPoolExecutor(WORKERS) as pool:
        groups = list(pool.map(begun, ready))
        begun_with = with_what_matters(scene.problem, found, [attempt for group in groups for attempt in group])
        attempts = _promising_refined(scene, found, begun_with, pool)
    return Round(tuple(_best_per_place(attempts)), max(2, sum(attempt.starts for attempt in attempts)))


def _calibrated(problem: Problem, name: str) -> str:
    """Why an effect is not tried that only says that declared values are other: they are fitted in every set."""
    known = problem.calibration
    words = [one.words for one in known.values if one.name == name] if known is not None else []
    return (
        f"{' and '.join(words)}: fitted within the tolerance of the declared value, and named beyond it"
        if words
        else ""
    )


def _promising_refined(scene: Scene, found: Fit, attempts: list[Attempt], pool: ThreadPoolExecutor) -> list[Attempt]:
    """The attempts, the best first, those fitted that promise a fair part of the best."""
    most = max((_taken(scene, found, attempt) for attempt in attempts if attempt.matters), default=0.0)
    waiting = sorted(attempts, key=lambda one: (not one.matters, -_promise(scene, found, one, most)))
    done: list[Attempt] = []
    while waiting and not scene.problem.budget.is_spent:
        best = max((attempt.comparison.gain for attempt in done), default=0.0)
        if not waiting[0].matters or _promise(scene, found, waiting[0], most) <= max(PROMISE, FAIR_PART * best):
            break
        now, waiting = waiting[:AT_ONCE], waiting[AT_ONCE:]
        done += [attempt for attempt in pool.map(lambda one: refined(scene, one), now) if attempt is not None]
    return sorted([*done, *waiting], key=lambda attempt: -attempt.comparison.gain)


def _promise(scene: Scene, found: Fit, attempt: Attempt, most: float) -> float:
    """What an attempt brings on blocks left out, or by its step where that is a fair part of what any takes.

    A step is as far off as its law bends: a place that is passed at a few speeds is then met, and a block left out not;
    a stiffness that falls over the stroke moves a resonance, and beside a first step of a third of the way stood a lead
    error that was none.
    """
    gain = attempt.comparison.gain
    taken = _taken(scene, found, attempt)
    return taken if gain <= PROMISE and taken > max(LEAST_GAIN, FAIR_PART * most) else gain


def _taken(scene: Scene, found: Fit, attempt: Attempt) -> float:
    """Share of the squared error that an attempt takes where it is fitted; none where it declines some samples."""
    if not found.squared_error > 0 or not same_samples(attempt.problem, scene.problem):
        return 0.0
    return 1.0 - attempt.fit.squared_error / found.squared_error


def _best_per_place(attempts: Sequence[Attempt]) -> list[Attempt]:
    """The best of each name, port and place: which film or shaft it is shows only with the other effects free."""
    best: dict[Member, Attempt] = {}
    for attempt in attempts:
        effect = attempt.fit.effects[-1]
        best.setdefault(member(effect), attempt)
    return list(best.values())


def _already(name: str, effects: Sequence[Effect]) -> bool:
    return any(effect.name == name and not effect.repeatable for effect in effects)
