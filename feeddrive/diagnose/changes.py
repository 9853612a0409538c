"""What changed between recordings: parameters that must differ by recording for the blocks left out to be met.

The reference has every fitted parameter and every level in common. One parameter after the other is set free in the
recordings asked about; a shift is a column of the Jacobian cut to the rows of its recording, so that all of them are
ranked at no further simulation. The best is taken while it pays by the rules of the search, more strictly by the number
that was tried; then all are fitted together, and what no longer pays or is too small to matter is put back.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.stats import norm

from feeddrive.diagnose.change_candidates import Movable, levels, movables
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
from feeddrive.typing import FloatArray, IntegerArray

FALSE_ALARMS = 0.05
"""Chance of one false change in a whole diagnosis, shared out among all parameters that are tried."""

REFERENCE_STEPS, JOINT_STEPS = 4, 10
"""Steps of the fit with everything in common, and of the fit with what differs."""

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
    known = [effect for effect in effects if is_shift(effect)]
    machine = [effect for effect in effects if not is_shift(effect)]
    neutral = list(levels(problem, machine))
    common = fit(problem, [*machine, *neutral, *known], iterations=REFERENCE_STEPS)
    free = movables(common.effects, problem)
    taken, ranked = _ranked(problem, common, free, recordings)
    if not taken:
        return Changes(fit(problem, effects, iterations=0), (), _trials(ranked, ()))
    kept = taken
    while kept:
        shifted = _fitted(problem, common, len(machine), kept, recordings)
        worst = _worst(problem, common, shifted, len(machine), kept, recordings)
        if worst is None:
            return Changes(shifted, tuple(one.target for one in kept), _trials(ranked, kept))
        kept = [one for one in kept if one is not worst]
    return Changes(fit(problem, effects, iterations=0), (), _trials(ranked, ()))


Ranked = tuple[Movable, Comparison]


def _ranked(
    problem: Problem, common: Fit, free: Sequence[Movable], recordings: Sequence[int]
) -> tuple[list[Movable], list[Ranked]]:
    """Forward selection by linear steps: what was taken, and the best that every parameter promised."""
    blocks, rows = block_numbers(problem), _recording_of_rows(problem)
    jacobian, taken = common.jacobian, list[Movable]()
    best_of: dict[Movable, Comparison] = {}
    while len(taken) < MOST_CHANGES:
        without = _left_out(common.residual, jacobian, blocks)
        least = least_gain(problem, without)
        offers = []
        for one in free:
            if one in taken:
                continue
            wider = np.hstack([jacobian, _columns(common, one, rows, recordings)])
            errors = _left_out(common.residual, wider, blocks)
            comparison = compare_left_out(without, errors, blocks, least)
            offers.append((one, comparison, errors, wider))
            if one not in best_of or comparison.gain > best_of[one].gain:
                best_of[one] = comparison
        paying = [offer for offer in offers if _pays(offer[1], len(free))]
        if not paying:
            break
        chosen = _likeliest(paying, blocks)
        taken.append(chosen[0])
        jacobian = chosen[3]
    return taken, list(best_of.items())


Offer = tuple[Movable, Comparison, FloatArray, FloatArray]


def _likeliest(paying: Sequence[Offer], blocks: IntegerArray) -> Offer:
    """The best offer; a friction level where it cannot be told from the best, since that is what changes first."""
    best = max(paying, key=lambda offer: offer[1].gain)
    for other in sorted(paying, key=lambda offer: -offer[1].gain):
        if other[0].target.name == "friction_deviation":
            better = compare_left_out(other[2], best[2], blocks, 0.0)
            return other if better.gain <= 2 * better.standard_error else best
    return best


def _left_out(residual: FloatArray, jacobian: FloatArray, blocks: IntegerArray) -> FloatArray:
    """Residual on blocks left out, after one linear step."""
    step = np.linalg.lstsq(jacobian, residual, rcond=1e-10)[0] if jacobian.shape[1] else np.zeros(0)
    return left_out_residual(residual - jacobian @ step, jacobian, blocks)


def _columns(common: Fit, one: Movable, rows: IntegerArray, recordings: Sequence[int]) -> FloatArray:
    """Columns of the shifts, each cut to the rows of its recording."""
    parts = common.jacobian[:, list(one.columns)]
    return np.hstack([np.where((rows == number)[:, None], parts, 0.0) for number in recordings])


def _recording_of_rows(problem: Problem) -> IntegerArray:
    """Number of the recording of every row of the residual, (m,)."""
    numbers = problem.predictor.numbers  # type: ignore[attr-defined]
    parts = []
    for evidence in problem.evidence:
        count = int(evidence.thinned(evidence.fit_rows).sum()) * len(evidence.channels)
        parts.append(np.full(count, numbers[id(evidence.recording)]))
    return np.concatenate(parts).astype(np.int64)


def _pays(comparison: Comparison, tried: int) -> bool:
    """The rule of the search, its scatter as many times as so many tries ask for."""
    times = float(norm.ppf(1 - FALSE_ALARMS / max(tried, 1)))
    return comparison.pays and comparison.gain > times * comparison.standard_error


def _fitted(
    problem: Problem, common: Fit, count: int, kept: Sequence[Movable], recordings: Sequence[int]
) -> Fit:  # fmt: skip
    """All fitted together; of the levels only those that differ."""
    thermal = isinstance(problem.plant, ThermalPlant)
    needed = {one.effect for one in kept}
    machine = [
        effect
        for number, effect in enumerate(common.effects)
        if not is_shift(effect) and (number < count or number in needed)
    ]
    known = [effect for effect in common.effects if is_shift(effect)]
    shifts = [shift for one in kept for shift in one.shifts(recordings, thermal)]
    return fit(problem, [*machine, *known, *shifts], iterations=JOINT_STEPS)


def _worst(
    problem: Problem, common: Fit, shifted: Fit, count: int, kept: Sequence[Movable], recordings: Sequence[int]
) -> Movable | None:  # fmt: skip
    """The change that is immaterial, or that pays least and not enough; None where all are to stay."""
    for one in kept:
        if not any(material_difference(problem, shifted.effects, one.target, number) for number in recordings):
            return one
    blocks = block_numbers(problem)
    errors = left_out_residual(shifted.residual, shifted.jacobian, blocks)
    offers = []
    for one in kept:
        # what is left out keeps its level in common, so that only the difference is judged
        removed = [e for e in shifted.effects if not (isinstance(e, RecordingShift) and _of(e, one, recordings))]
        rest = fit(problem, removed, iterations=JOINT_STEPS)
        without = left_out_residual(rest.residual, rest.jacobian, blocks)
        offers.append((compare_left_out(without, errors, blocks, least_gain(problem, without)), one))
    comparison, one = min(offers, key=lambda offer: offer[0].gain)
    tried = len(movables(common.effects, problem))
    return None if _pays(comparison, tried) else one


def _of(shift: RecordingShift, one: Movable, recordings: Sequence[int]) -> bool:
    return shift.target == one.target and shift.recording in recordings


def _trials(ranked: Sequence[Ranked], kept: Sequence[Movable]) -> tuple[ChangeTrial, ...]:
    result = []
    for one, comparison in ranked:
        taken = one in kept
        reason = "it must differ for blocks left out to be met" if taken else _why_common(comparison)
        result.append(ChangeTrial(one.target, one.parameter, comparison, taken, reason))
    return tuple(sorted(result, key=lambda trial: -trial.comparison.gain))


def _why_common(comparison: Comparison) -> str:
    if comparison.gain <= 0:
        return "a value of its own in every recording does not lower the error on blocks left out"
    scatter = f"{comparison.standard_error:.2%} scatter"
    return f"a value of its own lowers the squared error by {comparison.gain:.2%} ({scatter}), or others say it better"
