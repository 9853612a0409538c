"""Families of frequency responses: one curve per position and payload, with what is read off each."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

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
from feeddrive.servo.mechanics_response import Case, Response, mechanics
from feeddrive.servo.resonances import Extremum, extrema


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
