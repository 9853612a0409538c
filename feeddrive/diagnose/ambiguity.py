"""Effects that cannot be told apart: a rival in an effect's place, with the same error on data not fitted."""

from __future__ import annotations

from collections.abc import Sequence

from feeddrive.diagnose.attempt import Attempt
from feeddrive.diagnose.cross_validation import LEAST_GAIN, block_numbers, compare_left_out, left_out_residual
from feeddrive.diagnose.fit import Fit, Problem, fit
from feeddrive.diagnose.judge import Judged, squared_blocks
from feeddrive.diagnose.search import Search
from feeddrive.effects.base import Effect

SAME_ERROR = 1.05
"""Ratio of validation errors (rms) within which two effects count as the same."""

LARGEST_SET = 3
"""Names in an ambiguous set."""


def ambiguous_sets(search: Search, judged: Sequence[Judged]) -> tuple[tuple[str, ...], ...]:
    """Sets of names that explain the same.

    Args:
        search: with what was found and tried.
        judged: recordings with the found effects in.

    Returns:
        Sets of at most three names, the found one first.
    """
    sets = []
    for index, effect in enumerate(search.fit.effects):
        names = [effect.name]
        for rival in _rivals(search, effect):
            if rival.name not in names and _explains_the_same(search, judged, index, rival):
                names.append(rival.name)
        if len(names) > 1:
            sets.append(tuple(names[:LARGEST_SET]))
    return tuple(sets)


def _rivals(search: Search, effect: Effect) -> list[Attempt]:
    """Candidates that came near when the effect was taken, and those that its signature names."""
    for number, attempts in enumerate(search.rounds):
        taken = next((t for t in search.trials if t.round == number + 1 and t.taken), None)
        if taken is None or effect.name not in taken.name.split(" with "):
            continue
        others = [a for a in attempts if a.name != effect.name and a.comparison.pays]
        near = [a for a in others if a.comparison.gain > 0.5 * taken.gain or a.name in effect.signature.confused_with]
        found = {e.name for e in search.fit.effects}
        return [a for a in near if a.name not in found or a.fit.effects[-1].repeatable]
    return []


def _explains_the_same(search: Search, judged: Sequence[Judged], index: int, rival: Attempt) -> bool:
    """Whether the rival does as well: the same on blocks left out, and within 5 % on the judged data."""
    problem, found = search.problem, search.fit
    effects = [*found.effects[:index], rival.fit.effects[-1], *found.effects[index + 1 :]]
    swapped = fit(problem, effects, iterations=4)
    if not _as_good(problem, found, swapped):
        return False
    plant = problem.plant.with_effects(*swapped.effects)
    mine = squared_blocks(problem, [(j.after, j.evidence) for j in judged]).sum()
    its = squared_blocks(problem, [(plant, j.evidence) for j in judged]).sum()
    return bool(its <= SAME_ERROR**2 * mine)


def _as_good(problem: Problem, found: Fit, swapped: Fit) -> bool:
    blocks = block_numbers(problem)
    its = left_out_residual(swapped.residual, swapped.jacobian, blocks)
    mine = left_out_residual(found.residual, found.jacobian, blocks)
    better = compare_left_out(its, mine, blocks, LEAST_GAIN)
    return better.gain < max(LEAST_GAIN, 2 * better.standard_error)
