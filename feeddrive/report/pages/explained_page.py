"""The reports on measured numbers and on a measured frequency response: one HTML file each."""

from __future__ import annotations

import math

from feeddrive.diagnosis.numbers.numbers_result import NumbersResult
from feeddrive.diagnosis.responses.response_result import ResponseResult
from feeddrive.report.figures.drawing import RenderedFigure
from feeddrive.report.pages.html import page
from feeddrive.report.pages.markup import bullets, figure, paragraph, section, table, verdict
from feeddrive.report.words.explained_words import numbers_verdict, odds_text, response_verdict, value_text
from feeddrive.units.quantity import format_quantity, percent

_SETS, _FURTHER = 8, 6


def numbers_page(result: NumbersResult, picture: RenderedFigure) -> str:
    """The page as text."""
    title = f"{result.problem.plant.name}: measured numbers"
    parts = (
        verdict(numbers_verdict(result), calm=not (result.beyond or result.suspects)),
        section("Numbers", _numbers(result), figure(picture)),
        section("Each value alone", paragraph("All other values exactly as declared."), _singles(result)),
        section("Values within their tolerances", paragraph(_CALIBRATION), _calibrated(result)),
        section("Which values are beyond their tolerances", _sets(result)),
        section("What to measure next", paragraph(_NEXT), _further(result)),
        section("Sources", bullets(f"{one.name}: {one.source}" for one in result.problem.measured if one.source)),
    )
    under = "Measured numbers against the values that the plant file declares."
    return page(title, under, "".join(parts))


_CALIBRATION = (
    "Nobody knows these exactly: each is fitted under its tolerance, which is calibration and no finding. Where the "
    "interval is as wide as the tolerance, the numbers hold no information about the value."
)
_NEXT = "Information about the values that the numbers depend on, for a measurement of usual care."


def _numbers(result: NumbersResult) -> str:
    rows = []
    for one, declared, after in zip(result.problem.measured, result.declared, result.after, strict=True):
        unit = one.kind.unit
        shown = [format_quantity(value, unit) for value in (one.value, 2 * one.deviation, declared, after)]
        errors = [f"{100 * (value / one.value - 1):+.1f} %" for value in (declared, after)]
        name = one.name.replace("_", " ")
        rows.append([name, shown[0], f"± {shown[1]}", shown[2], errors[0], shown[3], errors[1]])
    return table(["number", "#measured", "#tolerance", "#declared", "#error", "#most likely", "#error"], rows)


def _singles(result: NumbersResult) -> str:
    rows = [
        [
            one.value.words,
            value_text(one.value, None if one.value.missing else one.value.value),
            value_text(one.value, one.value.number(one.coordinate)),
            "yes" if one.meets else "no",
            one.value.settled_by,
        ]
        for one in result.singles
    ]
    heads = ["value", "#declared", "#would be", "#meets all numbers", "what would single it out"]
    return table(heads, rows)


def _calibrated(result: NumbersResult) -> str:
    rows = [
        [
            one.value.words,
            f"± {100 * math.expm1(2 * one.spread_before):.2g} %",
            f"{100 * (one.factor - 1):+.1f} %",
            f"[{100 * (one.interval[0] - 1):+.1f}, {100 * (one.interval[1] - 1):+.1f}] %",
        ]
        for one in result.calibrated
    ]
    return table(["value", "#tolerance", "#moved by", "#95 % interval"], rows)


def _sets(result: NumbersResult) -> str:
    values = result.problem.values
    rows = [
        [
            " and ".join(values[place].words for place in one.beyond) or "none",
            percent(one.probability, 1),
            odds_text(one.probability),
        ]
        for one in result.sets[:_SETS]
    ]
    return table(["beyond its tolerance", "#probability", "#odds"], rows)


def _further(result: NumbersResult) -> str:
    rows = [[one.name.replace("_", " "), f"{one.information:.1f} bit", one.how] for one in result.further[:_FURTHER]]
    return table(["measurement", "#information", "how"], rows)


_STEPS = 12


def response_page(result: ResponseResult, picture: RenderedFigure) -> str:
    """The page as text."""
    response, case = result.problem.response, result.problem.case
    under = (
        f"{response.source or response.name}, {len(response.frequency)} lines; table at "
        f"{format_quantity(case.position, 'm')}, moving at {format_quantity(case.velocity, 'm/s')}."
    )
    parts = (
        verdict(response_verdict(result), calm=not result.asserted),
        section("Response", figure(picture)),
        section("Values within their tolerances", paragraph(_CALIBRATED), _calibrated_of_response(result)),
        section("What was tried", paragraph(_TRIED), _steps(result)),
        section("Notes", bullets(response.notes) if response.notes else ""),
    )
    return page(f"{result.problem.plant.name}: measured frequency response", under, "".join(parts))


_CALIBRATED = "Nobody knows these exactly: each is fitted under its tolerance, which is calibration and no finding."
_TRIED = "Change of the log evidence, the price of one more name included; above zero it is worth its place."


def _calibrated_of_response(result: ResponseResult) -> str:
    rows = [
        [
            name,
            f"{100 * (factor - 1):+.2g} %",
            f"[{100 * (low - 1):+.2g}, {100 * (high - 1):+.2g}] %",
        ]
        for name, factor, (low, high) in result.calibrated_values
    ]
    return table(["value", "#moved by", "#95 % interval"], rows) if rows else ""


def _steps(result: ResponseResult) -> str:
    rows = [
        [step.name, f"{step.gain:+.1f}", "taken" if step.taken else ""]
        for step in sorted(result.steps, key=lambda one: -one.gain)[:_STEPS]
    ]
    return table(["candidate", "#log evidence", "result"], rows) if rows else ""
