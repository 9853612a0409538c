"""What measured numbers say of an axis: a stiffness, a natural frequency, a drag torque, a lost motion."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from feeddrive.diagnosis.numbers.numbers_result import (
    NumbersResult,
    numbers_json,
    numbers_record,
    plant_text_after,
)
from feeddrive.files import write_bytes_atomically, write_text_atomically
from feeddrive.interface.axis import Axis, axis_of_text
from feeddrive.interface.shown import Listing, Shown
from feeddrive.report.words.numbers_words import numbers_verdict, value_text
from feeddrive.units.quantity import format_quantity

if TYPE_CHECKING:
    from feeddrive.report.figures.drawing import ReportFigure


@dataclass(frozen=True, repr=False, eq=False)
class Explained(Shown):
    """What measured numbers say of an axis.

    Attributes:
        axis: as it was declared.
        result: everything, plain values, SI.
    """

    axis: Axis
    result: NumbersResult

    @property
    def verdict(self) -> str:
        """Which values are other than declared, or that none has to be; what would be measured next."""
        return " ".join(numbers_verdict(self.result))

    def __repr__(self) -> str:
        """The verdict."""
        return self.verdict

    @property
    def plant(self) -> Axis:
        """The axis with the values that are asserted."""
        return axis_of_text(plant_text_after(self.axis.text, self.result), self.axis.path)

    def record(self) -> dict[str, Any]:
        """The content of `diagnosis.json`."""
        return numbers_record(self.result)

    def listing(self) -> Listing:
        """Each value alone made to meet the numbers."""
        singles = self.result.singles
        records = [
            {
                "key": one.value.key,
                "value": one.value.number(one.coordinate),
                "unit": one.value.unit,
                "meets": one.meets,
            }
            for one in singles
        ]
        rows = [
            [
                one.value.words,
                "rigid" if one.value.missing else format_quantity(one.value.value, one.value.unit),
                value_text(one.value, one.value.number(one.coordinate)),
                "yes" if one.meets else "no",
            ]
            for one in singles
        ]
        title = f"{self.axis.name}: each value alone made to meet the numbers"
        return Listing(title, ("value", "declared", "would be", "meets all numbers"), rows, records)

    def save(self, folder: str | Path) -> Path:
        """Write `diagnosis.json`, `plant_after.toml`, `report.html` and the figure.

        Raises:
            InputError: the folder cannot be written.
        """
        from feeddrive.report.figures.drawing import render
        from feeddrive.report.pages.numbers_page import write_numbers_page

        place = Path(folder)
        picture = render(self._figures()[0])
        write_text_atomically(place / "plant_after.toml", plant_text_after(self.axis.text, self.result))
        write_bytes_atomically(place / f"{picture.stem}.png", picture.png)
        write_numbers_page(self.result, picture, place / "report.html")
        write_text_atomically(place / "diagnosis.json", numbers_json(self.result))
        return place

    def _figures(self) -> Sequence[ReportFigure]:
        from feeddrive.report.figures.figure_numbers import numbers_figure

        return (numbers_figure(self.result),)
