"""What the commands that answer with tables share: tables or JSON, on the terminal or into a file."""

from __future__ import annotations

import io
import json
import os
import sys
import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated, Any, Protocol

import typer
from rich.console import Console, RenderableType
from rich.progress import (
    BarColumn,
    Progress,
    SpinnerColumn,
    TaskProgressColumn,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)
from rich.table import Table

from feeddrive.errors import ValidityWarning, printable, quoted
from feeddrive.files import write_text_atomically
from feeddrive.interface.shown import Listing
from feeddrive.output_folder import output_folder
from feeddrive.units.quantity import parse

JsonOption = Annotated[bool, typer.Option("--json", help="JSON in place of tables; SI units.")]
OutOption = Annotated[Path | None, typer.Option("--out", help="File to write to, in place of the terminal.")]

LONGEST_LINE = 800
"""Letters of a warning, or of where the files are."""

_LONGEST_NAME = 32
"""Letters of a name that a table never breaks; paths are longer."""

_WIDTH = 120
"""Width of tables in a file, and in a pipe whose reader names no width in COLUMNS; in letters."""


def table(title: str, headings: Sequence[str], rows: Sequence[Sequence[str]]) -> Table:
    """A table with a title; every cell is text. A narrow terminal breaks sentences, never names in the first column."""
    made = Table(title=printable(title), title_justify="left", title_style="bold")
    kept = bool(rows) and all(" " not in row[0] and len(row[0]) <= _LONGEST_NAME for row in rows)
    for number, heading in enumerate(headings):
        made.add_column(printable(heading), overflow="fold", no_wrap=kept and not number)
    for row in rows:
        made.add_row(*map(_printable_lines, row))
    return made


def parts_of(text: str) -> list[str]:
    """What stands between commas; nothing in an empty text."""
    return [part.strip() for part in text.split(",")] if text.strip() else []


def quantities(text: str, unit: str, where: str) -> tuple[float, ...]:
    """Values between commas, SI.

    Raises:
        InputError: not a quantity of that unit.
    """
    return tuple(parse(part, unit, where) for part in parts_of(text))


def tables_of(listings: Iterable[Listing]) -> list[Table]:
    """Tables of a result for the terminal; one without headings is of names and texts."""
    return [_table_of(one) for one in listings]


def _table_of(one: Listing) -> Table:
    if one.headings:
        made = table(one.title, one.headings, one.rows)
    else:
        title = printable(one.title) if one.title else None
        made = Table(title=title, title_justify="left", title_style="bold", show_header=False)
        made.add_column(min_width=12)
        made.add_column(overflow="fold")
        for row in one.rows:
            made.add_row(*map(_printable_lines, row))
    made.caption = printable(one.caption) if one.caption else None
    return made


def deliver(content: Mapping[str, Any], tables: Sequence[RenderableType], as_json: bool, out: Path | None) -> None:
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
        print_written(out, as_json)
    elif text is not None:
        typer.echo(text, nl=False)
    else:
        width = None if sys.stdout.isatty() or os.environ.get("COLUMNS", "").isdigit() else _WIDTH
        _print(Console(markup=False, highlight=False, emoji=False, width=width), tables)


class _Saved(Protocol):
    """A result that has tables, a record and files."""

    def tables(self) -> Sequence[Listing]: ...
    def record(self) -> Mapping[str, Any]: ...
    def save(self, path: str | Path, /) -> Path: ...


def deliver_saved(found: _Saved, as_json: bool, out: Path | None) -> None:
    """Write the files of a result into a folder where one is named, and print its tables or its JSON.

    Raises:
        InputError: the folder cannot be written.
    """
    if out is not None:
        with output_folder(out) as folder:
            found.save(folder)
    deliver(found.record(), [] if as_json else tables_of(found.tables()), as_json, None)
    print_written(out, as_json)


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


@contextmanager
def progress_bar(name: str) -> Iterator[Callable[[float, float], None] | None]:
    """A bar on a terminal, nothing in a pipe.

    Args:
        name: beside the bar.

    Yields:
        Called with what is done, and of how much; None in a pipe.
    """
    if not sys.stderr.isatty():
        yield None
        return
    columns = (TextColumn("{task.description}", markup=False), BarColumn(), TaskProgressColumn(), TimeRemainingColumn())
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task(printable(name), total=None)
        yield lambda done, total: bar.update(task, completed=done, total=total)


def print_written(out: Path | None, as_json: bool) -> None:
    """Print after the tables where the files are; nothing where there are none, or where JSON is printed."""
    if out is not None and not as_json:
        typer.echo(f"written: {quoted(str(out.resolve()), LONGEST_LINE)}")


@contextmanager
def warnings_as_lines() -> Iterator[None]:
    """Print what leaves the range of its formula in one line each, on stderr."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", ValidityWarning)
        yield
    printed: set[str] = set()
    for warning in caught:
        if issubclass(warning.category, ValidityWarning):
            if str(warning.message) not in printed:  # a plant is made more than once on the way to its figures
                print_line(f"warning: {warning.message}")
            printed.add(str(warning.message))
        else:
            warnings.warn_explicit(warning.message, warning.category, warning.filename, warning.lineno)


def print_line(line: str) -> None:
    """Print a line on stderr."""
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
