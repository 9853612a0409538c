"""Numbers that were measured beside the recordings, as a section of the report and as lines."""

from __future__ import annotations

from feeddrive.diagnosis.judging.result import Diagnosis
from feeddrive.diagnosis.numbers.number_rows import NumberResult
from feeddrive.report.pages.markup import number, paragraph, section, table, words
from feeddrive.units.quantity import format_quantity

_NOTE = (
    "These numbers were fitted together with the recordings, each by its own tolerance; a plant that meets them lies "
    "within. What is not met after the diagnosis contradicts the recordings, or what the plant can be. A number that "
    "is likelier to be wrong than whatever would explain it is not fitted."
)


def measured_section(diagnosis: Diagnosis) -> str:
    """A table of the measured numbers; nothing where none were given."""
    heads = [words("Measured beside the recordings"), number("measured"), number("tolerance"), number("declared plant"),
             number("with what was found"), words("met")]  # fmt: skip
    rows = [
        [words(one.number.name.replace("_", " ")), *map(number, _texts(one)), words(_met(one, "yes", "no"))]
        for one in diagnosis.measured
    ]
    return section("Measured numbers", table(heads, rows), paragraph(_NOTE, "note")) if rows else ""


def measured_lines(diagnosis: Diagnosis) -> list[str]:
    """A line for every measured number."""
    lines = []
    for one in diagnosis.measured:
        measured, tolerance, before, after = _texts(one)
        met = _met(one, "met", "not met")
        name = one.number.name.replace("_", " ")
        lines.append(f"measured: {name} {measured} ± {tolerance}, declared {before}, now {after}: {met}")
    return lines


def _met(one: NumberResult, yes: str, no: str) -> str:
    return (yes if one.met else no) if one.fitted else f"{no}, not fitted as it contradicts all else"


def _texts(one: NumberResult) -> list[str]:
    unit = one.number.kind.unit
    return [format_quantity(v, unit) for v in (one.number.value, 2 * one.number.deviation, one.before, one.after)]
