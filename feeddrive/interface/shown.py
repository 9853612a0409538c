"""Results that show themselves: a table as text, as HTML in a notebook, as a pandas DataFrame; a figure as PNG."""

from __future__ import annotations

import base64
import json
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

from feeddrive.errors import InputError
from feeddrive.files import write_bytes_atomically, write_text_atomically

if TYPE_CHECKING:
    import pandas
    from matplotlib.figure import Figure

    from feeddrive.report.figures.drawing import ReportFigure

MOST_ROWS = 30
"""Rows that are shown as text or HTML; `to_pandas` has all."""


@dataclass(frozen=True)
class Listing:
    """A table for people and for programs.

    Attributes:
        title: one line.
        headings: of the columns, as shown.
        rows: cells as shown, each row as long as the headings.
        records: the same rows for programs: key with its SI unit, such as "position [m]", to value.
        caption: below the table; empty where there is nothing to add.
    """

    title: str
    headings: Sequence[str]
    rows: Sequence[Sequence[str]]
    records: Sequence[dict[str, Any]] = ()
    caption: str = ""

    def text(self) -> str:
        """Title, headings and rows in columns of equal width."""
        shown = [list(self.headings), *(list(row) for row in self.rows[:MOST_ROWS])]
        widths = [max(len(row[column]) for row in shown) for column in range(len(self.headings))]
        lines = [
            "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip() for row in shown
        ]
        more = [f"… {len(self.rows) - MOST_ROWS} more"] if len(self.rows) > MOST_ROWS else []
        return "\n".join([self.title, *lines, *more, *([self.caption] if self.caption else [])])

    def html(self) -> str:
        """The table as HTML."""
        head = "".join(f"<th>{escape(heading)}</th>" for heading in self.headings)
        body = "".join(
            "<tr>" + "".join(f"<td>{escape(cell)}</td>" for cell in row) + "</tr>" for row in self.rows[:MOST_ROWS]
        )
        return f"<table><caption>{escape(self.title)}</caption><tr>{head}</tr>{body}</table>"


class Shown:
    """A result that is a table; what it is drawn as, if anything, `_figures` gives."""

    def listing(self) -> Listing:
        """The table."""
        raise NotImplementedError

    def tables(self) -> tuple[Listing, ...]:
        """Every table; the one alone where there are no others."""
        return (self.listing(),)

    def _figures(self) -> Sequence[ReportFigure]:
        """The figures, the telling one first; none where there is nothing to draw."""
        return ()

    def __repr__(self) -> str:
        """The table as text."""
        return self.listing().text()

    def _repr_html_(self) -> str:
        """The table and the first figure, as a notebook shows them."""
        drawn = "".join(_picture(one) for one in self._figures()[:1])
        return self.listing().html() + drawn

    def to_pandas(self) -> pandas.DataFrame:
        """All rows as a DataFrame, columns in SI with their unit in brackets.

        Raises:
            InputError: pandas is not installed.
        """
        found: pandas.DataFrame = needed_pandas().DataFrame(list(self.listing().records))
        return found

    def plot(self) -> Figure:
        """The figure, of Matplotlib; `figure.savefig("x.png")` writes it.

        Raises:
            InputError: nothing to draw.
        """
        return self._telling().figure

    def save_figure(self, path: str | Path) -> Path:
        """Write the figure as PNG.

        Raises:
            InputError: nothing to draw, or the file cannot be written.
        """
        from feeddrive.report.figures.drawing import render  # matplotlib takes time to import

        write_bytes_atomically(Path(path), render(self._telling()).png)
        return Path(path)

    def _telling(self) -> ReportFigure:
        figures = self._figures()
        if not figures:
            raise InputError("there is nothing to draw", self.listing().title, "look at its table")
        return figures[0]


def write_json(content: Mapping[str, Any], path: Path, indent: int = 2) -> None:
    """Write plain values as JSON, whole or not at all.

    Raises:
        InputError: the file cannot be written.
    """
    write_text_atomically(path, json.dumps(content, indent=indent, ensure_ascii=False, allow_nan=False) + "\n")


def write_figures(figures: Iterable[ReportFigure], folder: Path) -> None:
    """Write each figure as PNG under its own name.

    Raises:
        InputError: a file cannot be written.
    """
    from feeddrive.report.figures.drawing import render  # matplotlib takes time to import

    for one in figures:
        drawn = render(one)
        write_bytes_atomically(folder / f"{drawn.stem}.png", drawn.png)


def finite(value: float | None) -> float | None:
    """A number for JSON; None where it is not finite."""
    return None if value is None or not math.isfinite(value) else float(value)


def needed_pandas() -> Any:
    """The pandas module.

    Raises:
        InputError: it is not installed.
    """
    try:
        import pandas
    except ImportError:
        raise InputError("pandas is not installed", "to_pandas", "pip install 'feeddrive[pandas]'") from None
    return pandas


def _picture(drawn: ReportFigure) -> str:
    from feeddrive.report.figures.drawing import render

    made = render(drawn)
    data = base64.b64encode(made.png).decode()
    return (
        f'<figure><img alt="{escape(made.title)}" src="data:image/png;base64,{data}" style="max-width:100%"></figure>'
    )
