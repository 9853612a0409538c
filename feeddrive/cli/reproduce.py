"""`feeddrive reproduce`: every number and checkable claim of the source papers beside what the program computes."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console, ConsoleOptions, RenderableType, RenderResult
from rich.padding import Padding
from rich.table import Table
from rich.text import Text

from feeddrive import __version__
from feeddrive.cli.output import JsonOption, deliver, print_written, warnings_as_lines, working
from feeddrive.files import write_text_atomically
from feeddrive.output_folder import output_folder, refuse_unusable
from feeddrive.reproduce.collection import as_csv, counts, find_papers, record, rows_of
from feeddrive.reproduce.row import Paper, Row, Status

HEADINGS = ("place", "quantity", "printed", "computed", "deviation", "status")
SHORT = {
    Status.REPRODUCED: "reproduced",
    Status.ASSUMPTION: "assumed",
    Status.FITTED: "fitted",
    Status.PAPER_ONLY: "paper only",
    Status.CONTRADICTED: "contradicted",
    Status.NOT_POSSIBLE: "not possible",
}
"""Status in a column; what was assumed or fitted stands under the row."""

_WIDE = 100
"""Letters in a line from which on all columns stand side by side."""

_NARROWEST = 60
_DEVIATION, _STATUS, _PLACE, _GAP, _INDENT = 9, 12, 13, 2, 4
_NUMBERS = HEADINGS.index("deviation")
_SHARES = (0.17, 0.38, 0.2, 0.25)
"""Shares of the width beside deviation and status: place, quantity, printed, computed."""


_LEGEND = """\
reproduced: a law of the package gives the printed value from printed ones. assumed: with the assumption under the row.
fitted: a value was chosen so that it comes out. paper only: printed numbers and equations among themselves, no law of
the package. contradicted: the law gives another value. deviation: (computed - printed) / printed."""


def command(
    paper: Annotated[str | None, typer.Option("--paper", help="One paper alone, such as 004.")] = None,
    as_json: JsonOption = False,
    out: Annotated[
        Path | None, typer.Option("--out", help="Folder for reproduce.csv and reproduce.json, written besides.")
    ] = None,
) -> None:
    """Compare every number and checkable claim of the source papers with what the program computes."""
    papers = find_papers(paper)
    refuse_unusable(out)
    with warnings_as_lines(), working("comparing") as progress:
        rows = tuple(row for one in _announced(papers, progress) for row in rows_of(one))
    content = _content(papers, rows)
    if out is not None:
        with output_folder(out) as folder:
            _write(content, rows, folder)
    comparisons = [Comparison(one, [row for row in rows if row.paper is one]) for one in papers]
    deliver(content, [*comparisons, summary_table(rows, papers), Text(_LEGEND)], as_json, None)
    print_written(out, as_json)


def _announced(papers: tuple[Paper, ...], progress: Callable[[str], None]) -> Iterator[Paper]:
    for paper in papers:
        progress(f"paper {paper.number}")
        yield paper


def _content(papers: tuple[Paper, ...], rows: tuple[Row, ...]) -> dict[str, Any]:
    return {
        "format": "feeddrive-reproduce/2",
        "version": __version__,
        "papers": {paper.number: paper.citation for paper in papers},
        "summary": {str(status): number for status, number in counts(rows).items()},
        "rows": [record(row) for row in rows],
    }


def _write(content: dict[str, Any], rows: tuple[Row, ...], folder: Path) -> None:
    """The files of `--out`."""
    write_text_atomically(folder / "reproduce.csv", as_csv(rows))
    write_text_atomically(folder / "reproduce.json", json.dumps(content, indent=2, ensure_ascii=False) + "\n")


@dataclass(frozen=True)
class Comparison:
    """All rows of one paper, for rich: side by side where they fit, else printed and computed under the quantity."""

    paper: Paper
    rows: Sequence[Row]

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        """Heading, column headings, and every row with its reason under it."""
        yield Text(f"Paper {self.paper.number}  {self.paper.citation}", style="bold")
        if not self.rows:
            yield Text("not compared yet\n")
            return
        wide = options.max_width >= _WIDE
        yield from _wide(self.rows, options.max_width) if wide else _narrow(self.rows, options.max_width)
        yield Text("")


def _wide(rows: Sequence[Row], width: int) -> Iterator[RenderableType]:
    free = width - _DEVIATION - _STATUS - _GAP * (len(HEADINGS) - 1)
    place, quantity, printed = (round(share * free) for share in _SHARES[:3])
    widths = (place, quantity, printed, free - place - quantity - printed, _DEVIATION, _STATUS)
    yield _line(HEADINGS, widths)
    yield Text("─" * width)
    for row in rows:
        yield _line(cells(row), widths)
        if row.reason:
            yield _under(row.reason, _INDENT)


def _narrow(rows: Sequence[Row], width: int) -> Iterator[RenderableType]:
    widths = (_PLACE, max(width, _NARROWEST) - _PLACE - _STATUS - 2 * _GAP, _STATUS)
    yield _line((HEADINGS[0], f"{HEADINGS[1]}: {', '.join(HEADINGS[2:5])}", HEADINGS[5]), widths)
    yield Text("─" * width)
    for row in rows:
        place, quantity, printed, computed, deviation, status = cells(row)
        yield _line((place, quantity, status), widths)
        named = (("printed", printed), ("computed", computed), ("deviation", deviation))
        yield _under("; ".join(f"{name} {text}" for name, text in named if text), _PLACE + _GAP, "")
        if row.reason:
            yield _under(row.reason, _PLACE + _GAP)


def cells(row: Row) -> tuple[str, ...]:
    """Texts of a row under `HEADINGS`."""
    printed, computed = _with_unit(row.printed, row.unit), _with_unit(row.computed, row.unit)
    return row.place, row.quantity, printed, computed, deviation_text(row.deviation), SHORT[row.status]


def deviation_text(deviation: float | None) -> str:
    """A relative deviation in per cent, no digits that mean nothing; empty where there is none."""
    if deviation is None:
        return ""
    percent = 100.0 * deviation
    if abs(percent) < 0.005:
        return "0 %"
    return f"{percent:+.2f} %" if abs(percent) < 1.0 else f"{percent:+.1f} %"


def summary_table(rows: Sequence[Row], papers: Sequence[Paper]) -> Table:
    """How many rows of each paper have each status."""
    made = Table(title="Summary", title_justify="left", title_style="bold")
    for heading in ("paper", *SHORT.values(), "rows"):
        made.add_column(heading, justify="left" if heading == "paper" else "right")
    for paper in papers:
        made.add_row(paper.number, *_counted([row for row in rows if row.paper is paper]))
    if len(papers) > 1:
        made.add_section()
        made.add_row("all", *_counted(rows))
    return made


def _counted(rows: Sequence[Row]) -> list[str]:
    return [*(str(sum(row.status is status for row in rows)) for status in SHORT), str(len(rows))]


def _line(texts: Sequence[str], widths: Sequence[int]) -> Table:
    """One row, its cells wrapped at words."""
    made = Table.grid(padding=(0, _GAP, 0, 0), pad_edge=False)
    for column, width in enumerate(widths):
        made.add_column(width=width, overflow="fold", justify="right" if column == _NUMBERS else "left")
    made.add_row(*(Text(text) for text in texts))
    return made


def _under(text: str, indent: int, style: str = "dim") -> Padding:
    return Padding(Text(text, style=style, overflow="fold"), (0, 0, 0, indent))


def _with_unit(text: str, unit: str) -> str:
    """Text with its unit where it holds a number: "curves" has none."""
    return f"{text} {unit}" if unit and any(letter.isdigit() for letter in text) else text
