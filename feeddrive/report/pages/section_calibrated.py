"""The declared values that were fitted within their tolerances, as a section of the report and as lines."""

from __future__ import annotations

from feeddrive.diagnosis.calibration.calibrated_result import CalibratedResult
from feeddrive.diagnosis.judging.result import Diagnosis
from feeddrive.report.pages.markup import number, paragraph, section, table, words
from feeddrive.report.words.people import DASH
from feeddrive.units.quantity import format_quantity

_NOTE = (
    "Nobody knows these values exactly. They were fitted within their tolerances before anything was named; each is "
    "what the recordings say of it alone, so that intervals of values that the recordings see only together are wide. "
    "They stand in plant_after.toml, and are no finding."
)


def calibrated_section(diagnosis: Diagnosis) -> str:
    """A table of the calibrated values; nothing where all were taken as exact."""
    heads = [
        words("Declared value"),
        number("declared"),
        number("tolerance"),
        number("calibrated"),
        number("95 % interval"),
    ]
    rows = [[words(shown[0]), *map(number, shown[1:])] for shown in map(_shown, diagnosis.calibrated)]
    return section("Declared values, calibrated", table(heads, rows), paragraph(_NOTE, "note")) if rows else ""


def calibrated_lines(diagnosis: Diagnosis) -> list[str]:
    """A line for every calibrated value."""
    lines = []
    for one in diagnosis.calibrated:
        name, declared, tolerance, value, interval = _shown(one)
        was = "declared" if one.unit == "1" else f"declared {declared}"
        lines.append(f"calibrated: {name} {value} [{interval}] ({was} ± {tolerance})")
    return lines


def _shown(one: CalibratedResult) -> list[str]:
    """Name, declared value, tolerance, value and interval; those of a factor as shares of what is declared."""
    scale, unit = (100.0 / one.declared, "%") if one.unit == "1" else (1.0, one.unit)
    low, high = (_text(scale * end, unit) for end in one.ci95)
    declared, value = (_text(scale * size, unit) for size in (one.declared, one.value))
    return [one.words, declared, f"{one.tolerance:.0%}".replace("%", " %"), value, f"{low} {DASH} {high}"]


def _text(value: float, unit: str) -> str:
    return f"{value:.4g} %" if unit == "%" else format_quantity(value, unit)
