"""One round of the search: every candidate started, the promising fitted, the best few fitted with what was found."""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor

from feeddrive.diagnosis.finding.attempt import PROMISE, Attempt, refined, started, together
from feeddrive.diagnosis.finding.materiality import is_material
from feeddrive.diagnosis.finding.pairs import linear_pair
from feeddrive.diagnosis.finding.scene import Scene
from feeddrive.diagnosis.likelihood.coordinates import read_coordinates
from feeddrive.diagnosis.likelihood.cross_validation import LEAST_GAIN, compare_left_out
from feeddrive.diagnosis.likelihood.fit import Fit, Problem
from feeddrive.diagnosis.likelihood.folds import block_numbers
from feeddrive.effects.base import Effect

FINALISTS = 3
"""Candidates of a round that are refitted together with what was found before."""

FAIR_PART = 0.3
"""Gain over that of the best fitted candidate, from which a candidate is fitted too: starts are near by design (orders
from a periodogram, velocities and stiffnesses scanned), so that one linear step shows most of an effect's worth."""

TIE = 0.05
"""Share of the squared error by which a simpler candidate may be worse, if the difference is not significant."""

WORKERS = 2
"""Candidates tried at the same time; the loop over samples runs outside Python's lock."""


def simplest_of_the_best(attempts: Sequence[Attempt], found: Fit) -> Attempt | None:
    """The best attempt, or one with fewer parameters that cannot be told from it; None if the best does not pay.

    What is too small to matter is not taken. Where it is clearly the best, others must pay beside it: they may only
    imitate it.

    Args:
        attempts: of one round, the best first.
        found: what the round began with.
    """
    paying = [a for a in attempts if a.comparison.pays]  # a larger gain by chance does not hide a smaller sure one
    able = [a for a in paying if _is_material(a)]
    if paying and not _is_material(paying[0]):
        able = [a for a in able if _ties(a, paying[0]) or _adds(a, paying[0], found)]
    if not able:
        return None
    tied = [a for a in able if a is able[0] or _ties(a, able[0])]
    return min(tied, key=lambda a: len(read_coordinates(a.fit.effects[-1:], a.problem.plant)))


def _ties(other: Attempt, best: Attempt) -> bool:
    """Whether the other cannot be told from the best."""
    if len(other.errors) != len(best.errors):
        return False
    better = compare_left_out(other.errors, best.errors, block_numbers(best.problem), LEAST_GAIN)
    return better.gain < max(LEAST_GAIN, min(2 * better.standard_error, TIE))


def _is_material(attempt: Attempt) -> bool:
    return is_material(attempt.fit.effects[-1], attempt.problem.plant)


def _adds(attempt: Attempt, other: Attempt, found: Fit) -> bool:
    """Whether an attempt pays beside another, both moved by one linear step."""
    if not len(attempt.fit.residual) == len(other.fit.residual) == len(found.residual):
        return True  # one of them cannot be predicted everywhere: not compared
    both = linear_pair(other, attempt, found)
    return both.gain - other.comparison.gain > both.least


def one_round(scene: Scene, found: Fit, impossible: dict[str, str]) -> list[Attempt]:
    """All candidates of one round, the best first."""
    ready = []
    for candidate in scene.problem.predictor.candidates:
        if _already(candidate.name, found.effects):
            continue
        reason = _calibrated(scene.problem, candidate.name) or candidate.needs(scene)
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


def _calibrated(problem: Problem, name: str) -> str:
    """Why an effect is not tried that only says that declared values are other: they are fitted in every set."""
    known = problem.calibration
    words = [one.words for one in known.values if one.name == name] if known is not None else []
    return (
        f"{' and '.join(words)}: fitted within the tolerance of the declared value, and named beyond it"
        if words
        else ""
    )


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
