"""The reports on measured numbers and on a measured frequency response: one HTML file each."""

from __future__ import annotations

import math

from feeddrive.diagnosis.numbers.numbers_result import NumbersResult
from feeddrive.diagnosis.responses.response_result import ResponseResult
from feeddrive.report.figures.drawing import RenderedFigure
from feeddrive.report.pages.html import page
from feeddrive.report.pages.markup import Cell, bullets, figure, number, paragraph, section, table, words
from feeddrive.report.words.explained_words import numbers_verdict, odds_text, response_verdict, value_text
from feeddrive.units.quantity import format_quantity

_SETS, _FURTHER = 8, 6


def numbers_page(result: NumbersResult, picture: RenderedFigure) -> str:
    """The page as text."""
    title = f"{result.problem.plant.name}: measured numbers"
    parts = (
        _verdict(result),
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
    "interval is as wide as the tolerance, the numbers tell nothing of the value."
)
_NEXT = "Information about the values that the numbers depend on, for a measurement of usual care."


def _verdict(result: NumbersResult) -> str:
    """The main finding large, the rest below it; blue where nothing has to be other."""
    main, *others = numbers_verdict(result)
    kind = "verdict" if result.beyond or result.suspects else "verdict clean"
    return f'<div class="{kind}">{paragraph(main, "main")}{"".join(map(paragraph, others))}</div>'


def _heads(*names: str) -> list[Cell]:
    return [words(name) if i == 0 else number(name) for i, name in enumerate(names)]


def _numbers(result: NumbersResult) -> str:
    rows = []
    for one, declared, after in zip(result.problem.measured, result.declared, result.after, strict=True):
        unit = one.kind.unit
        shown = [format_quantity(value, unit) for value in (one.value, 2 * one.deviation, declared, after)]
        errors = [f"{100 * (value / one.value - 1):+.1f} %" for value in (declared, after)]
        rows.append(
            [
                words(one.name.replace("_", " ")),
                number(shown[0]),
                number(f"± {shown[1]}"),
                number(shown[2]),
                number(errors[0]),
                number(shown[3]),
                number(errors[1]),
            ]
        )
    return table(_heads("number", "measured", "tolerance", "declared", "error", "most likely", "error"), rows)


def _singles(result: NumbersResult) -> str:
    rows = [
        [
            words(one.value.words),
            number(value_text(one.value, None if one.value.missing else one.value.value)),
            number(value_text(one.value, one.value.number(one.coordinate))),
            number("yes" if one.meets else "no"),
            words(one.value.settled_by),
        ]
        for one in result.singles
    ]
    heads = [*_heads("value", "declared", "would be", "meets all numbers"), words("what would single it out")]
    return table(heads, rows)


def _calibrated(result: NumbersResult) -> str:
    rows = [
        [
            words(one.value.words),
            number(f"± {100 * math.expm1(2 * one.spread_before):.2g} %"),
            number(f"{100 * (one.factor - 1):+.1f} %"),
            number(f"[{100 * (one.interval[0] - 1):+.1f}, {100 * (one.interval[1] - 1):+.1f}] %"),
        ]
        for one in result.calibrated
    ]
    return table(_heads("value", "tolerance", "moved by", "95 % interval"), rows)


def _sets(result: NumbersResult) -> str:
    values = result.problem.values
    rows = [
        [
            words(" and ".join(values[place].words for place in one.beyond) or "none"),
            number(f"{one.probability:.1%}"),
            number(odds_text(one.probability)),
        ]
        for one in result.sets[:_SETS]
    ]
    return table(_heads("beyond its tolerance", "probability", "odds"), rows)


def _further(result: NumbersResult) -> str:
    rows = [
        [words(one.name.replace("_", " ")), number(f"{one.information:.1f} bit"), words(one.how)]
        for one in result.further[:_FURTHER]
    ]
    return table([*_heads("measurement", "information"), words("how")], rows)


_STEPS = 12


def response_page(result: ResponseResult, picture: RenderedFigure) -> str:
    """The page as text."""
    main, *others = response_verdict(result)
    kind = "verdict" if result.asserted else "verdict clean"
    verdict = f'<div class="{kind}">{paragraph(main, "main")}{"".join(map(paragraph, others))}</div>'
    response, case = result.problem.response, result.problem.case
    under = (
        f"{response.source or response.name}, {len(response.frequency)} lines; table at "
        f"{format_quantity(case.position, 'm')}, moving at {format_quantity(case.velocity, 'm/s')}."
    )
    parts = (
        verdict,
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
            words(name),
            number(f"{100 * (factor - 1):+.2g} %"),
            number(f"[{100 * (low - 1):+.2g}, {100 * (high - 1):+.2g}] %"),
        ]
        for name, factor, (low, high) in result.calibrated_values
    ]
    return table([words("value"), number("moved by"), number("95 % interval")], rows) if rows else ""


def _steps(result: ResponseResult) -> str:
    rows = [
        [words(step.name), number(f"{step.gain:+.1f}"), words("taken" if step.taken else "")]
        for step in sorted(result.steps, key=lambda one: -one.gain)[:_STEPS]
    ]
    return table([words("candidate"), number("log evidence"), words("")], rows) if rows else ""
