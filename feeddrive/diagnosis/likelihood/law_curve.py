"""The curve of a law: what a law of the same cause and another form makes of a recording beside it.

No law is exactly ours. A drag that differs between the directions grows with a power of the speed, a friction drops
with another tail, a machine warms up with two time constants. What is left beside the law is then its own, and no
second effect. Two families hold such forms, with a deviation of one each: as large as what the law itself does.

    s P_k(u)              law over a variable:      u from -1 to 1 over what is visited, k = 1 to 3
    s (1 - tanh(v / w))   part of a law that takes some speed:    w over the highest v = 1/81, 1/27, 1/9, 1/3
    s(3^m l) - s(l)       law of a scale l:         m = -2, -1, 1, 2

| symbol | meaning | unit |
|---|---|---|
| s | what the law, or its part that differs (`Effect.curved`), makes of the channels | that of the channel |
| P_k | Legendre polynomial | 1 |
| u | variable that the law acts over: position, or logarithm of a speed or torque, over two decades | 1 |
| l | velocity, time constant, width that the law has | its own |

A form is a law times a factor that changes slowly, as a power does with the logarithm, or the law at several scales at
once: exp(-x) and 1 / (1 + x) are mixtures of exp(-x^2) of other scales, and two time constants are two scales.
A law may be as large as it likes: what lies along s is taken out of every column.

Where such a curve is likelier than the likeliest further name, comparisons are without it from there on
(`forms.open_map`), as long as the law is in the set. Once the names are found all of it counts again.

Source: Kennedy and O'Hagan, J. R. Statist. Soc. B 63 (2001) 425 (discrepancy of a model).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from feeddrive.diagnosis.likelihood.evidence import Evidence
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.effects.base import Effect, number
from feeddrive.errors import InputError
from feeddrive.typing import FloatArray

HALF_WAVES: tuple[int, ...] = (1, 2, 3)
"""Half waves of the factor over what is visited: slower than two periods, as a lead map; faster is no form of a law."""

STEPS = (1 / 9, 1 / 3, 3.0, 9.0)
"""Scales of a mixture, over that of the law: beside exp(-x^2) they follow 1 / (1 + x) to 5 % and exp(-x) to 2 %."""

SPEEDS = (1 / 81, 1 / 27, 1 / 9, 1 / 3)
"""Speeds that a part of a law takes, over the highest: a step at any speed between is a mixture of two of them."""

LEAST = 0.01
"""Speed or torque over the largest below which the logarithm goes no further: there friction turns."""


def has_curve(effects: Sequence[Effect]) -> bool:
    """Whether one of these laws has other forms."""
    return any(effect.curve_over or effect.curve_scale for effect in effects)


def law_curves(problem: Problem, effects: Sequence[Effect], place: int) -> dict[Evidence, list[dict[str, FloatArray]]]:
    """Per recording, series of all channels, (n,) each, that the form of a law may make; empty for a law without one.

    Args:
        problem: recordings.
        effects: fitted.
        place: of the law among them.
    """
    law = effects[place]
    if not problem.predictor.of_motion or not has_curve([law]):
        return {}
    others = [effect for i, effect in enumerate(effects) if i != place]
    plant, without = problem.machine(effects), problem.machine(others)
    found = {}
    for e in problem.evidence:
        with_law, bare = problem.predictor.predict(plant, e), problem.predictor.predict(without, e)
        own = {name: with_law[name] - bare[name] for name in e.channels}
        if law.curve_scale:
            parts = [
                {name: series[name] - with_law[name] for name in e.channels}
                for series in _at_other_scales(problem, others, law, e)
            ]
        else:
            u = _visited({**problem.predictor.variables(plant, e), **with_law}.get(law.curve_over), law)
            if u is None:  # its variable is not predicted here
                return {}
            over, factors = own, [np.polynomial.Legendre.basis(k)(u) for k in HALF_WAVES]
            if law.curved is not law:
                part = problem.predictor.predict(problem.machine([*others, law.curved]), e)
                over = {name: part[name] - bare[name] for name in e.channels}
                v = np.abs(problem.predictor.variables(plant, e)[law.curve_over])
                factors = [1 - np.tanh(v / (share * np.max(v))) for share in SPEEDS]
            parts = [{name: over[name] * factor for name in e.channels} for factor in factors]
        found[e] = [beside(part, own, e) for part in parts]
    return found


def _visited(variable: FloatArray | None, law: Effect) -> FloatArray | None:
    """u of a law's variable, (n,); None without one."""
    if variable is None or not np.ptp(variable) > 0:
        return None
    if law.curve_over != "table_position":
        size = np.abs(variable)
        variable = np.log(np.maximum(size / np.max(size), LEAST))
    low, span = float(np.min(variable)), float(np.ptp(variable))
    return np.asarray(2 * (variable - low) / span - 1) if span > 0 else None


def beside(part: dict[str, FloatArray], own: dict[str, FloatArray], e: Evidence) -> dict[str, FloatArray]:
    """A deviation of a law, without what lies along the law itself at the samples that count."""
    dot, square = products(part, own, e)
    along = dot / square if square > 0 else 0.0
    return {name: part[name] - along * own[name] for name in e.channels}


def products(part: dict[str, FloatArray], own: dict[str, FloatArray], e: Evidence) -> tuple[float, float]:
    """What a law makes of the channels times another series, and times itself, over the noise at samples that count."""
    dot = square = 0.0
    for name in e.channels:
        weight = 1 / e.unit(name) ** 2
        law = own[name][e.counted] - (np.mean(own[name][e.counted]) if name in e.floating else 0.0)
        dot += weight * float(part[name][e.counted] @ law)
        square += weight * float(law @ law)
    return dot, square


def _at_other_scales(
    problem: Problem, others: Sequence[Effect], law: Effect, e: Evidence
) -> list[dict[str, FloatArray]]:
    """Predictions with the law at other scales, those that it may have."""
    found = []
    for step in STEPS:
        values = {**law.values, law.curve_scale: number(law.values[law.curve_scale]) * step}
        try:
            other = replace(law, values=values)
            if not problem.possible([*others, other]):
                continue
            series = problem.predictor.predict(problem.machine([*others, other]), e)
        except InputError:  # a scale beyond those of the law
            continue
        if all(np.all(np.isfinite(one)) for one in series.values()):
            found.append(series)
    return found
