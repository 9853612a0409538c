"""Fits with parameters free by recording, and with them in common."""

from __future__ import annotations

from collections.abc import Sequence

from feeddrive.diagnosis.calibration.beyond import said_by_effects
from feeddrive.diagnosis.likelihood.cross_validation import (
    Comparison,
    compare_left_out,
    least_gain,
    left_out_residual,
)
from feeddrive.diagnosis.likelihood.fit import Fit, Problem, fit
from feeddrive.diagnosis.likelihood.folds import block_numbers
from feeddrive.diagnosis.recordings.change_candidates import Movable
from feeddrive.diagnosis.recordings.recordings import RecordingShift, Target, is_shift
from feeddrive.effects.base import Effect

REFERENCE_STEPS, JOINT_STEPS = 8, 10
"""Steps of the fit with everything in common, and of the fit with what differs."""


def belongs(effect: Effect, targets: Sequence[Target], recordings: Sequence[int]) -> bool:
    """Whether this is the shift of one of the targets in one of the recordings."""
    return isinstance(effect, RecordingShift) and effect.target in targets and effect.recording in recordings


def set_free(
    problem: Problem, current: Fit, effect: Effect, group: Sequence[Movable], recordings: Sequence[int]
) -> tuple[Problem, Fit, Comparison]:
    """The fit with parameters of one effect free by recording, beside the one that has them in common.

    Args:
        problem: of the fit that there is.
        current: that fit.
        effect: one of its effects, or a level at which nothing is other than declared.
        group: parameters of the effect.
        recordings: numbers of those that may differ.

    Returns:
        The problem in which no declared value is fitted that the effect stands for, the fit, and what it brings.
    """
    shared = current
    if effect not in current.effects:
        problem, effects = said_by_effects(problem, [*current.effects, effect])
        shared = fit(problem, effects, iterations=JOINT_STEPS)
    shifts = [shift for one in group for shift in one.shifts(recordings)]
    wider = fit(problem, [*shared.effects, *shifts], iterations=JOINT_STEPS)
    return problem, wider, compared_fits(problem, shared, wider)


def machine_first(problem: Problem, fitted: Fit) -> Fit:
    """A copy of a fit with the shifts at the end."""
    machine = [effect for effect in fitted.effects if not is_shift(effect)]
    shifts = [effect for effect in fitted.effects if is_shift(effect)]
    return fit(problem, [*machine, *shifts], iterations=REFERENCE_STEPS)


def in_common(
    problem: Problem, common: Fit, current: Fit, targets: Sequence[Target], recordings: Sequence[int]
) -> tuple[Problem, Fit]:
    """The fit with some parameters in common again; a level that was not there before goes with its shifts.

    Args:
        problem: in which no level was free.
        common: the fit of it.
        current: the fit with what differs.
        targets: what is to be in common again.
        recordings: numbers of those that may differ.
    """
    kept = [effect for effect in current.effects if not belongs(effect, targets, recordings)]
    moved = [effect.target for effect in kept if isinstance(effect, RecordingShift)]
    before = [one for one in common.effects if not is_shift(one)]
    places = {(one.name, one.port, one.place) for one in before} | {(t.name, t.port, t.place) for t in moved}
    kept = [effect for effect in kept if is_shift(effect) or (effect.name, effect.port, effect.place) in places]
    problem, _ = said_by_effects(problem, kept)
    return problem, fit(problem, kept, iterations=JOINT_STEPS)


def compared_fits(problem: Problem, without: Fit, having: Fit) -> Comparison:
    """What one fit brings over another on blocks left out."""
    blocks = block_numbers(problem)
    before = left_out_residual(problem, without, blocks)
    after = left_out_residual(problem, having, blocks)
    return compare_left_out(before, after, blocks, least_gain(problem, before, after))
