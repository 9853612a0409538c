"""Which of two effects that can stand in each other's place is named.

The search takes the best of a round; once all effects are in, another can be more likely, or as likely and simpler.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from feeddrive.diagnosis.certainty.ambiguity import AGAINST, SAME_ERROR, Rival
from feeddrive.diagnosis.finding.materiality import is_material_here
from feeddrive.diagnosis.finding.search import Search
from feeddrive.diagnosis.judging.judge import Judged, judged_residual
from feeddrive.diagnosis.likelihood.coordinates import at_its_limit, read_coordinates
from feeddrive.diagnosis.likelihood.cross_validation import SCATTER, compare_left_out
from feeddrive.diagnosis.likelihood.fit import fit
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.recordings.recordings import is_shift
from feeddrive.effects.base import Effect
from feeddrive.plant.plant import Plant
from feeddrive.typing import FloatArray, IntegerArray


def with_the_preferred(found: Search, rivals: Sequence[list[Rival]]) -> tuple[Search, list[list[Rival]]]:
    """The search and its rivals with the first effect replaced that has a rival to be preferred; else the same.

    Args:
        found: what the search took.
        rivals: per effect those that do as well in its place, see `rivals_of`.
    """
    if any(is_shift(effect) for effect in found.fit.effects):
        return found, list(rivals)  # what one recording has otherwise belongs to the effect taken
    for place, alike in enumerate(rivals):
        taken = _preferred(found.problem, found.fit.effects[place], alike)
        if taken is not None:
            ousted = Rival(place, found.fit, -taken.odds, taken.distance, 1 / taken.error_ratio, found.problem)
            others = [replace(rival, odds=rival.odds - taken.odds) for rival in alike if rival is not taken]
            rest = [rival for rival in (ousted, *others) if rival.as_good and not at_its_limit(rival.effect)]
            refitted = fit(taken.problem, taken.fit.effects)
            return replace(found, problem=taken.problem, fit=refitted), [*rivals[:place], rest, *rivals[place + 1 :]]
    return found, list(rivals)


def judged_apart(problem: Problem, taken: Sequence[Judged], other: Sequence[Judged]) -> bool:
    """Whether data not fitted speak for what was taken and against what would take its place, beyond their scatter.

    Args:
        problem: of what was taken.
        taken, other: the same recordings, with the one and with the other in.
    """
    mine, its, blocks = _residuals(problem, taken, other)
    gain = compare_left_out(its, mine, blocks, 0.0)
    return gain.gain > SCATTER * gain.standard_error


def judged_as_good(problem: Problem, taken: Sequence[Judged], other: Sequence[Judged]) -> bool:
    """Whether what would take a place leaves the same error on data not fitted, as a rival must (`SAME_ERROR`).

    Args:
        problem: of what was taken.
        taken, other: the same recordings, with the one and with the other in, each fitted to its end.
    """
    mine, its, _ = _residuals(problem, taken, other)
    return float(its @ its) <= SAME_ERROR**2 * float(mine @ mine)


def _residuals(
    problem: Problem, taken: Sequence[Judged], other: Sequence[Judged]
) -> tuple[FloatArray, FloatArray, IntegerArray]:
    """Judged residuals of what was taken and of another, (m,) each, and their blocks, on the samples of the first.

    A free play would leave the two with different ones.
    """
    mine, blocks = judged_residual(problem, [(one.after, one.evidence) for one in taken])
    its, _ = judged_residual(problem, [(two.after, one.evidence) for one, two in zip(taken, other, strict=True)])
    return mine, its, blocks


def _preferred(problem: Problem, effect: Effect, alike: Sequence[Rival]) -> Rival | None:
    """The rival for which the data speak by as much as refuses one, else the simplest that is simpler.

    None goes first for which fitted data speak while those that are not fitted are met worse.
    """
    borne_out = [rival for rival in alike if rival.odds >= -AGAINST or rival.error_ratio <= 1]
    material = [rival for rival in borne_out if is_material_here(rival.effect, problem)]
    likeliest = min(material, key=lambda rival: rival.odds, default=None)
    if likeliest is not None and likeliest.odds < -AGAINST:
        return likeliest
    own = _simplicity(effect, problem.plant)
    simpler = [rival for rival in material if _simplicity(rival.effect, problem.plant) < own]
    return min(simpler, key=lambda rival: _simplicity(rival.effect, problem.plant), default=None)


def _simplicity(effect: Effect, plant: Plant) -> tuple[int, bool]:
    """What comes first in a tie: fewest parameters, and none at an end of its range."""
    return len(read_coordinates([effect], plant)), at_its_limit(effect)
