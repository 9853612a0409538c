"""A stiffness that falls along the stroke, begun again from the declared stiffness.

    k(x) = k / (1 + b u + 4 m u (1 - u))    (`effects.transmission.stiffness_vs_position`)

k, b and m are told by the places that were visited alone: there a softer screw of one form is nearly a stiff one of
another. Steps lead along that valley by little, as it bends, and a search that met the law beside a stiffness that
stood in for it stays there. So the same compliance over what is visited is written about the declared k, as a straight
line and as a parabola, and both are fitted to their ends.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from feeddrive.diagnosis.calibration.known import TOLERANCE
from feeddrive.diagnosis.calibration.value_slopes import with_slopes
from feeddrive.diagnosis.finding.refitting import at_rest, refitted
from feeddrive.diagnosis.finding.scene import scene_of
from feeddrive.diagnosis.likelihood.fit import fit
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.likelihood.set_evidence import Standing, odds_between
from feeddrive.effects.base import Effect, number
from feeddrive.effects.transmission.stiffness_vs_position import StiffnessVsPosition
from feeddrive.errors import InputError
from feeddrive.typing import FloatArray

AXIAL = ("axial_stiffness", "nut_stiffness")
"""Declared values that are k of the law, in chains of lumps and of a distributed screw."""


def with_declared_stiffness(here: Standing, count: int) -> Standing | None:
    """A likelier set with the declared stiffness near what is declared; None where it is, or none is likelier.

    Args:
        here: a set, its values at rest.
        count: candidates and starts that were tried.
    """
    problem, found, known = here.problem, here.fit, here.problem.calibration
    names = [effect.name for effect in found.effects]
    if known is None or StiffnessVsPosition.name not in names:
        return None
    far = [i for i, value in enumerate(known.values) if value.key in AXIAL and abs(known.coordinates[i]) > TOLERANCE]
    if not far or problem.budget.skips("a stiffness along the stroke, begun from the declared one"):
        return None
    place, value = names.index(StiffnessVsPosition.name), known.values[far[0]]
    softer = 1 / value.factor(float(known.coordinates[far[0]]))
    coordinates = known.coordinates.copy()
    coordinates[far[0]] = 0.0
    best: tuple[float, Standing] | None = None
    for law in _as_compliant(found.effects[place], softer, _visited(problem, found.effects)):
        effects = (*found.effects[:place], law, *found.effects[place + 1 :])
        try:
            there = with_slopes(problem.at_values(coordinates), effects)
            other = Standing(*at_rest(*refitted(there, fit(there, effects))))
            odds = odds_between(here, other, count)
        except InputError:  # a machine on the way cannot be simulated
            continue
        if odds > 0 and (best is None or odds > best[0]):
            best = odds, other
    return None if best is None else best[1]


def _visited(problem: Problem, effects: tuple[Effect, ...]) -> FloatArray:
    """Places of the table at the fitted rows of all recordings [m], (n,)."""
    runs = scene_of(problem, effects).runs
    return np.concatenate([run.table_position[e.fit_rows] for run, e in zip(runs, problem.evidence, strict=True)])


def _as_compliant(law: Effect, softer: float, places: FloatArray) -> Iterator[Effect]:
    """The law about another k, as near as it comes over places to `softer` times its compliance: line, parabola."""
    low, high = number(law.values["low"]), number(law.values["high"])
    share, m = number(law.values["share_over_stroke"]), number(law.values["middle_compliance"])
    u = (places - low) / (high - low)
    compliance = softer * (1 + share / (1 - share) * u + 4 * m * u * (1 - u))
    for columns in (u[:, None], np.column_stack([u, 4 * u * (1 - u)])):
        b, *more = np.linalg.lstsq(columns, compliance - 1, rcond=None)[0]
        share = float(b / (1 + b)) if b > -1 else -np.inf
        values = {"share_over_stroke": share, "middle_compliance": float(more[0]) if more else 0.0}
        ranges = [law.parameter(key) for key in values]
        if all(p.minimum < value < p.maximum for p, value in zip(ranges, values.values(), strict=True)):
            yield law.with_values(**values)
