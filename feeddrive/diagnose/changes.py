"""What changed between recordings: parameters that must differ by recording for the blocks left out to be met.

The reference has every fitted parameter and every level in common. One parameter after the other is set free in the
recordings asked about: ranked by one linear step (`change_offers`), fitted, and taken if it pays by the rule of the
search, more strictly by the number that was tried. Levels that did not differ are then taken out, and what no longer
pays or is too small to matter is put back.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from scipy.stats import norm

from feeddrive.diagnose.change_candidates import Movable, levels, movables
from feeddrive.diagnose.change_offers import Offer, offers
from feeddrive.diagnose.change_values import material_difference
from feeddrive.diagnose.cross_validation import (
    Comparison,
    block_numbers,
    compare_left_out,
    least_gain,
    left_out_residual,
)
from feeddrive.diagnose.fit import Fit, Problem, fit
from feeddrive.diagnose.recordings import RecordingShift, Target, is_shift
from feeddrive.effects.base import Effect
from feeddrive.thermal.plant import ThermalPlant

FALSE_ALARMS = 0.05
"""Chance of one false change in a whole diagnosis, shared out among all parameters that are tried."""

REFERENCE_STEPS, JOINT_STEPS = 8, 10
"""Steps of the fit with everything in common, and of the fit with what differs."""

OFFERS = 2
"""Parameters that are fitted before the recordings are said to share the rest."""

MOST_CHANGES = 6
"""Parameters that may differ; a machine on which more did is another machine."""


@dataclass(frozen=True)
class ChangeTrial:
    """One parameter set free by recording: what it brings on blocks left out, and whether it was taken."""

    target: Target
    parameter: str
    comparison: Comparison
    taken: bool
    reason: str


@dataclass(frozen=True)
class Changes:
    """The fit with what differs by recording.

    Attributes:
        fit: effects of the machine, then the shifts of what differs.
        targets: what differs, in the order found.
        trials: all that was tried.
    """

    fit: Fit
    targets: tuple[Target, ...]
    trials: tuple[ChangeTrial, ...]


def find_changes(problem: Problem, effects: Sequence[Effect], recordings: Sequence[int]) -> Changes:
    """Find the parameters that differ in some recordings.

    Args:
        problem: recordings, with a predictor that knows their numbers.
        effects: found, with the shifts that are known already.
        recordings: numbers of those that may differ; the others share their values.

    Returns:
        The fit of the effects as they are given, followed by levels and shifts that pay.
    """
    common = fit(problem, effects, iterations=REFERENCE_STEPS)
    if not recordings:
        return Changes(common, (), ())
    ranked: dict[Target, Offer] = {}
    current, kept = _forward(problem, common, recordings, ranked)
    while kept:
        worst = _worst(problem, current, kept, recordings, len(ranked))
        if worst is None:
            return Changes(_machine_first(problem, current), tuple(kept), _trials(ranked, kept))
        kept = [target for target in kept if target is not worst]
        current = _without(problem, common, current, worst, recordings)
    return Changes(common, (), _trials(ranked, ()))


def _forward(
    problem: Problem, common: Fit, recordings: Sequence[int], ranked: dict[Target, Offer]
) -> tuple[Fit, list[Target]]:
    """Parameters that pay when set free, the likeliest first; what each brings is noted in `ranked`."""
    taken: list[Target] = []
    current = common
    while len(taken) < MOST_CHANGES:
        neutral = levels(problem, current.effects)
        at_rest = fit(problem, [*current.effects, *neutral], iterations=0)
        free = [one for one in movables(at_rest.effects, problem) if one.target not in taken]
        offered = offers(problem, at_rest, free, recordings)
        for one, comparison in offered:
            if one.target not in ranked or comparison.gain > ranked[one.target][1].gain:
                ranked[one.target] = one, comparison
        likely = [one for one, c in offered if c.gain > max(c.least, c.standard_error)]
        for one in likely[:OFFERS]:
            wider, comparison = _set_free(problem, current, at_rest.effects[one.effect], one, recordings)
            ranked[one.target] = one, comparison
            if _pays(comparison, len(free) + len(taken)) and _material(problem, wider, one.target, recordings):
                taken.append(one.target)
                current = wider
                break
        else:
            break
    return current, taken


def _set_free(
    problem: Problem, current: Fit, effect: Effect, one: Movable, recordings: Sequence[int]
) -> tuple[Fit, Comparison]:
    """The fit with one parameter free by recording, beside the one that has it in common."""
    shared = current
    if effect not in current.effects:
        shared = fit(problem, [*current.effects, effect], iterations=JOINT_STEPS)
    shifts = one.shifts(recordings, isinstance(problem.plant, ThermalPlant))
    wider = fit(problem, [*shared.effects, *shifts], iterations=JOINT_STEPS)
    return wider, _comparison(problem, shared, wider)


def _machine_first(problem: Problem, fitted: Fit) -> Fit:
    """The same fit with the shifts at the end."""
    machine = [effect for effect in fitted.effects if not is_shift(effect)]
    shifts = [effect for effect in fitted.effects if is_shift(effect)]
    return fit(problem, [*machine, *shifts], iterations=REFERENCE_STEPS)


def _without(problem: Problem, common: Fit, current: Fit, target: Target, recordings: Sequence[int]) -> Fit:
    """The fit with one parameter in common again; a level that was not there before goes with its shifts."""
    kept = [effect for effect in current.effects if not _of(effect, target, recordings)]
    moved = [effect.target for effect in kept if isinstance(effect, RecordingShift)]
    before = [one for one in common.effects if not is_shift(one)]
    places = {(one.name, one.port, one.place) for one in before} | {(t.name, t.port, t.place) for t in moved}
    kept = [effect for effect in kept if is_shift(effect) or (effect.name, effect.port, effect.place) in places]
    return fit(problem, kept, iterations=JOINT_STEPS)


def _comparison(problem: Problem, without: Fit, having: Fit) -> Comparison:
    blocks = block_numbers(problem)
    before = left_out_residual(without.residual, without.jacobian, blocks)
    after = left_out_residual(having.residual, having.jacobian, blocks)
    return compare_left_out(before, after, blocks, least_gain(problem, before))


def _material(problem: Problem, shifted: Fit, target: Target, recordings: Sequence[int]) -> bool:
    return any(material_difference(problem, shifted.effects, target, number) for number in recordings)


def _pays(comparison: Comparison, tried: int) -> bool:
    """The rule of the search, its scatter as many times as so many tries ask for."""
    times = float(norm.ppf(1 - FALSE_ALARMS / max(tried, 1)))
    return comparison.pays and comparison.gain > times * comparison.standard_error


def _worst(
    problem: Problem, shifted: Fit, kept: Sequence[Target], recordings: Sequence[int], tried: int
) -> Target | None:
    """The change that is immaterial, or that pays least and not enough; None where all are to stay."""
    for target in kept:
        if not _material(problem, shifted, target, recordings):
            return target
    if len(kept) == 1:
        return None  # it was compared when it was taken
    compared = []
    for target in kept:
        # what is left out keeps its level in common, so that only the difference is judged
        removed = [effect for effect in shifted.effects if not _of(effect, target, recordings)]
        compared.append((_comparison(problem, fit(problem, removed, iterations=JOINT_STEPS), shifted), target))
    comparison, target = min(compared, key=lambda pair: pair[0].gain)
    return None if _pays(comparison, tried) else target


def _of(effect: Effect, target: Target, recordings: Sequence[int]) -> bool:
    return isinstance(effect, RecordingShift) and effect.target == target and effect.recording in recordings


def _trials(ranked: dict[Target, Offer], kept: Sequence[Target]) -> tuple[ChangeTrial, ...]:
    result = []
    for target, (one, comparison) in ranked.items():
        taken = target in kept
        reason = "it must differ for blocks left out to be met" if taken else _why_common(comparison)
        result.append(ChangeTrial(target, one.parameter, comparison, taken, reason))
    return tuple(sorted(result, key=lambda trial: -trial.comparison.gain))


def _why_common(comparison: Comparison) -> str:
    if comparison.gain <= 0:
        return "a value of its own in every recording does not lower the error on blocks left out"
    scatter = f"{comparison.standard_error:.2%} scatter"
    return f"a value of its own lowers the squared error by {comparison.gain:.2%} ({scatter}), or others say it better"
