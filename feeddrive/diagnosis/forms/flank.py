"""A bump of friction whose top lies off the stroke: what the axis passes is a flank, which is a curve over the stroke.

A flank tells neither top nor width: a peak of some hundred kilonewtons a decimetre beyond the rail rises as one of ten
newtons within it, and on other strokes the one is a thousand times the other. No rail is tight where it has ended. So
the curve is told that the axis has met, as the bump has it to begin with, level where nothing was recorded.
"""

from __future__ import annotations

import numpy as np

from feeddrive.diagnosis.finding.attempt import JOINT_ITERATIONS
from feeddrive.diagnosis.finding.refitting import refitted
from feeddrive.diagnosis.finding.scene import scene_of
from feeddrive.diagnosis.forms.open_map import with_curves_of
from feeddrive.diagnosis.likelihood.fit import Fit, fit
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.starts.starts import TABLE_NODES
from feeddrive.effects.base import number
from feeddrive.effects.friction.friction_vs_position import FrictionVsPosition


def with_curve_for_flank(problem: Problem, found: Fit) -> tuple[Problem, Fit]:
    """The set with a curve in the place of a bump whose top is off the stroke that is declared; else as it is.

    Args:
        problem: recordings.
        found: the set.
    """
    effects, stroke = [*found.effects], problem.plant.stroke
    for place, effect in enumerate(effects):
        if stroke is None or not isinstance(effect, FrictionVsPosition) or not number(effect.values["peak"]):
            continue
        peak, centre, width = (number(effect.values[key]) for key in ("peak", "centre", "half_width"))
        runs = scene_of(problem, effects).runs
        met = np.concatenate([run.table_position[e.fit_rows] for run, e in zip(runs, problem.evidence, strict=True)])
        # an encoder may count from elsewhere than the stroke is declared from: a top that was passed is there
        if stroke[0] <= centre <= stroke[1] or np.min(met) <= centre <= np.max(met):
            continue
        points = np.linspace(np.min(met), np.max(met), TABLE_NODES)
        levels = peak * np.exp(-(((points - centre) / width) ** 2))
        effects[place] = FrictionVsPosition.of(position=tuple(points.tolist()), delta_force=tuple(levels.tolist()))
        others = with_curves_of(problem, effects[:place] + effects[place + 1 :])
        return refitted(others, fit(others, effects, iterations=JOINT_ITERATIONS))
    return problem, found
