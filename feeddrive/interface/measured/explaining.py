"""Measurements other than recordings over time, against an axis: numbers, or a frequency response."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from feeddrive.diagnosis.numbers.measured_file import read_measured_numbers
from feeddrive.diagnosis.numbers.numbers_result import NumbersResult, diagnose_numbers, numbers_record, plant_text_after
from feeddrive.diagnosis.responses.response_result import (
    ResponseResult,
    diagnose_response,
    response_plant_text,
    response_record,
)
from feeddrive.errors import InputError
from feeddrive.export.point import export_point
from feeddrive.files import write_bytes_atomically, write_text_atomically
from feeddrive.interface.axis import Axis, axis_of, axis_of_text
from feeddrive.interface.measured.reading import read_response_file
from feeddrive.interface.servo import Servo, cascade_for
from feeddrive.interface.shown import Listing, Shown, write_json
from feeddrive.plant.file.named_parts import with_named_parts
from feeddrive.recording.frequency_response import FrequencyResponse
from feeddrive.report.words.explained_words import numbers_verdict, response_verdict, value_text
from feeddrive.servo.mechanics_response import Case
from feeddrive.units.quantity import format_quantity

if TYPE_CHECKING:
    from feeddrive.report.figures.drawing import ReportFigure


@dataclass(frozen=True, repr=False, eq=False)
class Explained(Shown):
    """What measured numbers, or a measured frequency response, say of an axis.

    Attributes:
        axis: as it was declared.
        result: everything, plain values, SI.
    """

    axis: Axis
    result: NumbersResult | ResponseResult

    @property
    def verdict(self) -> str:
        """What is other than declared, or that nothing has to be; what is possible, and what to measure next."""
        result = self.result
        return " ".join(numbers_verdict(result) if isinstance(result, NumbersResult) else response_verdict(result))

    def __repr__(self) -> str:
        """The verdict."""
        return self.verdict

    @property
    def plant(self) -> Axis:
        """The axis with what is asserted."""
        return axis_of_text(self._text_after(), self.axis.path)

    def record(self) -> dict[str, Any]:
        """The content of `diagnosis.json`."""
        result = self.result
        return numbers_record(result) if isinstance(result, NumbersResult) else response_record(result)

    def listing(self) -> Listing:
        """Each value alone made to meet the numbers; of a frequency response one row per value that was found."""
        result = self.result
        return _singles(self.axis, result) if isinstance(result, NumbersResult) else _found(self.axis, result)

    def save(self, folder: str | Path) -> Path:
        """Write `diagnosis.json`, `plant_after.toml`, `report.html` and the figure.

        Raises:
            InputError: the folder cannot be written.
        """
        from feeddrive.report.figures.drawing import render
        from feeddrive.report.pages.explained_page import numbers_page, response_page

        place, result = Path(folder), self.result
        picture = render(self._figures()[0])
        page = numbers_page(result, picture) if isinstance(result, NumbersResult) else response_page(result, picture)
        write_text_atomically(place / "plant_after.toml", self._text_after())
        write_bytes_atomically(place / f"{picture.stem}.png", picture.png)
        write_text_atomically(place / "report.html", page)
        write_json(self.record(), place / "diagnosis.json", indent=1)
        return place

    def _text_after(self) -> str:
        text, result = self.axis.text, self.result
        return (
            plant_text_after(text, result) if isinstance(result, NumbersResult) else response_plant_text(text, result)
        )

    def _figures(self) -> tuple[ReportFigure, ...]:
        from feeddrive.report.figures.figure_response import numbers_figure, response_fit_figure

        result = self.result
        return (numbers_figure(result) if isinstance(result, NumbersResult) else response_fit_figure(result),)


def _singles(axis: Axis, result: NumbersResult) -> Listing:
    rows, records = [], []
    for one in result.singles:
        value, number = one.value, one.value.number(one.coordinate)
        declared = "rigid" if value.missing else format_quantity(value.value, value.unit)
        rows.append([value.words, declared, value_text(value, number), "yes" if one.meets else "no"])
        records.append({"key": value.key, "value": number, "unit": value.unit, "meets": one.meets})
    title = f"{axis.name}: each value alone made to meet the numbers"
    return Listing(title, ("value", "declared", "would be", "meets all numbers"), rows, records)


def _found(axis: Axis, result: ResponseResult) -> Listing:
    rows, records = [], []
    for one in result.found:
        for number in one.parameters:
            shown = [format_quantity(value, number.unit) for value in (number.value, *number.interval)]
            rows.append([one.words, number.key, shown[0], f"[{shown[1]}, {shown[2]}]", f"{one.log_odds:.1f}"])
            records.append({"name": one.name, "key": number.key, "value": number.value, "unit": number.unit,
                            "ci95": number.interval, "log_odds": one.log_odds})  # fmt: skip
    title = f"{axis.name}: other than declared" if rows else f"{axis.name}: nothing other than declared"
    return Listing(title, ("found", "key", "value", "95 % interval", "log odds"), rows, records)


def explain(
    axis: Axis | str | Path,
    measured: str | Path | FrequencyResponse,
    *,
    at: str = "",
    controller: Servo | str | Path | None = None,
    progress: Callable[[str], None] | None = None,
) -> Explained:
    """Trace the difference of measured numbers, or of a measured frequency response, from an axis.

    Args:
        axis: as declared, without effects or values that were put in; its plant file, or the name of a shipped machine.
        measured: TOML file with `[[measured]]` tables, or a frequency response or its file.
        at: operating point of a frequency response, "x=200 mm, v=3 m/min"; the middle of the stroke in slow motion.
        controller: of `tune`, or a controller or scenario file, under which a response of the speed loop was measured.
        progress: called with a word for what is being done.

    Raises:
        InputError: a file that cannot be used, or a number that this axis cannot give.

    >>> import feeddrive as fd
    >>> found = fd.explain(fd.load("kimm_testbed"), "scenarios/measured/kimm_testbed.toml")
    >>> len(found.result.beyond)
    0
    """
    axis = axis_of(axis)
    entries = with_named_parts(axis.entries, str(axis.path))
    if axis.values or axis.added:
        raise InputError("the axis was changed after it was loaded", axis.name, "save it, and load the file")
    report = progress or (lambda _: None)
    if not isinstance(measured, FrequencyResponse) and Path(measured).suffix.lower() == ".toml":
        numbers = read_measured_numbers(Path(measured), axis.plant)
        return Explained(axis, diagnose_numbers(entries, axis.path, axis.plant, numbers, report))
    response = measured if isinstance(measured, FrequencyResponse) else read_response_file(Path(measured))
    if response is None:
        what = "is neither measured numbers nor a frequency response"
        raise InputError(what, str(measured), "give recordings over time to diagnose")
    point = export_point(axis.plant, at, "at")
    case = Case(point.position, point.linearised_at)
    cascade = None if controller is None else cascade_for(axis.plant, controller)
    found = diagnose_response(entries, axis.path, axis.plant, response, case, report, cascade)
    return Explained(axis, found)
