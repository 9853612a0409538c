"""`feeddrive reproduce`: every number and checkable claim of the source papers beside what the program computes."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console
from rich.text import Text

from feeddrive import __version__
from feeddrive.cli.comparison import Comparison, summary_table
from feeddrive.cli.output import JsonOption, deliver, tell_written, warnings_as_lines
from feeddrive.files import write_text_atomically
from feeddrive.output_folder import output_folder, refuse_unusable
from feeddrive.reproduce.collection import as_csv, counts, find_papers, record, rows_of
from feeddrive.reproduce.row import Paper, Row

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
    with warnings_as_lines():
        rows = tuple(row for one in _announced(papers) for row in rows_of(one))
    content = _content(papers, rows)
    if out is not None:
        with output_folder(out) as folder:
            _write(content, rows, folder)
    comparisons = [Comparison(one, [row for row in rows if row.paper is one]) for one in papers]
    deliver(content, [*comparisons, summary_table(rows, papers), Text(_LEGEND)], as_json, None)
    tell_written(out, as_json)


def _announced(papers: tuple[Paper, ...]) -> Iterator[Paper]:
    """The papers one after another, each named on a terminal while it is computed; nothing in a pipe."""
    if not sys.stderr.isatty():
        yield from papers
        return
    with Console(stderr=True).status("") as status:
        for paper in papers:
            status.update(f"paper {paper.number}")
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
