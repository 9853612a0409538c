"""What measured numbers say of a plant file, as plain values: verdict, explanations, further measurements, files."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from scipy.special import chdtri

from feeddrive import __version__
from feeddrive.diagnosis.likelihood.tolerances import ASSERTED
from feeddrive.diagnosis.numbers.declared_values import DeclaredValue
from feeddrive.diagnosis.numbers.explanations import (
    Explanation,
    NumbersProblem,
    SingleCause,
    explanations,
    inclusion,
    numbers_problem,
    single_causes,
)
from feeddrive.diagnosis.numbers.measured_file import MeasuredNumber
from feeddrive.diagnosis.numbers.next_number import NextNumber, mixed, next_numbers
from feeddrive.diagnosis.plant_text import most_likely_values, with_written_values
from feeddrive.errors import InputError
from feeddrive.plant.plant import Plant
from feeddrive.typing import FloatArray
from feeddrive.units.quantity import format_quantity

FORMAT = "feeddrive-diagnosis/1"
MOST_NAMED = 3
"""Values named together where the numbers cannot tell them apart, as in every diagnosis."""

_EFFECTS = {"payload": ("table.mass",), "inertia_deviation": ("inertia",), "friction_deviation": ("effect.",)}


@dataclass(frozen=True)
class Beyond:
    """A value beyond its tolerance.

    Attributes:
        value: as declared.
        now: as it is [SI].
        interval: 95 %, [SI].
        probability: that it is beyond its tolerance.
    """

    value: DeclaredValue
    now: float
    interval: tuple[float, float]
    probability: float


@dataclass(frozen=True)
class Calibrated:
    """A value within its tolerance, as the numbers move it.

    Attributes:
        value: as declared.
        factor: on the declared value [1].
        interval: of the factor, 95 %.
        spread_before: standard deviation of its logarithm as declared.
    """

    value: DeclaredValue
    factor: float
    interval: tuple[float, float]
    spread_before: float


@dataclass(frozen=True)
class NumbersResult:
    """What measured numbers say of a plant file.

    Attributes:
        problem: plant file, numbers, values that may be other.
        declared: what the declared plant gives, (n,) SI.
        after: what it gives at the most likely values, (n,) SI.
        explained: whether the numbers are met to their tolerances then.
        within: probability that every value is within its tolerance.
        beyond: values that are asserted to be beyond theirs.
        suspects: values of which one, beside those asserted, is beyond its tolerance, and the numbers cannot tell
            which; empty where none is needed.
        calibrated: values that the numbers move or narrow, the most moved first.
        singles: each value alone made to meet the numbers.
        sets: the sets that were compared, the most probable first.
        further: what to measure next, the most telling first.
    """

    problem: NumbersProblem
    declared: FloatArray
    after: FloatArray
    explained: bool
    within: float
    beyond: tuple[Beyond, ...]
    suspects: tuple[Beyond, ...]
    calibrated: tuple[Calibrated, ...]
    singles: tuple[SingleCause, ...]
    sets: tuple[Explanation, ...]
    further: tuple[NextNumber, ...]


ANOTHER_UNIT = 500.0
"""Factor between a measured number and what the plant gives from which one of the two is in another unit: half of the
next prefix. No part that stands in for another differs by as much."""

OF_PARTS = ("axial_stiffness", "natural_frequency", "inertia_at_motor")
"""Numbers that the size of parts gives. Friction may be undeclared, and play any number of times what springs give."""


def refuse_another_unit(number: MeasuredNumber, plant: Plant) -> None:
    """Refuse a number of the parts that is hundreds of times what the plant gives, or as small a share of it.

    Raises:
        InputError: it is, or the plant cannot give it.
    """
    if number.quantity not in OF_PARTS:
        return
    given = abs(number.kind.of(plant, number.setting))
    if given > 0 and not 1 / ANOTHER_UNIT < abs(number.value) / given < ANOTHER_UNIT:
        unit = number.kind.unit
        what = f"{format_quantity(number.value, unit)} is measured where the plant gives {format_quantity(given, unit)}"
        raise InputError(what, number.quantity, "correct the unit of the one that is wrong")


def diagnose_numbers(
    entries: Mapping[str, Any],
    path: Path,
    plant: Plant,
    measured: Sequence[MeasuredNumber],
    progress: Callable[[str], None] = lambda text: None,
) -> NumbersResult:
    """Trace the difference of measured numbers from a plant file to its declared values.

    Args:
        entries: of the plant file.
        path: of it.
        plant: read from it.
        measured: the numbers.
        progress: called with a line that says what is going on.

    Raises:
        InputError: a number that this plant cannot give, or in another unit, or a file that declares nothing that could
            be other.
    """
    for number in measured:
        refuse_another_unit(number, plant)
    problem = numbers_problem(entries, path, plant, measured)
    sets = explanations(problem, progress)
    progress("each value alone, and what to measure next")
    chances = inclusion(problem, sets)
    within = sum(one.probability for one in sets if not one.beyond)
    likely = sorted(problem.seen, key=lambda place: -chances[place])
    named = [place for place in likely if chances[place] >= ASSERTED]
    asserted = tuple(_beyond(problem, sets, place, chances) for place in named)
    enough = sum(one.probability for one in sets if set(one.beyond) <= set(named))
    suspects: tuple[Beyond, ...] = ()
    if enough < 1 - ASSERTED:
        others = [place for place in likely if place not in named]
        suspects = tuple(_beyond(problem, sets, place, chances) for place in others[:MOST_NAMED])
    best = sets[0]
    left = float(
        np.sum([((one.value - f) / one.deviation) ** 2 for one, f in zip(measured, best.predicted, strict=True)])
    )
    return NumbersResult(
        problem,
        problem.predicted(np.zeros(len(problem.values))),
        best.predicted,
        left <= float(chdtri(len(problem.measured), 0.05)),
        within,
        asserted,
        suspects,
        _calibrated(problem, sets, {one.value.key for one in asserted}),
        single_causes(problem),
        sets,
        next_numbers(problem, sets),
    )


def _beyond(problem: NumbersProblem, sets: Sequence[Explanation], place: int, chances: FloatArray) -> Beyond:
    """The value over the sets in which it is beyond its tolerance."""
    value = problem.values[place]
    holding = [one for one in sets if place in one.beyond]
    weights = np.array([one.probability for one in holding])
    means = np.array([one.coordinates[place] for one in holding])
    variances = np.array([one.covariance[place, place] for one in holding])
    weights = weights / np.sum(weights) if np.sum(weights) > 0 else np.full(len(holding), 1 / len(holding))
    mean = float(weights @ means)
    spread = 1.96 * math.sqrt(float(weights @ (variances + (means - mean) ** 2)))
    ends = [value.number(mean + side * spread) for side in (-1, 1)]
    low, high = sorted(math.inf if end is None else end for end in ends)
    now = value.number(mean)
    return Beyond(value, math.inf if now is None else now, (low, high), float(chances[place]))


def _calibrated(problem: NumbersProblem, sets: Sequence[Explanation], asserted: set[str]) -> tuple[Calibrated, ...]:
    mean, covariance = mixed(sets)
    found = []
    for place in problem.seen:
        value, spread = problem.values[place], math.sqrt(float(covariance[place, place]))
        if value.key in asserted or value.missing:
            continue
        ends = (math.exp(mean[place] - 1.96 * spread), math.exp(mean[place] + 1.96 * spread))
        found.append(Calibrated(value, math.exp(mean[place]), ends, value.deviation))
    return tuple(sorted(found, key=lambda one: -abs(math.log(one.factor)) / one.spread_before))


def plant_text_after(text: str, result: NumbersResult) -> str:
    """The plant file with its values as they are most likely, those that are asserted with what is known of them.

    Raises:
        InputError: a value that cannot be written into this text.
    """
    best = result.sets[0]
    deviations = np.sqrt(np.maximum(np.diag(best.covariance), 0.0))
    changed = most_likely_values(result.problem.values, best.coordinates, deviations, "calibrated by measured numbers")
    for one in result.beyond:
        shown = f"{float(f'{one.now:.4g}')!r} {one.value.unit}"
        share = max(one.interval[1] / one.now, one.now / one.interval[0]) - 1 if one.interval[0] > 0 else 1.0
        changed[one.value.key] = (shown, f"{100 * share:.2g} %", "found from measured numbers")
    return with_written_values(text, changed)


def numbers_record(result: NumbersResult) -> dict[str, Any]:
    """The content of `diagnosis.json`."""
    problem = result.problem
    return {
        "format": FORMAT,
        "version": __version__,
        "plant": problem.plant.name,
        "fit": [],
        "validate": [],
        "channels": [_channel(*row) for row in zip(problem.measured, result.declared, result.after, strict=True)],
        "effects": [_effect(one) for one in result.beyond],
        "refused": [
            {"name": value.words, "reason": "no measured number depends on it"}
            for place, value in enumerate(problem.values)
            if place not in problem.seen
        ],
        "ambiguous": [[one.value.key for one in result.suspects]] if result.suspects else [],
        "rehomed": [],
        "unexplained": {},
        "within_tolerance": result.within,
        "explained": result.explained,
        "calibrated": [
            {"key": one.value.key, "factor": one.factor, "ci95": list(one.interval)} for one in result.calibrated
        ],
        "single_causes": [
            {"key": one.value.key, "value": one.value.number(one.coordinate), "unit": one.value.unit,
             "declared": None if one.value.missing else one.value.value, "meets": one.meets, "misfit": one.misfit,
             "settled_by": one.value.settled_by}
            for one in result.singles
        ],
        "sets": [
            {"beyond": [problem.values[place].key for place in one.beyond], "probability": one.probability}
            for one in result.sets[:20]
        ],
        "next_experiment": [
            {"name": one.name, "how": one.how, "information_bit": one.information,
             "expected": [_finite(number) for number in one.expected], "unit": one.unit}
            for one in result.further[:10]
        ],
        "notes": [f"{one.name}: {one.source}" for one in problem.measured if one.source],
        "plant_after": "plant_after.toml",
    }  # fmt: skip


def _channel(number: MeasuredNumber, declared: float, after: float) -> dict[str, Any]:
    def figures(value: float) -> dict[str, float]:
        error = abs(number.value - value)
        return {"rms": error, "max": error, "relative": error / number.value}

    return {
        "name": number.name, "unit": number.kind.unit, "band_hz": [0.0, 0.0], "noise_rms": number.deviation,
        "measured": number.value, "before": figures(declared), "after": figures(after),
    }  # fmt: skip


def _effect(one: Beyond) -> dict[str, Any]:
    key = one.value.key
    name = next((name for name, marks in _EFFECTS.items() if any(mark in key for mark in marks)), "")
    factor = math.inf if one.value.missing else one.now / one.value.value
    parameters: dict[str, Any] = {
        "key": {"value": key, "unit": "1"},
        "value": {"value": one.now, "unit": one.value.unit, "ci95": [_finite(end) for end in one.interval]},
    }
    if math.isfinite(factor):
        parameters["factor"] = {"value": factor, "unit": "1", "ci95": [end / one.value.value for end in one.interval]}
    if name == "payload":
        parameters["mass"] = {
            "value": one.now - one.value.value, "unit": "kg", "ci95": [end - one.value.value for end in one.interval],
        }  # fmt: skip
    return {
        "name": name or "stiffness_deviation", "parameters": parameters, "explains": {}, "carries": True,
        "probability": one.probability,
        "evidence": f"{one.value.words} is {format_quantity(one.now, one.value.unit)} in place of the declared value",
    }  # fmt: skip


def _finite(number: float) -> float | None:
    return number if math.isfinite(number) else None
