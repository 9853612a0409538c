"""Slopes of the prediction with the coordinates of effects.

They come from simulations at slightly changed coordinates; the loop over samples is compiled and exact, so that the
differences are smooth. Where a predictor has sensitivities of its own, those are taken.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from feeddrive.diagnosis.likelihood.coordinates import (
    coordinate_ends,
    longest_steps,
    numbers,
    read_coordinates,
    value_slopes,
    write_coordinates,
)
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.motion.predictability import has_play
from feeddrive.effects.base import Effect
from feeddrive.typing import FloatArray

DIFFERENCE = 1e-4
"""Step of the differences in coordinates of size one."""

COARSE = 1e-2
"""The step where a prediction is smooth only beyond 1e-12 m: a simulation that goes from cell to cell of positions ends
one step earlier or later. What has the size one moves the table by nanometres, a hundredth of it by 30 times that."""

SEEN = 0.5
"""Move of all rows together, in deviations, from which a difference is believed where a prediction goes from cell to
cell: the cells leave some hundredths. What declared values do as well is whitened away, and the step that is long
enough for a prediction shows nothing but cells in what is left of it. With free play it is the move of the median row:
a table that bounces goes elsewhere however short the step, and of its rows the slope tells nothing."""

FAR = 4.0
"""Times that move beyond which a step beside a free play is taken again, shorter: the longest comes first, which most
coordinates need, each being of nanometres."""


def difference_of(problem: Problem) -> float:
    """Step of the differences in coordinates of size one."""
    return DIFFERENCE if problem.predictor.smooth(problem.plant) else COARSE


def jacobian_of(problem: Problem, effects: Sequence[Effect], free: Sequence[bool], base: FloatArray) -> FloatArray:
    """Slope of the prediction with the coordinates of the free effects, (m, k).

    Args:
        problem: what predicts.
        effects: with the values at which the slope is taken.
        free: which of them move, those that do not first.
        base: prediction there, (m,).
    """
    moved = [effect for effect, is_free in zip(effects, free, strict=True) if is_free]
    vector = read_coordinates(moved, problem.plant)
    if moved and (exact := _exact_jacobian(problem, effects, moved, vector)) is not None:
        return exact
    _, high = coordinate_ends(moved, problem.plant)
    bounces = has_play(effects) and any(e.lost is not None for e in problem.evidence)
    longest = longest_steps(moved, problem.plant)
    short = difference_of(problem)

    def change(to: FloatArray) -> FloatArray:
        return problem.predicted(placed(effects, free, write_coordinates(moved, problem.plant, to))) - base

    columns = []
    for i in range(len(vector)):
        step, first = np.zeros(len(vector)), max(longest[i], COARSE) if bounces else short
        step[i] = first if vector[i] + first <= high[i] else -first
        moves = change(vector + step)
        size = float(np.median(np.abs(moves)) if bounces else np.linalg.norm(moves))
        if bounces:
            again = max(first * SEEN / size, COARSE) if size > FAR * SEEN else first
        else:
            again = min(longest[i], first * SEEN / max(size, 1e-3 * SEEN)) if first == COARSE and size < SEEN else first
        if again != first:
            step[i] = again if vector[i] + again <= high[i] else -again
            moves = change(vector + step)
        columns.append(moves / step[i])
    return np.column_stack(columns) if columns else np.zeros((len(base), 0))


def _exact_jacobian(
    problem: Problem, effects: Sequence[Effect], moved: Sequence[Effect], vector: FloatArray
) -> FloatArray | None:
    """The slope by the predictor's own sensitivities, where it has them; the moved effects come last."""
    plant = problem.plant.with_effects(*effects)
    labelled = plant.effects[len(plant.effects) - len(moved) :]
    names = [f"{to.label}.{name}" for to, effect in zip(labelled, moved, strict=True) for name in numbers(effect)]
    columns = []
    for e in problem.evidence:
        found = problem.predictor.slopes(plant, e, names)
        if found is None:
            return None
        rows = e.thinned(e.fit_rows)
        parts = [e.weighted({c: s[:, i] for c, s in found.items()}, rows) for i in range(len(names))]
        columns.append(np.column_stack(parts))
    if not columns:
        return None
    return np.asarray(np.vstack(columns) @ value_slopes(moved, problem.plant, vector))


def placed(effects: Sequence[Effect], free: Sequence[bool], moved: Sequence[Effect]) -> list[Effect]:
    """The effects with those that are free in place of theirs."""
    rest = iter(moved)
    return [next(rest) if is_free else effect for effect, is_free in zip(effects, free, strict=True)]
