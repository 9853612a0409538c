"""A stiffness that falls along the stroke, begun again from the declared stiffness.

    k(x) = k / (1 + b u + 4 m u (1 - u))    (`effects.transmission.stiffness_vs_position`)

k, b and m are told by the places that were visited alone: there a softer screw of one form is nearly a stiff one of
another. Steps lead along that valley by little, as it bends, and a search that met the law beside a stiffness that
stood in for it stays there. So the same compliance over what is visited is written about the declared k, as a straight
line and as a parabola, and both are fitted to their ends. And a parabola that is new begins at the line that does best.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from feeddrive.diagnosis.calibration.known import TOLERANCE
from feeddrive.diagnosis.finding.scene import scene_of
from feeddrive.diagnosis.forms.begun_anew import begun_anew, likeliest
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.likelihood.standing import Standing
from feeddrive.diagnosis.starts.transmission_starts import PARABOLA
from feeddrive.effects.base import Effect, number
from feeddrive.effects.transmission.stiffness_vs_position import StiffnessVsPosition
from feeddrive.typing import FloatArray

AXIAL = ("axial_stiffness", "nut_stiffness")
"""Declared values that are k of the law, in chains of lumps and of a distributed screw."""

LINE = {"share_over_stroke": 0.0, "middle_compliance": 0.0}
"""Values of the law that a straight line begins with."""


def with_declared_stiffness(here: Standing, count: int) -> Standing | None:
    """A likelier set with the declared stiffness near what is declared; None where it is, or none is likelier.

    Args:
        here: a set.
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
    other = problem.at_values(coordinates)
    laws = _as_compliant(found.effects[place], softer, _visited(problem, found.effects))
    begun = [begun_anew(other, found.effects, place, law) for law in laws]
    return likeliest(here, begun, count)


def with_parabola_from_line(here: Standing, count: int) -> Standing | None:
    """A likelier set whose parabola begins at the straight line that does best; None where it has none, or is likelier.

    Over some of the stroke a parabola has the level of the compliance right with any slope, and fits that begin at none
    of either end there. A line has the slope that it needs.

    Args:
        here: a set.
        count: candidates and starts that were tried.
    """
    problem, found = here.problem, here.fit
    places = [i for i, e in enumerate(found.effects) if isinstance(e, StiffnessVsPosition) and _is_parabola(e)]
    if not places or problem.budget.skips("a stiffness along the stroke, begun as a straight line"):
        return None
    (place,) = places
    line = begun_anew(problem, found.effects, place, found.effects[place].with_values(**LINE))
    if line is None:
        return None
    parabola = line.fit.effects[place].with_values(middle_compliance=PARABOLA)
    return likeliest(here, [line, begun_anew(line.problem, line.fit.effects, place, parabola)], count)


def _is_parabola(law: Effect) -> bool:
    return number(law.values["middle_compliance"]) != 0


def _visited(problem: Problem, effects: Sequence[Effect]) -> FloatArray:
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
