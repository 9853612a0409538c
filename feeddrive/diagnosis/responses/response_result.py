"""What a measured frequency response says of a plant file, as plain values and as files."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from feeddrive import __version__
from feeddrive.diagnosis.likelihood.tolerances import ASSERTED
from feeddrive.diagnosis.plant_text import most_likely_values, with_written_values
from feeddrive.diagnosis.responses.response_problem import (
    DELAY_SIZE,
    MODE_DAMPING,
    MODE_SHARE,
    Lines,
    ResponseProblem,
    response_problem,
)
from feeddrive.diagnosis.responses.response_search import ResponseSearch, Step, search_response
from feeddrive.effects.base import Effect
from feeddrive.plant.file.lumped_text import plant_text_with_effects
from feeddrive.plant.plant import Plant
from feeddrive.recording.frequency_response import FrequencyResponse
from feeddrive.servo.cascade import Cascade
from feeddrive.servo.mechanics_response import Case
from feeddrive.typing import ComplexArray, FloatArray
from feeddrive.units.quantity import format_quantity

FORMAT = "feeddrive-diagnosis/1"
ODDS = math.log(ASSERTED / (1 - ASSERTED))
"""Log odds from which a member is asserted; below it is possible."""


@dataclass(frozen=True)
class Parameter:
    """A value that was found: key, SI value, unit, 95 % interval."""

    key: str
    value: float
    unit: str
    interval: tuple[float, float]


@dataclass(frozen=True)
class Found:
    """A member of the set that was found.

    Attributes:
        name: of the effect; `declared_value` for a value of the plant file that is beyond its tolerance.
        words: for sentences.
        parameters: with intervals.
        log_odds: for it against leaving it out, everything else refitted, its share of the prior included.
        rivals: candidates that would have done about as well in its round.
        declared: for a declared value what the file says, as text.
    """

    name: str
    words: str
    parameters: tuple[Parameter, ...]
    log_odds: float
    rivals: tuple[str, ...]
    declared: str = ""

    @property
    def asserted(self) -> bool:
        """Whether the odds are 20 to 1 or more."""
        return self.log_odds >= ODDS


@dataclass(frozen=True)
class ResponseResult:
    """What a measured frequency response says of a plant file.

    Attributes:
        problem: plant file and response.
        before, calibrated, after: response of the declared plant, with values within their tolerances, and as found.
        error_before, error_calibrated, error_after: rms of ln(measured / plant), [1], lines weighted by coherence.
        scatter: rms that coherence and discrepancy leave, weighted alike [1].
        found: what was found, asserted or possible.
        calibrated_values: words, factor on the declared value, its 95 % interval.
        steps: everything that was tried.
        effects: that are added.
        coordinates, deviations: of the declared values, most likely, (k,) [1].
    """

    problem: ResponseProblem
    before: ComplexArray
    calibrated: ComplexArray
    after: ComplexArray
    error_before: float
    error_calibrated: float
    error_after: float
    scatter: float
    found: tuple[Found, ...]
    calibrated_values: tuple[tuple[str, float, tuple[float, float]], ...]
    steps: tuple[Step, ...]
    effects: tuple[Effect, ...]
    coordinates: FloatArray
    deviations: FloatArray

    @property
    def asserted(self) -> tuple[Found, ...]:
        """What is asserted."""
        return tuple(one for one in self.found if one.asserted)


def diagnose_response(
    entries: Mapping[str, Any],
    path: Path,
    plant: Plant,
    response: FrequencyResponse,
    case: Case,
    progress: Callable[[str], None] = lambda text: None,
    cascade: Cascade | None = None,
) -> ResponseResult:
    """Trace the difference of a measured frequency response from a plant file.

    Args:
        entries: of the plant file.
        path: of it.
        plant: read from it.
        response: as measured, of the mechanics or of the speed loop.
        case: operating point at which it was measured.
        progress: called with a line that says what is going on.
        cascade: the controller, where the response is one of its speed loop.

    Raises:
        InputError: as `response_problem`, and a plant that cannot be linearised at the operating point.
    """
    search = search_response(response_problem(entries, path, plant, response, case, cascade), progress)
    problem = search.problem
    fit = search.found
    weight = 1 / fit.variance
    own = len(problem.values)

    def error(residual: FloatArray) -> float:
        return float(np.sqrt(np.sum(weight * residual**2) / np.sum(weight)))

    zero = np.zeros(own)
    return ResponseResult(
        problem,
        problem.predicted(zero, Lines()),
        problem.predicted(search.calibrated.coordinates, Lines()),
        problem.predicted(fit.coordinates, fit.lines),
        error(search.declared),
        error(search.calibrated.residual),
        error(fit.residual),
        float(np.sqrt(len(weight) / np.sum(weight))),
        _members(problem, search),
        _calibrated(problem, search),
        search.steps,
        problem.effects(fit.coordinates[own:], fit.lines),
        fit.coordinates[:own],
        np.sqrt(np.diag(fit.covariance)[:own]),
    )


def _members(problem: ResponseProblem, search: ResponseSearch) -> tuple[Found, ...]:
    fit, gains = search.found, list(search.gains)
    deviations = 1.96 * np.sqrt(np.diag(fit.covariance))
    found = []
    for place in fit.beyond:
        value, c, reach = problem.values[place], float(fit.coordinates[place]), float(deviations[place])
        ends = (value.value * math.exp(c - reach), value.value * math.exp(c + reach))
        number = Parameter(value.key, value.value * math.exp(c), value.unit, ends)
        declared = format_quantity(value.value, value.unit)
        rivals = search.rivals.get(value.key, ())
        found.append(Found("declared_value", value.words, (number,), gains.pop(0), rivals, declared))
    at = len(problem.values)
    if fit.lines.delay:
        seconds, reach = float(fit.coordinates[at]) * DELAY_SIZE, float(deviations[at]) * DELAY_SIZE
        delay = Parameter("delay", max(seconds, 0.0), "s", (max(seconds - reach, 0.0), seconds + reach))
        rivals = search.rivals.get("drive_delay", ())
        found.append(Found("drive_delay", "dead time of the torque", (delay,), gains.pop(0), rivals))
        at += 1
    for start in fit.lines.modes:
        parameters = _mode(problem, start, fit.coordinates[at : at + 3], deviations[at : at + 3])
        rivals = search.rivals.get(f"structural_mode at {start:.0f} Hz", ())
        rivals = tuple(one for one in rivals if not one.startswith("structural_mode"))
        found.append(Found("structural_mode", "further resonance on the table", parameters, gains.pop(0), rivals))
        at += 3
    return tuple(found)


def _mode(
    problem: ResponseProblem, start: float, coordinates: FloatArray, deviations: FloatArray
) -> tuple[Parameter, ...]:
    """Mass, frequency and damping of a further mode."""
    mass = MODE_SHARE * problem.plant.chain_values()["table_mass"]
    rows = (("mass", mass, "kg"), ("frequency", start, "Hz"), ("damping", MODE_DAMPING, "1"))
    found = []
    for (key, centre, unit), c, reach in zip(rows, coordinates, deviations, strict=True):
        low, value, high = (centre * math.exp(float(c + side * reach)) for side in (-1, 0, 1))
        found.append(Parameter(key, value, unit, (low, high)))
    return tuple(found)


def _calibrated(problem: ResponseProblem, search: ResponseSearch) -> tuple[tuple[str, float, tuple[float, float]], ...]:
    fit = search.found
    rows = []
    for place, value in enumerate(problem.values):
        if place in fit.beyond or value.missing:
            continue
        c, deviation = float(fit.coordinates[place]), math.sqrt(float(fit.covariance[place, place]))
        if deviation < 0.9 * value.deviation or abs(c) > 0.5 * value.deviation:
            ends = (math.exp(c - 1.96 * deviation), math.exp(c + 1.96 * deviation))
            rows.append((value.words, math.exp(c), ends))
    return tuple(rows)


def response_plant_text(text: str, result: ResponseResult) -> str:
    """The plant file with its values as they are most likely, and what is asserted: effects at its end.

    Raises:
        InputError: a value that cannot be written into this text.
    """
    values, source = result.problem.values, "calibrated by a frequency response"
    changed = most_likely_values(values, result.coordinates, result.deviations, source)
    names = []
    for one in result.asserted:
        if one.name != "declared_value":
            names.append(one.name)
            continue
        number = one.parameters[0]
        share = number.interval[1] / number.value - 1
        shown = f"{float(f'{number.value:.5g}')!r} {number.unit}".removesuffix(" 1")
        changed[number.key] = (shown, f"{100 * share:.2g} %", "found from a measured frequency response")
    effects = [one for one in result.effects if one.name in names]
    remarks = ["found from a measured frequency response"] * len(effects)
    return plant_text_with_effects(with_written_values(text, changed), effects, remarks)


def response_record(result: ResponseResult) -> dict[str, Any]:
    """The content of `diagnosis.json`."""
    response = result.problem.response
    name = f"{response.output} over {response.given}"
    ends = [float(response.frequency[0]), float(response.frequency[-1])]
    return {
        "format": FORMAT,
        "version": __version__,
        "plant": result.problem.plant.name,
        "fit": [{"file": response.source or response.name, "sha256": response.sha256}],
        "validate": [],
        "channels": [
            {"name": name, "unit": "1", "band_hz": ends, "noise_rms": result.scatter,
             "before": _figures(result, result.before, result.error_before),
             "after": _figures(result, result.after, result.error_after)}
        ],
        "effects": [_effect(one) for one in result.asserted],
        "possible": [_effect(one) for one in result.found if not one.asserted],
        "refused": [
            {"name": step.name, "reason": f"log evidence {step.gain:+.1f} by it"}
            for step in result.steps
            if not step.taken
        ],
        "ambiguous": [[_label(one), *one.rivals[:2]] for one in result.found if one.rivals],
        "rehomed": [],
        "unexplained": {},
        "calibrated": [
            {"key": words, "factor": factor, "ci95": list(ends)} for words, factor, ends in result.calibrated_values
        ],
        "notes": list(response.notes),
        "plant_after": "plant_after.toml",
    }  # fmt: skip


def _label(one: Found) -> str:
    return one.parameters[0].key if one.name == "declared_value" else one.name


def _figures(result: ResponseResult, values: ComplexArray, rms: float) -> dict[str, float]:
    largest = float(np.max(np.abs(np.log(result.problem.response.values / values))))
    return {"rms": rms, "max": largest, "relative": rms}


def _effect(one: Found) -> dict[str, Any]:
    parameters: dict[str, Any] = {
        number.key: {"value": number.value, "unit": number.unit, "ci95": list(number.interval)}
        for number in one.parameters
    }
    name = one.name
    if name == "declared_value":
        key = one.parameters[0].key
        name = (
            "payload"
            if key == "table.mass"
            else "inertia_deviation"
            if key.endswith("inertia")
            else "stiffness_deviation"
        )
        parameters = {"key": {"value": key, "unit": "1"}, "value": parameters[key]}
    return {
        "name": name, "parameters": parameters, "explains": {}, "carries": True, "log_odds": one.log_odds,
        "evidence": f"{one.words}; log odds {one.log_odds:.1f}",
    }  # fmt: skip
