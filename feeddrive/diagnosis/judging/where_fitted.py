"""Where a law is asked for on data not fitted: where its variable is as it was while the law was fitted.

A spring that was seen over half of the travel says nothing of the other half: there its straight line is a guess, and
a guess that fails does not deny the spring. What the axis does beyond is in the error on data not fitted, as all is.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from feeddrive.diagnosis.judging.judge import Judged, Share, judged_channels, share_of
from feeddrive.diagnosis.likelihood.cross_validation import Comparison
from feeddrive.diagnosis.likelihood.evidence import Evidence
from feeddrive.diagnosis.likelihood.fit import Fit
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.effects.base import Effect
from feeddrive.plant.plant import Plant
from feeddrive.typing import FloatArray


def where_fitted(problem: Problem, found: Sequence[Effect], judged: Sequence[Judged], law: Effect) -> list[Judged]:
    """The judged recordings at the samples where a law's variable is within what was fitted; those that have any.

    Args:
        problem: what was fitted.
        found: effects, the law among them.
        judged: recordings.
        law: any effect; one without a variable over which it may have another form is asked everywhere.
    """
    if not problem.predictor.of_motion or not law.curve_over:
        return list(judged)
    plant = problem.machine(found)
    fitted = [_variable(problem, plant, e, law)[e.fit_rows] for e in problem.evidence]
    known = np.concatenate(fitted)
    if not len(known):
        return list(judged)
    low, high = float(np.min(known)), float(np.max(known))
    there = []
    for one in judged:
        e, values = one.evidence, _variable(problem, one.after, one.evidence, law)
        inside = (values >= low) & (values <= high)
        if inside[e.judged_rows].all():
            there.append(one)
        elif inside[e.judged_rows].any():
            lost = None if e.lost is None else e.lost & inside
            there.append(replace(one, evidence=replace(e, counted=e.counted & inside, lost=lost)))
    return there


def share_where_fitted(problem: Problem, found: Fit, judged: Sequence[Judged], place: int) -> Share:
    """What an effect explains of the judged recordings, and whether it carries to them where it was fitted.

    Args:
        problem: what was fitted.
        found: effects.
        judged: recordings.
        place: of the effect among those found.
    """
    every = share_of(problem, judged, found.effects, place)
    there = where_fitted(problem, found.effects, judged, found.effects[place])
    if there == list(judged):
        return every
    inside = share_of(problem, there, found.effects, place) if there else unseen(judged)
    return replace(inside, explains=every.explains)


def unseen(judged: Sequence[Judged]) -> Share:
    """What an effect explains of recordings that have none of its variable as it was fitted."""
    nothing = Comparison(0.0, 0.0, 0.0)
    return Share(dict.fromkeys(judged_channels(judged), 0.0), nothing, 0.0, nothing)


def _variable(problem: Problem, plant: Plant, evidence: Evidence, law: Effect) -> FloatArray:
    """Position that a law acts over, or the size of a speed or torque, (n,)."""
    seen = {**problem.predictor.variables(plant, evidence), **problem.predictor.predict(plant, evidence)}
    if law.curve_over not in seen:  # its variable is not predicted here
        return np.zeros(len(evidence.counted))
    values: FloatArray = seen[law.curve_over]
    return values if law.curve_over == "table_position" else np.abs(values)
