"""The report on a measured frequency response: one HTML file that holds everything it shows."""

from __future__ import annotations

from feeddrive.diagnosis.responses.response_result import ResponseResult
from feeddrive.report.figures.drawing import RenderedFigure
from feeddrive.report.pages.html import page
from feeddrive.report.pages.markup import bullets, figure, number, paragraph, section, table, words
from feeddrive.report.words.response_words import response_verdict
from feeddrive.units.quantity import format_quantity

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
        section("Values within their tolerances", paragraph(_CALIBRATION), _calibrated(result)),
        section("What was tried", paragraph(_TRIED), _steps(result)),
        section("Notes", bullets(response.notes) if response.notes else ""),
    )
    return page(f"{result.problem.plant.name}: measured frequency response", under, "".join(parts))


_CALIBRATION = "Nobody knows these exactly: each is fitted under its tolerance, which is calibration and no finding."
_TRIED = "Change of the log evidence, the price of one more name included; above zero it is worth its place."


def _calibrated(result: ResponseResult) -> str:
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
