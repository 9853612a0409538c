"""Which experiment settles what the recordings leave open, before anyone drives to the machine.

Two sets of effects A and B explain the recordings at hand alike. In an experiment to come, run by the plant with A, B
would still be refitted, to both experiments together:

    d^2 = min over b of  kappa |y_A - y_B - J b|^2 + b' H b

| symbol | meaning | unit |
|---|---|---|
| y_A, y_B | predictions of the experiment over the sensor noise in the band | 1 |
| J, b | slopes of y_B with B's coordinates, and the change of those | 1 |
| H | information of the recordings at hand about B's coordinates (`information`) | 1 |
| kappa | independent values per sample (`noise_colour.independent_share`) | 1 |

d is the distance in standard deviations of the noise; the expected odds for the true one are exp(d^2 / 2), the distance
of Kullback and Leibler. An interval shrinks by the information that an experiment adds, H + kappa J'J.
Valid as far as B's prediction is straight in b, and as far as the prediction misses nothing but noise.
Source: Lindley, Ann. Math. Statist. 27 (1956) 986; Box and Hill, Technometrics 9 (1967) 57.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from feeddrive.diagnosis.certainty.ambiguity import Rival
from feeddrive.diagnosis.certainty.certainty_result import NextExperiment
from feeddrive.diagnosis.certainty.information import fisher_information, inverse_information
from feeddrive.diagnosis.certainty.noise_colour import independent_share
from feeddrive.diagnosis.certainty.rehearsal import Rehearsal, rehearsals
from feeddrive.diagnosis.certainty.uncertainty import Interval
from feeddrive.diagnosis.finding.search import Search
from feeddrive.diagnosis.likelihood.coordinates import read_coordinates, spread_to_values
from feeddrive.diagnosis.likelihood.fit import Fit
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.likelihood.slopes import jacobian_of
from feeddrive.diagnosis.motion.axis_evidence import AxisEvidence
from feeddrive.diagnosis.motion.prediction import AxisPredictor
from feeddrive.diagnosis.recordings.recordings import is_shift
from feeddrive.effects.base import Effect
from feeddrive.typing import FloatArray

TELLS, HINTS = 5.0, 3.0
"""Distances [standard deviations] from which an experiment settles a question, and from which it may."""

WIDE = 0.5
"""Half width of an interval over the size of its value, from which the value counts as hardly known."""

NARROWS = 0.7
"""Ratio of interval widths below which an experiment is worth naming."""

MOST_WIDE = 3
"""Parameters that experiments are sought for; the widest."""

NOT_SIZES = frozenset({"centre", "zero", "order", "phase", "damping", "position", "break_away"})
"""Keys whose value has no size of its own, or that nobody acts on."""


@dataclass(frozen=True)
class Doubt:
    """A parameter that is hardly known: number of its effect, key, and how wide its interval is over its size."""

    place: int
    key: str
    width: float


def next_experiments(
    found: Search, rivals: Sequence[Sequence[Rival]], spans: Sequence[dict[str, list[Interval] | None]]
) -> tuple[NextExperiment, ...]:
    """For every ambiguous set and every hardly known parameter the scenario that settles it best; else nothing is run.

    Args:
        found: the search, whose effects move the machine.
        rivals: per effect, those that do as well in its place.
        spans: per effect, key to 95 % intervals.
    """
    effects, plant = found.fit.effects, found.problem.plant
    doubts = hardly_known(effects, spans)
    evidence = [e for e in found.problem.evidence if isinstance(e, AxisEvidence)]
    asked = bool(doubts) or any(rivals)
    if not asked or not evidence or any(is_shift(effect) for effect in effects):
        return ()
    ready = rehearsals(plant, found.problem.machine(effects), evidence)
    settled = [_apart(found, alike, ready) for alike in rivals if alike]
    known = [_better_known(found, doubt, ready) for doubt in doubts]
    return (*settled, *known)


def hardly_known(effects: Sequence[Effect], spans: Sequence[dict[str, list[Interval] | None]]) -> list[Doubt]:
    """The parameters whose intervals are too wide to act on, the widest first."""
    doubts = []
    for place, (effect, known) in enumerate(zip(effects, spans, strict=False)):
        for key, ends in known.items():
            value = effect.values.get(key)
            if ends is None or key in NOT_SIZES or not isinstance(value, float | int):
                continue
            size = abs(value - (1.0 if key.endswith("factor") else 0.0))
            half = 0.5 * (ends[0][1] - ends[0][0])
            if half > WIDE * size:
                doubts.append(Doubt(place, key, half / size if size > 0 else float("inf")))
    return sorted(doubts, key=lambda doubt: -doubt.width)[:MOST_WIDE]


def distance(problem: Problem, found: Sequence[Effect], rival: Fit, experiment: Rehearsal) -> float:
    """d of the module's docstring: how far apart the experiment brings what was found and a rival."""
    ready = Problem(problem.machine(), (experiment.evidence,), AxisPredictor())
    base = ready.predicted(rival.effects)
    apart = ready.predicted(found) - base
    slopes = jacobian_of(ready, rival.effects, [True] * len(rival.effects), base)
    share = independent_share(experiment.evidence)
    before = fisher_information(problem, rival.jacobian)
    moved = inverse_information(before + share * slopes.T @ slopes) @ (share * slopes.T @ apart)
    left = apart - slopes @ moved
    squared = share * float(left @ left) + float(moved @ before @ moved)
    return float(np.sqrt(squared)) if np.isfinite(squared) else 0.0


def _apart(found: Search, alike: Sequence[Rival], ready: Sequence[Rehearsal]) -> NextExperiment:
    """The scenario that brings the nearest rival of a set farthest away."""
    effects = found.fit.effects
    names = (effects[alike[0].place].name, *(rival.effect.name for rival in alike))
    ranking = [(one, min(distance(found.problem, effects, rival.fit, one) for rival in alike)) for one in ready]
    ranking.sort(key=lambda entry: -entry[1])
    return _record(names, ranking, _apart_sentence(names, ranking), HINTS)


def _apart_sentence(names: Sequence[str], ranking: Sequence[tuple[Rehearsal, float]]) -> str:
    pair = f"{names[0]} from {' and '.join(names[1:])}"
    if not ranking:
        return f"no shipped scenario fits this axis, to tell {pair}"
    (best, d), *others = ranking
    if d < HINTS:
        return f"no shipped scenario tells {pair}; the best is {best.name} with d = {d:.1f} sigma"
    verb = "tells" if d >= TELLS else "may tell"
    also = ", ".join(f"{one.name} {other:.1f}" for one, other in others[:2] if other >= HINTS)
    return f"run scenario {best.name}{_where(best)}: {verb} {pair} with d = {d:.1f} sigma{f' ({also})' if also else ''}"


def _better_known(found: Search, doubt: Doubt, ready: Sequence[Rehearsal]) -> NextExperiment:
    """The scenario after which a parameter's interval is narrowest."""
    name = f"{found.fit.effects[doubt.place].name}.{doubt.key}"
    before = fisher_information(found.problem, found.fit.jacobian)
    ranking = [(one, _narrowing(found, doubt, before, one)) for one in ready]
    ranking.sort(key=lambda entry: entry[1])
    return _record((name,), ranking, _known_sentence(name, ranking), -NARROWS)


def _narrowing(found: Search, doubt: Doubt, before: FloatArray, experiment: Rehearsal) -> float:
    """Width of the parameter's interval after the experiment over that before."""
    effects = found.fit.effects
    ready = Problem(found.problem.machine(), (experiment.evidence,), AxisPredictor())
    slopes = jacobian_of(ready, effects, [True] * len(effects), ready.predicted(effects))
    if not np.all(np.isfinite(slopes)):
        return 1.0
    after = before + independent_share(experiment.evidence) * slopes.T @ slopes
    vector = read_coordinates(effects, found.problem.plant)
    widths = [
        float(
            spread_to_values(effects, found.problem.plant, vector, inverse_information(one))[doubt.place][doubt.key][0]
        )
        for one in (before, after)
    ]
    return widths[1] / widths[0] if widths[0] > 0 else 1.0


def _known_sentence(name: str, ranking: Sequence[tuple[Rehearsal, float]]) -> str:
    if not ranking:
        return f"no shipped scenario fits this axis, to know {name} better"
    best, ratio = ranking[0]
    if ratio > NARROWS:
        return f"no shipped scenario makes {name} much better known"
    return f"run scenario {best.name}{_where(best)}: the interval of {name} becomes {1 / ratio:.2g} times narrower"


def _where(experiment: Rehearsal) -> str:
    """What the person has to change."""
    return f", positions moved by {experiment.moved * 1e3:+.0f} mm" if experiment.moved else ""


def _record(
    question: tuple[str, ...], ranking: Sequence[tuple[Rehearsal, float]], sentence: str, least: float
) -> NextExperiment:
    """The record; the scenario is named where its figure reaches `least`, or stays below it where that is negative."""
    figure = ranking[0][1] if ranking else 0.0
    settles = bool(ranking) and (figure >= least if least > 0 else figure <= -least)
    names = tuple((one.name, float(value)) for one, value in ranking)
    return NextExperiment(question, ranking[0][0].name if settles else "", figure, sentence, names)
