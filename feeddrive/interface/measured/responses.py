"""What a measured frequency response says of an axis."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from feeddrive.diagnosis.responses.response_result import (
    ResponseResult,
    response_json,
    response_plant_text,
    response_record,
)
from feeddrive.files import write_bytes_atomically, write_text_atomically
from feeddrive.interface.axis import Axis, axis_of_text
from feeddrive.interface.shown import Listing, Shown
from feeddrive.report.words.response_words import response_verdict
from feeddrive.units.quantity import format_quantity

if TYPE_CHECKING:
    from feeddrive.report.figures.drawing import ReportFigure


@dataclass(frozen=True, repr=False, eq=False)
class ExplainedResponse(Shown):
    """What a measured frequency response says of an axis.

    Attributes:
        axis: as it was declared.
        result: everything, plain values, SI.
    """

    axis: Axis
    result: ResponseResult

    @property
    def verdict(self) -> str:
        """What is other than declared, what is possible, and the error before and after."""
        return " ".join(response_verdict(self.result))

    def __repr__(self) -> str:
        """The verdict."""
        return self.verdict

    @property
    def plant(self) -> Axis:
        """The axis with what is asserted."""
        return axis_of_text(response_plant_text(self.axis.text, self.result), self.axis.path)

    def record(self) -> dict[str, Any]:
        """The content of `diagnosis.json`."""
        return response_record(self.result)

    def listing(self) -> Listing:
        """One row per value that was found."""
        rows, records = [], []
        for one in self.result.found:
            for number in one.parameters:
                shown = [format_quantity(value, number.unit) for value in (number.value, *number.interval)]
                rows.append([one.words, number.key, shown[0], f"[{shown[1]}, {shown[2]}]", f"{one.log_odds:.1f}"])
                records.append(
                    {
                        "name": one.name,
                        "key": number.key,
                        "value": number.value,
                        "unit": number.unit,
                        "ci95": number.interval,
                        "log_odds": one.log_odds,
                    }
                )
        title = f"{self.axis.name}: other than declared" if rows else f"{self.axis.name}: nothing other than declared"
        return Listing(title, ("found", "key", "value", "95 % interval", "log odds"), rows, records)

    def save(self, folder: str | Path) -> Path:
        """Write `diagnosis.json`, `plant_after.toml`, `report.html` and the figure.

        Raises:
            InputError: the folder cannot be written.
        """
        from feeddrive.report.figures.drawing import render
        from feeddrive.report.pages.response_page import write_response_page

        place = Path(folder)
        picture = render(self._figures()[0])
        write_text_atomically(place / "plant_after.toml", response_plant_text(self.axis.text, self.result))
        write_bytes_atomically(place / f"{picture.stem}.png", picture.png)
        write_response_page(self.result, picture, place / "report.html")
        write_text_atomically(place / "diagnosis.json", response_json(self.result))
        return place

    def _figures(self) -> Sequence[ReportFigure]:
        from feeddrive.report.figures.figure_response_fit import response_fit_figure

        return (response_fit_figure(self.result),)
