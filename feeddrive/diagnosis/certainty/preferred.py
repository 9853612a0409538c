"""Which of two effects that can stand in each other's place is named.

The search takes the best of a round; once all effects are in, another can be more likely, or as likely and simpler.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from feeddrive.diagnosis.certainty.ambiguity import AGAINST, Rival
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
    mine, blocks = judged_residual(problem, [(one.after, one.evidence) for one in taken])
    # on the samples of what was taken: a free play would leave the two with different ones
    its, _ = judged_residual(problem, [(two.after, one.evidence) for one, two in zip(taken, other, strict=True)])
    gain = compare_left_out(its, mine, blocks, 0.0)
    return gain.gain > SCATTER * gain.standard_error


def _preferred(problem: Problem, effect: Effect, alike: Sequence[Rival]) -> Rival | None:
    """The rival for which the data speak by as much as refuses one, else the simplest that is simpler."""
    material = [rival for rival in alike if is_material_here(rival.effect, problem)]
    likeliest = min(material, key=lambda rival: rival.odds, default=None)
    if likeliest is not None and likeliest.odds < -AGAINST:
        return likeliest
    own = _simplicity(effect, problem.plant)
    simpler = [rival for rival in material if _simplicity(rival.effect, problem.plant) < own]
    return min(simpler, key=lambda rival: _simplicity(rival.effect, problem.plant), default=None)


def _simplicity(effect: Effect, plant: Plant) -> tuple[int, bool]:
    """What comes first in a tie: fewest parameters, and none at an end of its range."""
    return len(read_coordinates([effect], plant)), at_its_limit(effect)
