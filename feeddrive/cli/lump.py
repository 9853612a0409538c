"""`feeddrive lump PLANT`: a machine described by its parts as the three inertias nearest to it at a table position."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from feeddrive.cli.output import JsonOption, deliver, print_written, tables_of, warnings_as_lines
from feeddrive.errors import InputError
from feeddrive.interface.axis import load


def command(
    plant: Annotated[str, typer.Argument(help="Plant file, or the name of a shipped machine.")],
    at: Annotated[str, typer.Option(help="Table position such as 250mm; the middle of the stroke if left out.")] = "",
    as_json: JsonOption = False,
    out: Annotated[Path | None, typer.Option("--out", help="Plant file to write, such as lumped.toml.")] = None,
) -> None:
    """Write a machine as three inertias: stiffness and inertia exactly, first resonances as near as three can be."""
    if out is not None and out.is_dir():
        raise InputError("is a folder, not a file", str(out), "name a file for --out, such as lumped.toml")
    with warnings_as_lines():
        axis = load(plant)
        if out is not None and out.resolve() == axis.path.resolve():
            raise InputError("is the machine's own file", str(out), "name another file for --out")
        found = axis.lumped(at or None)
    if out is not None:
        found.save(out)
    tables = tables_of(found.tables())
    if out is None:
        tables[-1].caption = "Name a file with --out to write it."
    deliver(found.record() | {"file": str(out) if out is not None else None}, tables, as_json, None)
    print_written(out, as_json)
