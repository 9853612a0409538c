"""Families of frequency responses: one curve per position and payload, with what is read off each.

Frequency responses as plain values for JSON: Hz, dB, degrees; what is not finite is None.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

from feeddrive.plant.plant import Plant
from feeddrive.servo.cascade import Cascade
from feeddrive.servo.loop_response import (
    ClosedFigures,
    Loop,
    closed_figures,
    closed_response,
    controlled_response,
    open_response,
)
from feeddrive.servo.margins import Margins
from feeddrive.servo.mechanics_response import Case, Response, decibel, degrees, mechanics
from feeddrive.servo.resonances import Extremum, Resonance, extrema, on_curve
from feeddrive.typing import ComplexArray, FloatArray


@dataclass(frozen=True)
class Curve:
    """One response of a family.

    Attributes:
        case: what it holds for.
        response: with poles and zeros where it is of the mechanics.
        seen: peaks and dips of the curve.
        margins: of an open loop.
        closed: bandwidth and peak of a closed loop from set-point to what it measures.
    """

    case: Case
    response: Response
    seen: tuple[Extremum, ...]
    margins: Margins | None = None
    closed: ClosedFigures | None = None


@dataclass(frozen=True)
class Family:
    """Responses of the same pair of signals.

    Attributes:
        stem: for files, such as `velocity_open`.
        title: for people.
        curves: at least one.
    """

    stem: str
    title: str
    curves: tuple[Curve, ...]


def mechanics_family(plant: Plant, given: str, output: str, cases: Sequence[Case], low: float, high: float) -> Family:
    """The mechanics in every case, between two frequencies [Hz].

    Raises:
        InputError: as `servo.mechanics_response.mechanics`.
    """
    responses = [mechanics(plant, given, output, case, low, high) for case in cases]
    return Family("mechanics", f"{_words(output)} over {_words(given)}", _curves(cases, responses))


def open_family(plant: Plant, cascade: Cascade, loop: Loop, cases: Sequence[Case], low: float, high: float) -> Family:
    """An open loop with its margins in every case.

    Raises:
        InputError: as `servo.loop_response.open_response`.
    """
    found = [open_response(plant, cascade, loop, case, low, high) for case in cases]
    curves = tuple(
        Curve(case, response, extrema(response.frequency, response.values), margins=margins)
        for case, (response, margins) in zip(cases, found, strict=True)
    )
    return Family(f"{loop}_open", f"{loop} loop, open", curves)


def closed_family(plant: Plant, cascade: Cascade, loop: Loop, cases: Sequence[Case], low: float, high: float) -> Family:
    """A closed loop from its set-point to what it measures, in every case.

    Raises:
        InputError: as `servo.loop_response.closed_response`.
    """
    responses = [closed_response(plant, cascade, loop, case, low, high) for case in cases]
    curves = tuple(
        Curve(case, response, extrema(response.frequency, response.values), closed=closed_figures(response))
        for case, response in zip(cases, responses, strict=True)
    )
    return Family(f"{loop}_closed", f"{loop} loop, closed", curves)


def controlled_family(
    plant: Plant, cascade: Cascade, given: str, output: str, cases: Sequence[Case], low: float, high: float
) -> Family:
    """The controlled axis from one signal to another, in every case.

    Raises:
        InputError: as `servo.loop_response.controlled_response`.
    """
    responses = [controlled_response(plant, cascade, given, output, case, low, high) for case in cases]
    title = f"controlled axis: {_words(output)} over {_words(given)}"
    return Family("controlled", title, _curves(cases, responses))


def _curves(cases: Sequence[Case], responses: Sequence[Response]) -> tuple[Curve, ...]:
    return tuple(
        Curve(case, response, extrema(response.frequency, response.values))
        for case, response in zip(cases, responses, strict=True)
    )


def _words(name: str) -> str:
    return name.replace("_", " ")


def family_content(family: Family) -> dict[str, Any]:
    """A family with all its curves."""
    response = family.curves[0].response
    return {
        "title": family.title,
        "from": response.given,
        "to": response.output,
        "unit": response.unit,
        "curves": [_curve(curve) for curve in family.curves],
    }


def margins_content(margins: Margins) -> dict[str, Any]:
    """Margins of a loop; None where one does not exist."""
    return {
        "gain_db": finite(margins.gain),
        "gain_frequency": finite(margins.gain_frequency),
        "phase_deg": finite(margins.phase),
        "phase_frequency": finite(margins.phase_frequency),
        "sensitivity_peak": finite(margins.sensitivity),
        "stable": margins.stable,
    }


def measured_content(frequency: FloatArray, values: ComplexArray, coherence: FloatArray) -> dict[str, Any]:
    """A measured response."""
    return {
        "frequency": frequency.tolist(),
        "magnitude_db": decibel(values).tolist(),
        "phase_deg": degrees(values).tolist(),
        "coherence": [finite(float(value)) for value in coherence],
    }


def finite(value: float) -> float | None:
    """A number for JSON; None where it is not finite."""
    return value if math.isfinite(value) else None


def _curve(curve: Curve) -> dict[str, Any]:
    response = curve.response
    return {
        **asdict(curve.case),
        "frequency": response.frequency.tolist(),
        "magnitude_db": response.decibel.tolist(),
        "phase_deg": response.degrees.tolist(),
        "resonances": [_root(root, curve) for root in response.marks],
        "extrema": [asdict(one) for one in curve.seen],
        "margins": margins_content(curve.margins) if curve.margins else None,
        "closed": {key: finite(value) for key, value in asdict(curve.closed).items()} if curve.closed else None,
    }


def _root(root: Resonance, curve: Curve) -> dict[str, Any]:
    seen = on_curve(root, curve.seen)
    return {**asdict(root), "seen_at": seen.frequency if seen else None, "seen_db": seen.decibel if seen else None}
