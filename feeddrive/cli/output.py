"""What the commands that answer with tables share: tables or JSON, on the terminal or into a file."""

from __future__ import annotations

import io
import json
import math
import os
import sys
import warnings
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console, RenderableType
from rich.progress import Progress, SpinnerColumn, TextColumn, TimeElapsedColumn
from rich.table import Table

from feeddrive.errors import ValidityWarning, printable, quoted
from feeddrive.files import write_text_atomically

JsonOption = Annotated[bool, typer.Option("--json", help="JSON in place of tables; SI units.")]
OutOption = Annotated[Path | None, typer.Option("--out", help="File to write to, in place of the terminal.")]

LONGEST_LINE = 800
"""Letters of a warning, or of where the files are."""

_LONGEST_NAME = 32
"""Letters of a name that a table never breaks; paths are longer."""

_WIDTH = 120
"""Of tables in a file, and in a pipe whose reader names no width in COLUMNS; in letters."""


def table(title: str, headings: Sequence[str], rows: Sequence[Sequence[str]]) -> Table:
    """A table with a title; every cell is text. A narrow terminal breaks sentences, never names in the first column."""
    made = Table(title=printable(title), title_justify="left", title_style="bold")
    kept = bool(rows) and all(" " not in row[0] and len(row[0]) <= _LONGEST_NAME for row in rows)
    for number, heading in enumerate(headings):
        made.add_column(printable(heading), overflow="fold", no_wrap=kept and not number)
    for row in rows:
        made.add_row(*map(_printable_lines, row))
    return made


def deliver(content: dict[str, Any], tables: Sequence[RenderableType], as_json: bool, out: Path | None) -> None:
    """Show the content, or write it to a file.

    Args:
        content: for JSON.
        tables: the same for people.
        as_json: whether JSON is wanted.
        out: file; the terminal if None.

    Raises:
        InputError: the file cannot be written.
    """
    text = escaped(json.dumps(content, indent=2, ensure_ascii=False)) + "\n" if as_json else None
    if out is not None:
        write_text_atomically(out, text or _as_text(tables))
        tell_written(out, as_json)
    elif text is not None:
        typer.echo(text, nl=False)
    else:
        width = None if sys.stdout.isatty() or os.environ.get("COLUMNS", "").isdigit() else _WIDTH
        _print(Console(markup=False, highlight=False, emoji=False, width=width), tables)


@contextmanager
def working(on: str) -> Iterator[Callable[[str], None]]:
    """On a terminal a line with what is being done and the time since the start; nothing in a pipe.

    Args:
        on: what is done first.

    Yields:
        Called with what is done next.
    """
    if not sys.stderr.isatty():
        yield lambda text: None
        return
    columns = (SpinnerColumn(), TextColumn("{task.description}", markup=False), TimeElapsedColumn())
    with Progress(*columns, console=Console(stderr=True), transient=True) as shown:
        task = shown.add_task(printable(on), total=None)
        yield lambda text: shown.update(task, description=printable(text))


def tell_written(out: Path | None, as_json: bool) -> None:
    """Say after the tables where the files are; nothing where there are none, or where JSON is printed."""
    if out is not None and not as_json:
        typer.echo(f"written: {quoted(str(out.resolve()), LONGEST_LINE)}")


def finite(value: float) -> float | None:
    """The number for JSON; None where it is infinite."""
    return value if math.isfinite(value) else None


def chain_remark(valid_to: float) -> str | None:
    """What is to be said of the chain that simulations use, where it holds up to `valid_to` [Hz] only."""
    if not math.isfinite(valid_to):
        return None
    holds = f"whose modes are within 1 % up to {valid_to:.0f} Hz" if valid_to else "whose first mode is 1 % off or more"
    return f"Within 0.5 %, whatever the elements of the screw. Simulations use the declared chain, {holds}."


@contextmanager
def warnings_as_lines() -> Iterator[None]:
    """Tell what leaves the range of its formula in one line each, on stderr."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", ValidityWarning)
        yield
    told: set[str] = set()
    for warning in caught:
        if issubclass(warning.category, ValidityWarning):
            if str(warning.message) not in told:  # a plant is made more than once on the way to its figures
                tell(f"warning: {warning.message}")
            told.add(str(warning.message))
        else:
            warnings.warn_explicit(warning.message, warning.category, warning.filename, warning.lineno)


def tell(line: str) -> None:
    """Say something in one line on stderr."""
    typer.echo(quoted(line, LONGEST_LINE), err=True)


def _printable_lines(cell: str) -> str:
    return "\n".join(map(printable, cell.split("\n")))


def escaped(text: str) -> str:
    """JSON with all that a terminal obeys as escapes; it says the same."""
    kept = text.isascii() and "\x7f" not in text
    return text if kept else "".join(one if one.isprintable() or one == "\n" else json.dumps(one)[1:-1] for one in text)


def _as_text(tables: Sequence[RenderableType]) -> str:
    buffer = io.StringIO()
    _print(Console(file=buffer, markup=False, highlight=False, emoji=False, width=_WIDTH), tables)
    return buffer.getvalue()


def _print(console: Console, tables: Sequence[RenderableType]) -> None:
    for shown in tables:
        if isinstance(shown, Table) and shown.title:
            # above the table and not inside its width, where it would be broken
            title, shown.title = str(shown.title), None
            console.print(title, style="bold")
        console.print(shown)
