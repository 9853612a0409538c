"""What `feeddrive compensate` does: call the public interface, write, and tell."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

import typer
from rich.console import Console

from feeddrive.cli.output import escaped, print_written, table, warnings_as_lines
from feeddrive.errors import InputError, printable
from feeddrive.files import write_bytes_atomically
from feeddrive.interface.compensating import Compensation, compensate
from feeddrive.interface.measured.reading import read
from feeddrive.recording.recording import Recording


@dataclass(frozen=True)
class Request:
    """What was typed."""

    source: str
    form: str
    every: str
    reference: str
    ends: tuple[str, str]
    axis: str
    controller: str
    lead: str
    resolution: str
    mapping: Path | None
    figure: Path | None


def run(request: Request, as_json: bool, out: Path | None) -> None:
    """Make the table, write it with its sheet, and print the prediction or the JSON.

    Raises:
        InputError: a source that cannot be used, or nothing that a table may hold; nothing is written then.
    """
    if out is not None and out.is_dir():
        raise InputError("is a folder", str(out), "name a file, such as --out enc_comp.ini")
    if bool(request.ends[0]) != bool(request.ends[1]):
        raise InputError("--from and --to belong together", "", 'write both, such as --from "0 mm" --to "500 mm"')
    source: str | Recording = request.source
    if request.mapping is not None:
        source = read(request.source, request.mapping)
    with warnings_as_lines(), Console(stderr=True).status("simulating"):
        done = compensate(
            source,
            request.form,
            every=request.every or None,
            reference=request.reference or None,
            stroke=request.ends if request.ends[0] else None,
            axis=request.axis,
            controller=request.controller or None,
            lead=request.lead or None,
            resolution=request.resolution or None,
        )
        if request.figure is not None:
            write_bytes_atomically(request.figure, picture(done))
        if out is not None:
            done.save(out)
    if as_json:
        typer.echo(escaped(json.dumps(done.record(), indent=2, ensure_ascii=False)))
        return
    console = Console(soft_wrap=True, highlight=False, markup=False, emoji=False)
    if out is None:
        console.print(escaped(done.text), end="")
        return
    listing = done.listing()
    console.print(table(listing.title, listing.headings, listing.rows))
    for line in done.left:
        console.print(f"left: {printable(line)}")
    print_written(out, False)
    typer.echo(f"its sheet: {printable(str(out.resolve()))}.txt")


def picture(done: Compensation) -> bytes:
    """The telling figure as PNG."""
    from feeddrive.report.figures.drawing import render

    return render(done._figures()[0]).png
